#define SILT_BUILD host
#define SILT_SCALAR
#include "lbm/walls/link_passes_build.hpp"
