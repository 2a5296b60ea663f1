// The passes of the device `host`, built once per instruction set.
#include "coupler/mapping/device_mapping_build.hpp"
