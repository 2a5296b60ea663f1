#pragma once
// Scenes with fills, and the bodies that come of a case.
#include <vector>

#include "coupler/flow.hpp"
#include "silt/case/case.hpp"
#include "silt/placement/place_bodies.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::testing {

/// A fixed ball, 40 stars that keep a distance, and 4 balls in the upper half.
inline CaseText with_fills() {
  CaseText c;
  c.shapes += R"([[shapes]]
name = "star"
type = "compound"
parts = [
  { type = "capsule", radius = 1, length = 4, orientation = [1, 0, 0], position = [1, 0, 0] },
  { type = "capsule", radius = 1, length = 4, orientation = [0, 1, 0] },
]
)";
  c.bodies = R"([[bodies]]
shape = "ball"
density = 1
motion = "fixed"
position = [16, 16, 16]
[[fill]]
name = "stars"
shape = "star"
density = 0.8
count = 40
gap = 0.5
seed = 3
[[fill]]
name = "balls"
shape = "ball"
density = 1.2
count = 4
box = [[0, 0, 18], [32, 32, 32]]
seed = 3
)";
  return c;
}

inline PlacedBodies place(const Case& setup, MPI_Comm comm) {
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  return place_bodies(setup, make_domain(setup, ranks), comm);
}

/// All bodies, by ids, placed by this rank alone.
inline std::vector<BodySpec> bodies_of(const Case& setup) {
  std::vector<BodySpec> bodies;
  place(setup, MPI_COMM_SELF).for_each([&](rigid::BodyId, const BodySpec& body) { bodies.push_back(body); });
  return bodies;
}

}  // namespace silt::testing
