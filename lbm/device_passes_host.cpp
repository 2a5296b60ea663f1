#define SILT_ISA host
#define SILT_SCALAR
#include "lbm/device_passes_build.hpp"
