#include <algorithm>
#include <cmath>

#include "parallel/collectives.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/results/quantity_computation.hpp"

namespace silt {

namespace {

using rigid::Vec3;

constexpr int samples_per_radius = 8;

/// One point in each of the equal cells of a box, on a sheared lattice, so that no row lies along the surface
/// of a body aligned with the axes. Endless along a whole period.
struct SampledBox {
  Vec3 lower, upper, spacing;
  std::array<std::int64_t, 3> count;
  std::array<bool, 3> endless;

  SampledBox(const QuantitySpec& q, double widest, const rigid::Extent& extent)
      : lower(q.box.lower), upper(q.box.upper) {
    for (int d = 0; d < 3; ++d) {
      const double edge = upper[d] - lower[d];
      count[d] = std::max<std::int64_t>(1, std::llround(std::ceil(edge / widest)));
      spacing[d] = edge / double(count[d]);
      endless[d] = extent.periodic[d] && edge >= extent.size[d];
    }
  }
  double volume() const { return (upper - lower).prod(); }
  bool meets(const rigid::BoundingBox& b) const {
    for (int d = 0; d < 3; ++d)
      if (!endless[d] && (b.upper[d] < lower[d] || b.lower[d] > upper[d])) return false;
    return true;
  }
  bool holds(const rigid::BoundingBox& b) const {
    for (int d = 0; d < 3; ++d)
      if (!endless[d] && (b.lower[d] < lower[d] || b.upper[d] > upper[d])) return false;
    return true;
  }
  std::int64_t cell(int d, double x) const {
    const std::int64_t at = std::llround(std::floor((x - lower[d]) / spacing[d]));
    return endless[d] ? at : std::clamp<std::int64_t>(at, 0, count[d] - 1);
  }
  Vec3 point(std::int64_t i, std::int64_t j, std::int64_t k) const {
    constexpr double shear_x = 0.6180339887498949, shear_y = 0.7548776662466927;  // badly approximable
    const double x = double(i), y = double(j), z = double(k);
    const double shift_y = shear_x * x, shift_z = shear_y * y + shear_x * x;
    return lower + spacing.cwiseProduct(
                       Vec3(x + 0.5, y + shift_y - std::floor(shift_y), z + shift_z - std::floor(shift_z)));
  }
};

/// Returns the length, in cells, of the line from x to `length` above it inside any of the parts.
double length_inside(const Vec3& x, double length, std::span<const rigid::Part> parts,
                     const rigid::Pose& pose) {
  const Vec3 first = pose.to_body(x), up = pose.orientation.conjugate() * Vec3::UnitZ();
  std::vector<std::pair<double, double>> intervals;
  for (const rigid::Part& part : parts)
    if (const auto in = rigid::line_interval(part.shape, part.pose.to_body(first),
                                             part.pose.orientation.conjugate() * up))
      intervals.emplace_back(std::max(in->enter, 0.0), std::min(in->leave, length));
  std::sort(intervals.begin(), intervals.end());
  double inside = 0, covered = 0;  // covered: upper end of the union so far
  for (const auto& [enter, leave] : intervals) {
    inside += std::max(0.0, leave - std::max(enter, covered));
    covered = std::max(covered, leave);
  }
  return inside;
}

/// Returns the volume of a body inside the box in cells: exact for a convex body wholly inside, else summed
/// along lines through convex parts, or by points if there are none.
double volume_inside(const SampledBox& box, const rigid::Shape& shape, const rigid::Pose& pose) {
  const rigid::BoundingBox bounds = rigid::bounding_box(shape, pose);
  if (!box.meets(bounds)) return 0;
  const std::vector<rigid::Part> parts = rigid::convex_parts(shape);
  if (parts.size() == 1 && box.holds(bounds)) return rigid::mass_properties(shape).volume;
  std::array<std::int64_t, 3> from, to;
  for (int d = 0; d < 3; ++d) from[d] = box.cell(d, bounds.lower[d]), to[d] = box.cell(d, bounds.upper[d]);
  const double bottom = box.endless[2] ? bounds.lower[2] : std::max(bounds.lower[2], box.lower[2]);
  const double top = box.endless[2] ? bounds.upper[2] : std::min(bounds.upper[2], box.upper[2]);
  double length = 0;  // of lines through the columns of points
  for (std::int64_t j = from[1]; j <= to[1]; ++j)
    for (std::int64_t i = from[0]; i <= to[0]; ++i) {
      const Vec3 x = box.point(i, j, 0);
      if (!parts.empty())
        length += length_inside({x[0], x[1], bottom}, top - bottom, parts, pose);
      else
        for (std::int64_t k = from[2]; k <= to[2]; ++k)
          length += rigid::contains(shape, pose.to_body(box.point(i, j, k))) * box.spacing[2];
    }
  return length * box.spacing[0] * box.spacing[1];
}

}  // namespace

double packing_fraction(const Simulation& simulation, const QuantitySpec& q) {
  const Scene& scene = simulation.scene();
  const rigid::BodySet& bodies = simulation.bodies();
  const rigid::Extent extent = extent_of(simulation.setup());
  double radius = std::numeric_limits<double>::infinity();
  for (const double r : scene.world.bounding_radii) radius = std::min(radius, r);
  const SampledBox box(q, radius / samples_per_radius, extent);
  std::array<int, 3> reach;  // to the images checked one by one
  for (int d = 0; d < 3; ++d) reach[d] = extent.periodic[d] && !box.endless[d];
  rigid::ExactSum volume;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (!q.is_about(bodies.kind[row])) continue;
    rigid::Image i;
    for (i.x = -reach[0]; i.x <= reach[0]; ++i.x)
      for (i.y = -reach[1]; i.y <= reach[1]; ++i.y)
        for (i.z = -reach[2]; i.z <= reach[2]; ++i.z)
          volume.add(volume_inside(box, scene.world.shapes[bodies.shape[row]],
                                   {bodies.position[row] + extent.shift(i), bodies.orientation[row]}));
  }
  parallel::sum_over_ranks(scene.comm, std::span(&volume, 1));
  return volume.value() / box.volume();
}

}  // namespace silt
