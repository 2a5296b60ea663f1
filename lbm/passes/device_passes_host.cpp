#define SILT_ISA host
#define SILT_SCALAR
#include "lbm/passes/device_passes_build.hpp"
