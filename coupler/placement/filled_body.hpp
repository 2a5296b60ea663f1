#pragma once
// A body that a fill has placed.
#include <cstdint>

#include "rigid/math/types.hpp"

namespace silt::coupler {

struct FilledBody {
  std::uint64_t number;  // unlike that of any other of the fill; bodies close together have close numbers
  rigid::Vec3 centre;    // of its bounding sphere and of mass; wrapped
  rigid::Quat orientation;
};

}  // namespace silt::coupler
