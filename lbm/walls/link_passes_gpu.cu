#define SILT_BUILD gpu
#define SILT_SCALAR
#include "lbm/walls/link_passes_build.hpp"
