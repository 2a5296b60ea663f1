#include "coupler/departures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "coupler/case/case.hpp"

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
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  const int bytes = static_cast<int>(mine.size() * sizeof(Departure));
  std::vector<int> sizes(rank == 0 ? ranks : 0), begins(sizes.size());
  MPI_Gather(&bytes, 1, MPI_INT, sizes.data(), 1, MPI_INT, 0, comm);
  int all = 0;
  for (std::size_t r = 0; r < sizes.size(); ++r) begins[r] = all, all += sizes[r];
  std::vector<Departure> departures(static_cast<std::size_t>(all) / sizeof(Departure));
  MPI_Gatherv(mine.data(), bytes, MPI_BYTE, departures.data(), sizes.data(), begins.data(), MPI_BYTE, 0,
              comm);
  std::sort(departures.begin(), departures.end(), [](const Departure& a, const Departure& b) {
    return std::tie(a.step, a.id) < std::tie(b.step, b.id);
  });
  return departures;
}

}  // namespace silt::coupler
