#define SILT_ISA gpu
#define SILT_SCALAR
#include "lbm/device_passes_build.hpp"
