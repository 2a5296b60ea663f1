// The passes of the device `host`, built once per instruction set.
#include "lbm/passes/block_passes.hpp"
#include "lbm/passes/border_passes.hpp"
#include "lbm/passes/passes_build.hpp"
