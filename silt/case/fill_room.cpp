#include "silt/case/fill_room.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rigid/collision/tube_contacts.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case_check.hpp"

namespace silt {

using rigid::Vec3;

CurvedWalls::CurvedWalls(const Case& setup) {
  for (const CurvedWall& wall : setup.walls)
    if (const auto* tube = wall.tube())
      tubes_.emplace_back(tube->tube, tube->pose());
    else if (const auto* mesh = wall.mesh())
      meshes_.emplace_back(mesh->mesh, mesh->pose(0));
}

bool CurvedWalls::are_clear_of(const Vec3& centre, double radius) const {
  for (const auto& [tube, pose] : tubes_)
    if (rigid::gap_in_tube(rigid::Sphere{radius}, {centre, rigid::Quat::Identity()}, tube, pose) < 0)
      return false;
  for (const auto& [mesh, pose] : meshes_)
    if (const Vec3 x = pose.to_body(centre);
        mesh.surface->nearest(x, radius).distance < radius || mesh.contains(x))
      return false;
  return true;
}

double CurvedWalls::share_left(const rigid::BoundingBox& room, double radius) const {
  if (empty()) return 1;
  constexpr int points = 32;
  const Vec3 step = (room.upper - room.lower) / points;
  int clear = 0;
  for (int z = 0; z < points; ++z)
    for (int y = 0; y < points; ++y)
      for (int x = 0; x < points; ++x)
        clear += are_clear_of(room.lower + step.cwiseProduct(Vec3(x + 0.5, y + 0.5, z + 0.5)), radius);
  return clear / double(points * points * points);
}

namespace {

[[noreturn]] void refuse(const Case& setup, std::size_t fill, int axis, double radius,
                         const std::string& why) {
  throw CaseError(
      setup.place(fmt::format("fill[{}].box", fill)),
      fmt::format(
          "fill[{}]: bodies of {} cells ({}) do not fit along {}: {}; enlarge it or make the bodies smaller",
          fill, shown(2 * radius), shown(setup.units.physical(2 * radius, dimension::length)), "xyz"[axis],
          why));
}

constexpr double rounding = 1e-9;  // relative, for whole numbers of steps

/// Distances of rows and layers relative to neighbours, and the period of the pattern.
struct Pattern {
  double rows, layers;
  int repeat;
};

Pattern pattern_of(Arrangement arrangement) {
  if (arrangement != Arrangement::hexagonal) return {1, 1, 1};
  return {std::sqrt(0.75), std::sqrt(2. / 3), 2};  // close packing: layers ABAB
}

}  // namespace

std::int64_t FillApplication::count(const FillSpec& spec) const {
  if (spec.sizes.size() == 1) return spec.count;
  const auto all = static_cast<double>(spec.count);
  const double u = coupler::CounterRandom(FillApplication(fill, number).key(spec)).uniform();
  const auto below = [&](double share) {
    return static_cast<std::int64_t>(std::clamp(std::ceil(all * share - u), 0., all));
  };
  return below(spec.sizes[size].up_to) - (size > 0 ? below(spec.sizes[size - 1].up_to) : 0);
}

rigid::BoundingBox room_for_centres(const Case& setup, std::size_t index, double radius) {
  const FillSpec& fill = setup.fills[index];
  const rigid::Extent extent = extent_of(setup);
  rigid::BoundingBox room = fill.box;
  for (int d = 0; d < 3; ++d) {
    double &lower = room.lower[d], &upper = room.upper[d];
    const double length = extent.size[d];
    const bool whole = lower <= 0 && upper >= length;
    if (extent.periodic[d] && 2 * radius + fill.gap > length)
      refuse(setup, index, d, radius, fmt::format("the periodic axis is {} cells long", shown(length)));
    if (extent.periodic[d] && whole) {
      lower = 0;
      upper = length;
      continue;
    }
    lower = extent.periodic[d] ? lower + radius : std::max(lower + radius, radius + fill.gap);
    upper = extent.periodic[d] ? upper - radius : std::min(upper - radius, length - radius - fill.gap);
    if (lower > upper)
      refuse(setup, index, d, radius,
             fmt::format("the box less the gaps to its walls is {} cells wide",
                         shown(std::max(0., upper - lower + 2 * radius))));
  }
  return room;
}

Lattice::Lattice(const rigid::BoundingBox& room, const rigid::Extent& extent, Arrangement arrangement,
                 double spacing)
    : closest_(arrangement == Arrangement::hexagonal), room_(room) {
  const Pattern pattern = pattern_of(arrangement);
  const double factors[3] = {1, pattern.rows, pattern.layers};
  for (int d = 0; d < 3; ++d) {
    const double length = room.upper[d] - room.lower[d], least = spacing * factors[d];
    round_[d] = extent.periodic[d] && length >= extent.size[d];
    const auto fit = static_cast<std::int64_t>(std::floor(std::max(-1.0, length / least + rounding)));
    const int repeat = d == 0 ? 1 : pattern.repeat;
    count_[d] = round_[d] ? fit / repeat * repeat : fit + 1;
    step_[d] = round_[d] && count_[d] > 0 ? length / static_cast<double>(count_[d]) : least;
    const double used = static_cast<double>(count_[d] - 1) * step_[d];
    first_[d] = room.lower[d] + (round_[d] ? step_[d] / 2 : (length - used) / 2);
  }
}

rigid::Vec3 Lattice::site(const Index& i) const {
  const bool odd_layer = closest_ && i[2] % 2 != 0, odd_row = closest_ && i[1] % 2 != 0;
  const double x = odd_layer ? step_[0] / 2 : 0, y = odd_layer ? step_[1] / 3 : 0;
  const double row = odd_row ? step_[0] / 2 : 0;
  rigid::Vec3 site;
  for (int d = 0; d < 3; ++d) site[d] = first_[d] + static_cast<double>(i[d]) * step_[d];
  return site + rigid::Vec3(x + row, y, 0);
}

bool Lattice::in_room(const rigid::Vec3& site) const {
  for (int d = 0; d < 3; ++d)
    if (!round_[d] && (site[d] < room_.lower[d] - rounding || site[d] > room_.upper[d] + rounding))
      return false;
  return true;
}

Lattice lattice_of(const Case& setup, FillApplication application, double radius) {
  const std::size_t index = application.fill;
  const FillSpec& fill = setup.fills[index];
  const rigid::Extent extent = extent_of(setup);
  const double least = 2 * radius + fill.gap + 2 * fill.shift;
  const double spacing = fill.spacing > 0 ? fill.spacing : least;
  if (spacing < least * (1 - rounding))
    throw CaseError(setup.place(fmt::format("fill[{}].spacing", index)),
                    fmt::format("fill[{}].spacing is {}; it must be at least {}: the diameter of a body's "
                                "bounding sphere, the gap and twice the shift",
                                index, shown_length(setup, spacing), shown_length(setup, least)));
  rigid::BoundingBox room = room_for_centres(setup, index, radius);
  for (int d = 0; d < 3; ++d) {
    if (extent.periodic[d] && room.upper[d] - room.lower[d] >= extent.size[d]) continue;
    room.lower[d] += fill.shift;
    room.upper[d] -= fill.shift;
  }
  return Lattice(room, extent, fill.arrangement, spacing);
}

}  // namespace silt
