#define SILT_ISA host
#define SILT_SCALAR
#include "lbm/link_passes_build.hpp"
