// The passes of the device `host`, built once per instruction set.
#include "lbm/walls/link_passes_build.hpp"
