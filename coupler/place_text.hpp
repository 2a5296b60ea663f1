#pragma once
// Where in a scene something happened, in words.
#include <optional>
#include <string>

#include "coupler/scene.hpp"

namespace silt::coupler {

/// What is near a point: rows of bodies or walls, the nearest first, and the distances of their surfaces
/// (cells).
struct Neighbour {
  std::size_t row;
  double distance;
};
struct Neighbours {
  std::optional<Neighbour> first, second;
};
/// Looks among the bodies and walls that this rank holds, within so many cells of a cell's centre.
Neighbours neighbours_of(const Scene&, lbm::Int3 cell, double within = 2);

/// Returns "cell [1, 2, 3] (at [0.1, 0.2, 0.3] m), 0.6 cells from body 7, in a gap of 1.1 cells to the side
/// z-low": the position if the case has units, and what of the neighbours there is.
std::string place_text(const Scene&, lbm::Int3 cell, const Neighbours&);

}  // namespace silt::coupler
