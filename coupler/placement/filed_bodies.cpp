#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/placement/given_bodies.hpp"
#include "parallel/together.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

/// A body on its way; what else there is to know of it the case says.
struct Passing {
  std::uint64_t point;  // of the file, from 0
  FiledPose pose;       // in the units of the case
};

BodySpec spec_of(const Case& setup, const FiledBodies& filed, const Passing& body) {
  BodySpec spec = filed.alike;
  const auto vector = [&](int column, Dimension dimension) -> Vec3 {
    return Eigen::Map<const Vec3>{&body.pose[column]} / setup.units.scale(dimension);
  };
  if (filed.contents.orientation) {
    const double* q = &body.pose[orientation_columns.begin];
    spec.pose.orientation = {q[0], q[1], q[2], q[3]};
    constexpr double rounding = 1e-14;
    if (std::abs(spec.pose.orientation.squaredNorm() - 1) > rounding) spec.pose.orientation.normalize();
    spec.unit = true;
  }
  put_at(spec, vector(0, dimension::length), extent_of(setup));
  if (filed.contents.velocity) spec.velocity = vector(velocity_columns.begin, dimension::velocity);
  if (filed.contents.angular_velocity)
    spec.angular_velocity = vector(turn_columns.begin, dimension::angular_velocity);
  spec.point = body.point + 1;
  return spec;
}

/// This rank's part of a file.
struct Slice : PositionSlice {
  std::uint64_t first = 0;  // body of the file
};

/// The fault of the rank that comes first in the file is told.
void throw_fault(const Case& setup, const FiledBodies& filed, Surroundings& around, const std::string& mine) {
  const std::string fault = parallel::text_of_first(around.comm(), mine);
  if (!fault.empty())
    throw CaseError(setup.place(fmt::format("bodies[{}].positions", filed.alike.entry)), fault);
}

Slice read_slice_here(const Case& setup, const FiledBodies& filed, Surroundings& around) {
  const std::string name = filed.positions.name();
  PositionSlice slice;
  std::string fault;
  try {
    slice = read_slice(setup.directory, filed.positions, around.rank, around.ranks);
  } catch (const std::exception& error) {
    fault = error.what();
  }
  throw_fault(setup, filed, around, fault);
  struct Counts {
    std::uint64_t bodies, lines;
  };
  const std::uint64_t n = slice.size();
  const Counts before = parallel::sum_of_ranks_before(around.comm(), Counts{n, slice.lines});
  const bool has_lines = filed.positions.dataset.empty();
  if (!slice.fault.empty())
    fault = fmt::format("{} {} of {} {}", has_lines ? "line" : "point",
                        has_lines ? before.lines + slice.lines : before.bodies + n + 1, name, slice.fault);
  throw_fault(setup, filed, around, fault);
  if (const std::uint64_t all = around.sum(n); all != filed.contents.points)
    throw_fault(setup, filed, around,
                fmt::format("{} has {} points now, and had {} a moment ago: it is being written; wait, and "
                            "start again",
                            name, all, filed.contents.points));
  return {std::move(slice), before.bodies};
}

/// Whom a body concerns: the rank of its centre of mass, and those near which it reaches.
std::vector<int> ranks_of(const Case& setup, Surroundings& around, const BodySpec& spec) {
  std::vector<int> ranks = around.ranks_near(rigid::bounding_box(setup.shapes[spec.shape], spec.pose));
  const int owner = around.holders.rank_at(spec.pose.position);
  if (!std::count(ranks.begin(), ranks.end(), owner)) ranks.push_back(owner);
  return ranks;
}

void send(const Case& setup, const FiledBodies& filed, Surroundings& around, const Slice& slice,
          std::size_t from, std::size_t to) {
  for (std::size_t i = from; i < std::min<std::size_t>(to, slice.size()); ++i) {
    Passing body{slice.first + i, {}};
    slice.put(i, body.pose);
    for (const int rank : ranks_of(setup, around, spec_of(setup, filed, body)))
      parallel::put(around.messages.to(rank), body);
  }
  around.messages.unannounced();
}

}  // namespace

void add_filed_bodies(const Case& setup, Surroundings& around, std::vector<GivenBody>& bodies,
                      std::size_t at_once) {
  rigid::BodyId first_id = 1 + setup.bodies.size();
  for (const FiledBodies& filed : setup.filed) {
    const Slice slice = read_slice_here(setup, filed, around);
    const std::size_t begin = bodies.size(), most = parallel::most_over_ranks(around.comm(), slice.size());
    for (std::size_t from = 0; from < most; from += at_once) {
      send(setup, filed, around, slice, from, from + at_once);
      around.messages.for_received<Passing>([&](const Passing& body, int) {
        const BodySpec spec = spec_of(setup, filed, body);
        bodies.push_back({first_id + body.point, spec, around.is_here(spec.pose.position)});
      });
    }
    std::sort(bodies.begin() + static_cast<std::ptrdiff_t>(begin), bodies.end(),
              [](const GivenBody& a, const GivenBody& b) { return a.id < b.id; });
    first_id += filed.contents.points;
  }
}

}  // namespace silt::coupler
