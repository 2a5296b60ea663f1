#define SILT_ISA gpu
#define SILT_SCALAR
#include "lbm/link_passes_build.hpp"
