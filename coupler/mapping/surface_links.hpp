#pragma once
// The cut links of one surface in one block, with what a step sums over them.
#include <cstdint>

#include "lbm/cut_links.hpp"

namespace silt::coupler {

/// One periodic image of a body, or a wall.
template <class T>
struct SurfaceLinks {
  lbm::CutLinks<T> links;
  lbm::StiffnessSums stiffness;  // implicit coupling only; renewed with the links
  // of the step under way:
  std::size_t row = 0;  // of the BodySet
  lbm::SurfaceMotion motion;
  lbm::LinkSums sums;
  std::uint32_t left = 0;  // groups yet to be applied
  bool finished = false;   // the body has been solved for
};

}  // namespace silt::coupler
