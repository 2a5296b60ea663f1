#include "coupler/placement/filed_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "coupler/case/case.hpp"
#include "coupler/exchange/reduce.hpp"
#include "coupler/placement/first_faults.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

/// A body on its way; what else there is to know of it the case says.
struct Passing {
  std::uint64_t point;  // of the file, from 0
  double position[3];
};

BodySpec spec_of(const FiledBodies& filed, const Passing& body) {
  BodySpec spec = filed.alike;
  spec.pose.position = Eigen::Map<const Vec3>{body.position};
  spec.point = body.point + 1;
  return spec;
}

/// This rank's part of a file.
struct Slice {
  std::vector<std::array<double, 3>> points;
  std::uint64_t first = 0;
};

/// The fault of the rank that comes first in the file is told.
void throw_fault(const Case& scene, const FiledBodies& filed, Surroundings& around,
                 const std::vector<BodyFault>& mine) {
  const auto faults = first_faults(around.comm(), mine, 1);
  if (!faults.empty())
    throw CaseError(scene.place(fmt::format("bodies[{}].positions", filed.alike.entry)), faults[0].text);
}

Slice read_slice_here(const Case& scene, const FiledBodies& filed, Surroundings& around) {
  const std::string name = filed.positions.name();
  PositionSlice slice;
  std::vector<BodyFault> unreadable;
  try {
    slice = read_slice(scene.directory, filed.positions, around.rank, around.ranks);
  } catch (const std::exception& error) {
    unreadable.push_back({rigid::BodyId(around.rank), 0, error.what()});
  }
  throw_fault(scene, filed, around, unreadable);
  std::uint64_t n = slice.points.size(), before = 0;
  MPI_Exscan(&n, &before, 1, MPI_UINT64_T, MPI_SUM, around.comm());
  std::vector<BodyFault> bad;
  if (!slice.fault.empty())
    bad.push_back({before + n, 0,
                   fmt::format("point {} of {} {}; it must be three finite numbers, x, y, z", before + n + 1,
                               name, slice.fault)});
  throw_fault(scene, filed, around, bad);
  const std::uint64_t all = around.sum(n);
  if (all != filed.count)
    throw CaseError(
        scene.place(fmt::format("bodies[{}].positions", filed.alike.entry)),
        fmt::format("{} has {} points now, and had {} a moment ago: it is being written; wait, and "
                    "start again",
                    name, all, filed.count));
  return {std::move(slice.points), before};
}

/// Whom a body concerns: the rank of its centre of mass, and those near which it reaches.
std::vector<int> ranks_of(const Case& scene, Surroundings& around, const BodySpec& spec, const Vec3& centre) {
  std::vector<int> ranks = around.ranks_near(rigid::bounding_box(scene.shapes[spec.shape], spec.pose));
  const int owner = around.holders.rank_at(spec.pose.to_world(centre));
  if (!std::count(ranks.begin(), ranks.end(), owner)) ranks.push_back(owner);
  return ranks;
}

void send(const Case& scene, const FiledBodies& filed, Surroundings& around, const Slice& slice,
          std::size_t from, std::size_t to, const Vec3& centre) {
  for (std::size_t i = from; i < std::min(to, slice.points.size()); ++i) {
    Passing body{slice.first + i, {}};
    for (int d = 0; d < 3; ++d) body.position[d] = slice.points[i][d] / scene.units.cell_size;
    for (const int rank : ranks_of(scene, around, spec_of(filed, body), centre))
      put(around.messages.to(rank), body);
  }
  around.messages.unannounced();
}

}  // namespace

void add_filed_bodies(const Case& scene, Surroundings& around, std::vector<GivenBody>& bodies,
                      std::size_t at_once) {
  rigid::BodyId first_id = 1 + scene.bodies.size();
  for (const FiledBodies& filed : scene.filed) {
    const Vec3 centre = rigid::mass_properties(scene.shapes[filed.alike.shape]).centre;
    const Slice slice = read_slice_here(scene, filed, around);
    const std::size_t begin = bodies.size(), most = most_over_ranks(around.comm(), slice.points.size());
    for (std::size_t from = 0; from < most; from += at_once) {
      send(scene, filed, around, slice, from, from + at_once, centre);
      for (const Messages::Message& m : around.messages.received())
        for (ByteReader reader(m.bytes); !reader.done();) {
          const auto body = reader.take<Passing>();
          const BodySpec spec = spec_of(filed, body);
          bodies.push_back({first_id + body.point, spec, around.is_here(spec.pose.to_world(centre))});
        }
    }
    std::sort(bodies.begin() + static_cast<std::ptrdiff_t>(begin), bodies.end(),
              [](const GivenBody& a, const GivenBody& b) { return a.id < b.id; });
    first_id += filed.count;
  }
}

}  // namespace silt::coupler
