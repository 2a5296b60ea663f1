#define SILT_BUILD gpu
#define SILT_SCALAR
#include "coupler/mapping/device_mapping_build.hpp"
