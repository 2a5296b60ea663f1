#include "rigid/collision/shape_parts.hpp"

#include <algorithm>

namespace silt::rigid {

ShapeParts::ShapeParts(const Shape& shape, bool with_curvature)
    : parts(convex_parts(shape)),
      sphere(is_sphere(shape)),
      half_space(std::holds_alternative<HalfSpace>(shape)),
      mirrors(half_space && std::get<HalfSpace>(shape).mirrors),
      plain(parts.size() == 1 && parts[0].pose == Pose{}),
      smooth(std::ranges::any_of(parts, [](const Part& part) { return rigid::is_smooth(part.shape); })) {
  for (const Part& part : parts) radii.push_back(reach({part.shape, Pose{}}));
  if (const auto* of = std::get_if<Tube>(&shape)) tube = *of;
  if (const auto* of = std::get_if<Mesh>(&shape)) mesh = std::make_shared<const MeshFeatures>(*of);
  if (mesh && with_curvature) facets = std::make_shared<const FacetCurvature>(*mesh);
}

std::optional<Mat3> ShapeParts::curvature_at(std::size_t piece, const Pose& pose, const Vec3& x,
                                             const Vec3& out, std::uint32_t code) const {
  const Mat3 r = pose.orientation.toRotationMatrix();
  const Vec3 outward_B = r.transpose() * out;
  const auto k = mesh   ? facets->at(code)
                 : tube ? tube->curvature(outward_B)
                        : curvature(parts[piece].shape, pose.to_body(x), outward_B);
  if (!k) return std::nullopt;
  return r * *k * r.transpose();
}

ReducedRadii reduced_radii(const Mat3& curvature_a, const Mat3& curvature_b, const Vec3& n, double arm) {
  constexpr double flat = 1e-9;  // relative to either surface's curvature
  const Mat3 k = curvature_a + curvature_b;
  const Vec3 x = n.unitOrthogonal(), y = n.cross(x);
  const double xx = x.dot(k * x), yy = y.dot(k * y), xy = x.dot(k * y);
  const double mean = 0.5 * (xx + yy), half = 0.5 * (xx - yy), apart = std::sqrt(half * half + xy * xy);
  const double least = flat * (curvature_a.norm() + curvature_b.norm());
  if (mean + apart <= least) return {arm, arm};
  const double radius = 1 / (mean + apart);
  return {radius, mean - apart <= least ? radius : 1 / (mean - apart)};
}

}  // namespace silt::rigid
