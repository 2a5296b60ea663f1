#define SILT_ISA host
#define SILT_SCALAR
#include "coupler/mapping/device_measure_build.hpp"
