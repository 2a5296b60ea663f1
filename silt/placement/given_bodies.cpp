#include "silt/placement/given_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "parallel/together.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case_check.hpp"
#include "silt/placement/obstacles.hpp"

namespace silt {

std::uint64_t count_given(const Case& setup) {
  std::uint64_t n = 0;
  setup.for_each_given([&](const BodySpec&, std::uint64_t count) { n += count; });
  return n;
}

double mean_width(const Case& setup, std::span<const GivenBody> bodies) {
  double sum = 0;
  for (const GivenBody& body : bodies) sum += 2 * rigid::bounding_radius(setup.shapes[body.spec.shape]);
  return bodies.empty() ? 1 : std::max(1.0, sum / static_cast<double>(bodies.size()));
}

int entry_of(const Case& setup, rigid::BodyId id) {
  if (id <= setup.bodies.size()) return setup.bodies[id - 1].entry;
  id -= setup.bodies.size();
  auto filed = setup.filed.begin();
  for (; id > filed->contents.points; ++filed) id -= filed->contents.points;
  return filed->alike.entry;
}

std::vector<GivenBody> given_bodies(const Case& setup, Surroundings& around) {
  std::vector<GivenBody> bodies;
  for (std::size_t i = 0; i < setup.bodies.size(); ++i) {
    const BodySpec& spec = setup.bodies[i];
    const bool own = around.is_here(spec.pose.position);
    const auto& near = around.ranks_near(rigid::bounding_box(setup.shapes[spec.shape], spec.pose));
    if (own || std::binary_search(near.begin(), near.end(), around.rank))
      bodies.push_back({i + 1, spec, own});
  }
  add_filed_bodies(setup, around, bodies);
  return bodies;
}

std::vector<BodyFault> first_faults(MPI_Comm comm, std::vector<BodyFault> mine, std::size_t most) {
  constexpr auto none = std::numeric_limits<std::uint64_t>::max();
  std::sort(mine.begin(), mine.end(), [](const BodyFault& a, const BodyFault& b) {
    return std::tie(a.body, a.other) < std::tie(b.body, b.other);
  });
  std::vector<BodyFault> first;
  auto next = mine.begin();
  while (first.size() < most) {
    const rigid::BodyId body = parallel::least_over_ranks(comm, next == mine.end() ? none : next->body);
    if (body == none) break;
    const bool of_body = next != mine.end() && next->body == body;
    const rigid::BodyId other = parallel::least_over_ranks(comm, of_body ? next->other : none);
    const bool have = of_body && next->other == other;
    first.push_back({body, other, parallel::text_of_first(comm, have ? next->text : "")});
    while (next != mine.end() && next->body == body && next->other == other) ++next;
  }
  return first;
}

namespace {

using rigid::Motion;
using rigid::Vec3;

/// Returns "; if it is in mm, write [0.0025, 0.005, 0.036] (m)", or "" for a point that would not lie in the
/// domain.
std::string position_slip(const Case& setup, const Vec3& position) {
  constexpr double millimetres = 1000;  // in a metre
  const Vec3 meant = position / millimetres;
  const bool fits = (meant.array() >= 0).all() && (meant.array() <= extent_of(setup).size.array()).all();
  return setup.units.si && fits && meant.norm() > 1
             ? fmt::format("; if it is in mm, write {} (m)", shown_point(setup, meant))
             : "";
}

std::string in_the_domain(const Case& setup, const std::string& key, const BodySpec& body) {
  const bool centred = body.origin.isZero(0);
  return fmt::format(
      "{} is {}{}; it must lie in the domain, {}{}", key, shown_point(setup, body.given_position()),
      centred ? "" : ": this puts the body's centre of mass at " + shown_point(setup, body.pose.position),
      shown_box(setup, box_of(setup)),
      centred ? position_slip(setup, body.given_position())
              : "; with origin = \"centre\" the position is that of the centre");
}

/// Returns the box of a body: of a mesh that of its corners, not the wider one of its turned box.
rigid::BoundingBox exact_box(const rigid::Shape& shape, const rigid::Pose& pose) {
  const auto* const mesh = std::get_if<rigid::Mesh>(&shape);
  if (!mesh) return rigid::bounding_box(shape, pose);
  rigid::BoundingBox box = rigid::BoundingBox::empty();
  for (const Vec3& corner : mesh->surface->vertices()) {
    const Vec3 x = pose.to_world(corner);
    box.add({x, x});
  }
  return box;
}

}  // namespace

std::string fault_of_place(const Case& setup, const BodySpec& body, const std::string& key, double time) {
  const Vec3 size = extent_of(setup).size, x = body.given_position();
  const Vec3& centre = body.pose.position;
  for (int d = 0; d < 3; ++d)
    if (!(centre[d] >= 0 && centre[d] <= size[d])) return in_the_domain(setup, key, body);
  if (body.motion == Motion::fixed) return "";
  const auto box = exact_box(setup.shapes[body.shape], body.pose);
  for (int d = 0; d < 3; ++d) {
    const double low = setup.boundary[2 * d].stops_bodies() ? -box.lower[d] : 0;
    const double high = setup.boundary[2 * d + 1].stops_bodies() ? box.upper[d] - size[d] : 0;
    if (std::max(low, high) <= start_overlap) continue;
    const double allowed_low = x[d] - box.lower[d], allowed_high = size[d] - (box.upper[d] - x[d]);
    return fmt::format(
        "{} is {}: the body reaches {} into the {} wall of {}; its {} must be between {} and {}", key,
        shown_point(setup, x), shown_length(setup, std::max(low, high)), low > high ? "lower" : "upper",
        "xyz"[d], "xyz"[d], shown_length(setup, allowed_low), shown_length(setup, allowed_high));
  }
  return fault_in_curved_walls(setup, body, key, start_overlap, time);
}

namespace {

std::vector<BodyFault> faults_of_places(const Case& setup, const std::vector<GivenBody>& bodies) {
  std::vector<BodyFault> faults;
  for (const GivenBody& body : bodies) {
    if (!body.own || faults.size() >= most_messages) continue;
    if (std::string text = fault_of_place(setup, body.spec, position_text(setup, body.spec)); !text.empty())
      faults.push_back({body.id, 0, std::move(text)});
  }
  return faults;
}

std::string text_of_overlap(const Case& setup, const BodySpec& a, const BodySpec& b, double depth) {
  return fmt::format(
      "{}: the body at {} overlaps the one at {} (entry {}) by at least {} at the start; move them apart",
      position_text(setup, b), shown_point(setup, b.given_position()), shown_point(setup, a.given_position()),
      a.entry, shown_length(setup, depth));
}

/// Finds overlaps of pairs of bodies. The rank where the overlap is has both.
std::vector<BodyFault> faults_of_pairs(const Case& setup, const std::vector<GivenBody>& bodies) {
  const rigid::Extent extent = extent_of(setup);
  NeighbourGrid grid(extent, mean_width(setup, bodies));
  std::vector<BodyFault> faults;
  std::vector<int> partners;
  for (std::size_t j = 0; j < bodies.size() && faults.size() < most_messages; ++j) {
    const BodySpec& b = bodies[j].spec;
    const auto box = rigid::bounding_box(setup.shapes[b.shape], b.pose);
    partners.clear();
    grid.visit(box, [&](int i) { return partners.push_back(i), true; });
    std::sort(partners.begin(), partners.end());
    partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
    for (const int i : partners) {
      const BodySpec& a = bodies[i].spec;
      if (a.motion != Motion::free && b.motion != Motion::free) continue;
      const double depth =
          overlap_depth(setup.shapes[a.shape], a.pose, setup.shapes[b.shape], b.pose, extent);
      if (depth > start_overlap)
        faults.push_back({bodies[j].id, bodies[i].id, text_of_overlap(setup, a, b, depth)});
    }
    grid.insert(static_cast<int>(j), box);
  }
  return faults;
}

/// A body in a message; the case has its other properties.
struct Passing {
  std::uint64_t point;  // index in the file
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
  Vec3 point = vector(0, dimension::length);
  if (filed.contents.velocity) spec.velocity = vector(velocity_columns.begin, dimension::velocity);
  if (filed.contents.angular_velocity)
    spec.angular_velocity = vector(turn_columns.begin, dimension::angular_velocity);
  if (filed.placed) {
    const auto& [origin, turn] = *filed.placed;
    point = origin + turn * point;
    spec.pose.orientation = (turn * spec.pose.orientation).normalized(), spec.unit = false;
    if (filed.contents.velocity) spec.velocity = turn * spec.velocity;
    if (filed.contents.angular_velocity) spec.angular_velocity = turn * spec.angular_velocity;
  }
  put_at(spec, point, extent_of(setup));
  spec.point = body.point + 1;
  return spec;
}

/// This rank's part of a file.
struct Slice : PositionSlice {
  std::uint64_t first = 0;  // index in the file
};

/// Throws, on every rank, the fault that comes first in the file.
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

/// Returns the ranks that need a body: the owner of its centre of mass, and those near which it reaches.
std::vector<int> ranks_of(const Case& setup, Surroundings& around, const BodySpec& spec) {
  std::vector<int> ranks = around.ranks_near(rigid::bounding_box(setup.shapes[spec.shape], spec.pose));
  const int owner = around.holders.rank_at(spec.pose.position);
  if (!std::ranges::count(ranks, owner)) ranks.push_back(owner);
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
  around.messages.exchange_sparse();
}

/// Returns a body of another run as one of this case.
BodySpec spec_of(const rigid::BodyRecord& r) {
  BodySpec spec;
  spec.shape = r.shape, spec.kind = r.kind, spec.motion = r.motion;
  spec.pose.position = Vec3(r.position);
  spec.pose.orientation = {r.orientation[0], r.orientation[1], r.orientation[2], r.orientation[3]};
  return spec;
}

std::string name_of(const Case& setup, const rigid::BodyRecord& r) {
  return fmt::format("body {} ('{}') of initial.from", r.id, setup.kind_names[std::size_t(r.kind)]);
}

/// Appends the overlaps of given bodies with an existing body.
void find_overlaps(const Case& setup, const std::vector<GivenBody>& given, const NeighbourGrid& grid,
                   const rigid::BodyRecord& there, std::vector<BodyFault>& faults) {
  const rigid::Extent extent = extent_of(setup);
  const BodySpec b = spec_of(there);
  const rigid::Shape& shape = setup.shapes[b.shape];
  grid.visit(rigid::bounding_box(shape, b.pose), [&](int i) {
    const BodySpec& a = given[std::size_t(i)].spec;
    const double depth = overlap_depth(setup.shapes[a.shape], a.pose, shape, b.pose, extent);
    if (depth > start_overlap && (a.motion == Motion::free || b.motion == Motion::free))
      faults.push_back(
          {given[std::size_t(i)].id, there.id,
           fmt::format("{}: the body at {} overlaps {}, at {}, by at least {} at the start; move "
                       "it away",
                       position_text(setup, a), shown_point(setup, a.given_position()), name_of(setup, there),
                       shown_point(setup, b.pose.position), shown_length(setup, depth))});
    return true;
  });
}

/// Throws the first faults of all ranks, at a key or else at the positions of each body.
void throw_faults(const Case& setup, MPI_Comm comm, std::vector<BodyFault> mine, const char* key = nullptr) {
  std::vector<Diagnostic> list;
  for (const BodyFault& fault : first_faults(comm, std::move(mine), most_messages))
    list.push_back({Diagnostic::Severity::error,
                    setup.place(key ? key : position_key(setup, entry_of(setup, fault.body))), fault.text});
  if (!list.empty()) throw CaseError(std::move(list));
}

}  // namespace

void require_room_beside(std::span<const rigid::BodyRecord> there, bool walls_are_new, const Case& setup,
                         const lbm::Domain& domain, MPI_Comm comm) {
  std::vector<BodyFault> in_walls, overlaps;
  for (const rigid::BodyRecord& r : there)
    if (const BodySpec body = spec_of(r); walls_are_new && body.motion != Motion::fixed)
      if (std::string text = fault_in_curved_walls(setup, body, name_of(setup, r), start_overlap);
          !text.empty())
        in_walls.push_back({r.id, 0, std::move(text)});
  throw_faults(setup, comm, std::move(in_walls), "initial.from");
  Surroundings around(setup, domain, comm, 1);
  const std::vector<GivenBody> given = given_bodies(setup, around);
  NeighbourGrid grid(around.extent, mean_width(setup, given));
  for (std::size_t i = 0; i < given.size(); ++i)
    grid.insert(int(i), rigid::bounding_box(setup.shapes[given[i].spec.shape], given[i].spec.pose));
  for (const rigid::BodyRecord& r : there)
    for (const int rank : around.ranks_near(rigid::bounding_box(setup.shapes[r.shape], spec_of(r).pose)))
      parallel::put(around.messages.to(rank), r);
  around.messages.exchange_sparse();
  around.messages.for_received<rigid::BodyRecord>(
      [&](const rigid::BodyRecord& r, int) { find_overlaps(setup, given, grid, r, overlaps); });
  throw_faults(setup, comm, std::move(overlaps));
}

void require_sound_start(const Case& setup, const lbm::Domain& domain, MPI_Comm comm) {
  Surroundings around(setup, domain, comm, 1);
  const std::vector<GivenBody> bodies = given_bodies(setup, around);
  throw_faults(setup, comm, faults_of_places(setup, bodies));
  throw_faults(setup, comm, faults_of_pairs(setup, bodies));
}

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

}  // namespace silt
