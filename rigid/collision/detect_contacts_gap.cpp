// The gap at a contact, from the curvature of both surfaces: its lubrication film and its reduced radii.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "rigid/collision/detect_contacts.hpp"
#include "rigid/collision/mesh_features.hpp"
#include "rigid/collision/shape_parts.hpp"

namespace silt::rigid {
namespace {
constexpr double least_roundness = 0.02;  // ratio of a gap's curvatures below which it is a line contact
constexpr double same_gap = 0.95;         // cosine of the largest angle between normals of one gap
}  // namespace

/// A mesh represents a smooth surface. Between two meshes there is no lubrication.
bool DetectContacts::may_lubricate(const ShapeParts& a, const ShapeParts& b) {
  const auto any = [](const ShapeParts& s) { return s.smooth || s.mesh || s.tube; };
  return (a.smooth && any(b)) || (b.smooth && any(a));
}

/// Two convex pieces that touch at one point have a lubrication film in that gap. A mesh may touch a body at
/// several points of one gap; the film is at the narrowest.
bool DetectContacts::has_lubrication(const ContactPoint& point, bool with_mesh) const {
  if (!with_mesh) return points_.size() == 1;
  return std::ranges::none_of(points_, [&](const ContactPoint& other) {
    return std::tie(other.gap, other.feature) < std::tie(point.gap, point.feature) &&
           other.normal.dot(point.normal) > same_gap;
  });
}

/// Adds the lubrication film if both surfaces are smooth and curve away from each other. At a plane of symmetry
/// it is the film between a body and its mirror image, which is twice as wide, closes twice as fast and does not
/// slide; the little that it resists rotation is left out.
void DetectContacts::add_lubrication(const Pair& p, const Piece& a, const Piece& b, const ContactPoint& point,
                                     Contact& c) const {
  if (!a.of->is_smooth(a.index) || !b.of->is_smooth(b.index)) return;
  const BodySet& bodies = p.call.bodies;
  const Vec3& n = point.normal;
  const std::uint32_t code = feature_of(point.feature);
  const auto of_a = a.of->curvature_at(a.index, a.pose, point.on_a, n, code),
             of_b = b.of->curvature_at(b.index, b.pose, point.on_b, -n, code);
  if (!of_a || !of_b) return;
  const double opening = n.dot(bodies.velocity_at(p.row_b, c.r_b) - bodies.velocity_at(p.row_a, c.r_a));
  const Vec3 middle = bodies.position[p.row_a] + 0.5 * (point.on_a + point.on_b);
  LubricatedGap gap{point.gap, p.call.dt * opening, *of_a, *of_b, middle, n, b.of->half_space};
  if (b.of->mirrors)
    gap = {2 * gap.width, 2 * gap.travel, *of_a, *of_a, bodies.position[p.row_a] + point.on_b, n};
  const double sum = gap.curvature_sum();
  if (sum > 0 && gap.curvature_product() >= least_roundness * sum * sum)
    c.lubrication = (*p.call.world.lubrication)(gap);
  if (b.of->mirrors) c.lubrication = {2 * c.lubrication.normal, 0, 0, 2 * c.lubrication.leaving};
  if (c.lubrication) c.feature |= lubrication_feature;
}

/// Returns the feature code of body a, where a is a mesh.
std::uint32_t DetectContacts::code_of_a(const Piece& b, const ContactPoint& point) {
  return b.of->mesh ? static_cast<std::uint32_t>(point.feature >> 32) : feature_of(point.feature);
}

/// Bodies of infinite mass have no arm, so that the thickness of a wall has no influence.
ReducedRadii DetectContacts::radii_of(const Pair& p, const Piece& a, const Piece& b,
                                      const ContactPoint& point) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (a.of->sphere && (b.of->sphere || b.of->half_space)) {
    const double radius = reduced(a.of->radii[0], b.of->sphere ? b.of->radii[0] : infinity);
    return {radius, radius};
  }
  const auto curvature = [&](const Piece& piece, const Vec3& x, const Vec3& out, std::uint32_t code) {
    const Vec3 out_B = piece.pose.orientation.conjugate() * out;
    return piece.of->curvature_at(piece.index, piece.pose, x, out,
                                  piece.of->mesh ? piece.of->mesh->code_across(out_B, code) : code);
  };
  const auto arm = [&](std::size_t row, const Vec3& r) {
    return p.call.bodies.is_dynamic(row) ? std::abs(point.normal.dot(r)) : infinity;
  };
  const auto of_a = curvature(a, point.on_a, point.normal, code_of_a(b, point)),
             of_b = curvature(b, point.on_b, -point.normal, feature_of(point.feature));
  if (!of_a || !of_b) return {};
  return reduced_radii(*of_a, *of_b, point.normal,
                       reduced(arm(p.row_a, point.on_a), arm(p.row_b, point.on_b - p.from_a_to_b)));
}

}  // namespace silt::rigid
