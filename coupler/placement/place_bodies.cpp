#include "coupler/placement/place_bodies.hpp"

#include "coupler/case/case.hpp"

namespace silt::coupler {

std::size_t PlacedBodies::size() const {
  std::size_t n = given.size();
  for (const AppliedFill& fill : filled) n += fill.bodies.size();
  return n;
}

PlacedBodies place_bodies(const Case& scene, const lbm::Domain& domain, MPI_Comm comm) {
  Surroundings around(scene, domain, comm, reach_of_fills(scene));
  PlacedBodies placed;
  placed.given = given_bodies(scene, around);
  placed.next_id = 1 + count_given(scene);
  std::vector<FillApplication> all;
  for (std::size_t i = 0; i < scene.fills.size(); ++i) all.emplace_back(i);
  placed.filled = apply_fills(scene, all, placed.given, around, placed.next_id);
  std::erase_if(placed.given, [](const GivenBody& body) { return !body.own; });
  return placed;
}

}  // namespace silt::coupler
