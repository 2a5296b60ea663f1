#define SILT_ISA gpu
#define SILT_SCALAR
#include "coupler/mapping/device_mapping_build.hpp"
