#include "coupler/departures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "coupler/case/case.hpp"
#include "parallel/collectives.hpp"

namespace silt::coupler {

std::string way_text(int way) {
  if (way >= first_outflow) return fmt::format("outflow[{}]", way - first_outflow);
  return std::string(side_names[Side(way)]);
}

std::optional<int> side_behind(const Case& scene, const rigid::Vec3& x, double radius) {
  for (int d = 0; d < 3; ++d) {
    if (scene.periodic(d)) continue;
    if (x[d] + radius < 0) return 2 * d;
    if (x[d] - radius > scene.cells[d]) return 2 * d + 1;
  }
  return {};
}

std::string outside_text(const Case& scene, rigid::BodyId id, bool free, int side, std::int64_t step) {
  const std::string found =
      fmt::format("step {}: body {} has left the domain past {}", step, id, way_text(side));
  if (scene.boundary[side].lets_bodies_pass())
    return found + ", where leaving is \"stop\": with \"remove\" it would be taken out";
  if (!free)
    return found +
           ", a wall, as its motion is prescribed: end the run before, or set solid_for_bodies = false "
           "on that side, and it is taken out";
  return found + fmt::format(", through the wall: raise contacts.substeps (now {})", scene.contacts.substeps);
}

std::vector<Departure> gathered(MPI_Comm comm, const std::vector<Departure>& mine) {
  auto departures = parallel::gathered(comm, std::span(mine), parallel::Told::rank_0);
  std::sort(departures.begin(), departures.end(), [](const Departure& a, const Departure& b) {
    return std::tie(a.step, a.id) < std::tie(b.step, b.id);
  });
  return departures;
}

}  // namespace silt::coupler
