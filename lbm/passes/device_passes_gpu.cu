#define SILT_ISA gpu
#define SILT_SCALAR
#include "lbm/passes/device_passes_build.hpp"
