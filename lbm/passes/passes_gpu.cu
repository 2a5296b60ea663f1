#define SILT_BUILD gpu
#define SILT_SCALAR
#include "lbm/passes/block_passes.hpp"
#include "lbm/passes/border_passes.hpp"
#include "lbm/passes/passes_build.hpp"
