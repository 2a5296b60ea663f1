#include "silt/case/case.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "silt/case/fill_room.hpp"

namespace silt {
using rigid::Vec3;

namespace {

bool has_weights(const Case& setup) {
  return !setup.gravity_at(0.5).isZero(0) && std::ranges::any_of(entries_of(setup), [](const Entry& entry) {
    return entry.is_free() && entry.density != 1;
  });
}

/// Returns whether pressure must balance a load; of a periodic force on the fluid only with an obstacle.
bool is_loaded(const Case& setup) {
  if (has_weights(setup) || !setup.springs.empty()) return true;
  Vec3 force = setup.fluid->body_force_over_time.at(0) * setup.fluid->body_force;
  if (setup.heat) force += setup.heat->initial * Vec3(setup.heat->buoyancy.data());
  for (int d = 0; d < 3; ++d)
    if (force[d] != 0 && (!setup.periodic(d) || setup.has_surfaces())) return true;
  return false;
}

double fastest_of_sides_and_start(const Case& setup) {
  double fastest = 0;
  if (setup.fluid)
    fastest = std::max(setup.fluid->initial.largest_speed(), setup.fluid->superficial_velocity.norm());
  for (const coupler::BoundarySpec& side : setup.boundary) fastest = std::max(fastest, side.largest_speed());
  return fastest;
}

}  // namespace

bool begins_at_rest(const Case& setup) {
  const coupler::InitialSpec& initial = setup.fluid->initial;
  return initial.type == coupler::InitialFlow::rest && initial.noise == 0 && !setup.start &&
         std::ranges::none_of(setup.boundary, &coupler::BoundarySpec::is_inlet);
}

std::int64_t quiet_start_steps(const Case& setup) {
  if (!setup.fluid || !setup.fluid->quiet_start || !begins_at_rest(setup) || !is_loaded(setup)) return 0;
  double way = 0;
  for (int d = 0; d < 3; ++d) way = std::max(way, (setup.periodic(d) ? 1. : 2.) * setup.cells[d]);
  const std::int64_t stride = setup.coarsening ? setup.coarsening->stride() : 1;
  return stride * std::int64_t(std::ceil(way * std::numbers::sqrt3 / double(stride)));
}

std::vector<rigid::BoundingBox> entrances_of(const Case& setup) {
  std::vector<rigid::BoundingBox> boxes;
  for (const FillSpec& fill : setup.fills)
    if (fill.every > 0) boxes.push_back(fill.box);
  return boxes;
}

void put_at(BodySpec& body, const rigid::Vec3& point, const rigid::Extent& extent) {
  rigid::Vec3& centre = body.pose.position;
  centre = point - body.pose.orientation * body.origin;
  const auto is_inside = [&](double x, int d) { return x >= 0 && x <= extent.size[d]; };
  for (int d = 0; d < 3; ++d)
    if (extent.periodic[d] && is_inside(point[d], d) && !is_inside(centre[d], d))
      centre[d] -= extent.size[d] * std::floor(centre[d] / extent.size[d]);
}

Place CaseRecord::place(std::string path) const {
  for (;;) {
    if (const auto found = places.find(path); found != places.end()) return found->second;
    const auto cut = path.find_last_of(".[");
    if (cut == path.npos) return {(directory / "case.toml").string()};
    path.resize(cut);
  }
}

std::vector<Entry> entries_of(const Case& setup) {
  std::vector<Entry> entries;
  std::map<int, std::size_t> places;  // by entry of [[bodies]]
  setup.for_each_given([&](const BodySpec& body, std::uint64_t count) {
    const auto [place, is_new] = places.try_emplace(body.entry, entries.size());
    if (is_new)
      entries.push_back(
          {body, fmt::format("bodies[{}]", std::max(0, body.entry)), body.motion, body.angular_velocity});
    entries[place->second].count += count;
  });
  for (std::size_t i = 0; i < setup.fills.size(); ++i) {
    const FillSpec& fill = setup.fills[i];
    for (std::size_t size = 0; size < fill.sizes.size(); ++size) {
      Entry& entry = entries.emplace_back(Entry{fill, fmt::format("fill[{}]", i)});
      entry.shape = fill.sizes[size].shape;
      entry.count = static_cast<std::uint64_t>(FillApplication(i, 0, size).count(fill));
      entry.smallest = size == 0, entry.largest = size + 1 == fill.sizes.size();
    }
  }
  return entries;
}

std::vector<Entry> continued_entries_of(const Case& setup) {
  std::vector<Entry> entries;
  for (const ContinuedSpec& body : setup.continued) {
    Entry& entry = entries.emplace_back(Entry{body, fmt::format("bodies[{}]", body.entry), body.motion});
    entry.shape = body.sizes.front().shape;
  }
  return entries;
}

double fastest_given(const Case& setup) {
  double fastest = fastest_of_sides_and_start(setup);
  for (const Entry& entry : entries_of(setup)) {
    const double radius = rigid::bounding_radius(setup.shapes[entry.shape]);
    fastest = std::max(fastest, entry.velocity.norm() + radius * entry.angular_velocity.norm());
  }
  for (const auto& [kind, motion] : setup.kind_motions)
    fastest =
        std::max(fastest, motion.speed_bound(rigid::bounding_radius(setup.shapes[setup.kind_shapes[kind]])));
  for (const CurvedWall& wall : setup.walls)
    fastest =
        std::max(fastest, wall.mesh() ? wall.mesh()->motion.speed_bound(wall.mesh()->reach())
                                      : std::abs(wall.tube()->angular_velocity) * wall.tube()->tube.radius);
  return fastest;
}

/// Bodies and walls are in the finest cells; sides and the initial fluid may be in the widest, where the
/// viscosity is that much smaller.
double cell_reynolds(const Case& setup) {
  const int widest = setup.coarsening ? 1 << setup.coarsening->levels : 1;
  return std::max(fastest_given(setup), fastest_of_sides_and_start(setup) * widest) /
         setup.fluid->kinematic_viscosity;
}

}  // namespace silt
