#define SILT_BUILD cpu
#define SILT_SCALAR
#define SILT_AT_ONCE
#include "lbm/walls/link_passes_build.hpp"
