#define SILT_BUILD host
#define SILT_SCALAR
#include "coupler/mapping/device_mapping_build.hpp"
