#define SILT_BUILD cpu
#define SILT_AT_ONCE
#include "coupler/mapping/refill_build.hpp"
