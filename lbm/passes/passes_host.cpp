#define SILT_BUILD host
#define SILT_SCALAR
#include "lbm/passes/block_passes.hpp"
#include "lbm/passes/passes_build.hpp"
