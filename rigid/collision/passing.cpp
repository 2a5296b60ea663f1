#include "rigid/collision/passing.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "rigid/collision/deepest.hpp"
#include "rigid/collision/deepest_direction.hpp"
#include "rigid/collision/gjk.hpp"
#include "rigid/shapes/defaults.hpp"

namespace silt::rigid {

namespace {

/// Part of a pair's size by which bodies that pass each other may overlap.
constexpr double touching = 1e-7;

/// The direction in which two bodies are furthest apart, or least deep in each other, in the frame of b.
std::optional<Vec3> separating_direction(const ConvexShape& a, const Pose& pose, const ConvexShape& b) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (has_rounded_box(a) && has_rounded_box(b)) {
    const auto found = deepest_separation(rounded_box(a, pose), rounded_box(b, Pose{}), infinity);
    return found ? std::optional(found->normal) : std::nullopt;
  }
  const auto found = deepest_direction(convex_core(a, pose), convex_core(b, Pose{}), infinity);
  return found ? std::optional(found->peak.normal) : std::nullopt;
}

/// A point inside a core.
Vec3 middle_of(const ConvexCore& core) {
  Vec3 sum = Vec3::Zero();
  for (int d = 0; d < 3; ++d) sum += core.support(Vec3::Unit(d)) + core.support(-Vec3::Unit(d));
  return sum / 6;
}

/// Two convex bodies, the first of which moves as seen from the second.
std::optional<Passing> convex_passing(const ConvexShape& shape_a, const Pose& before, const Pose& after,
                                      const ConvexShape& shape_b, const Pose& frame) {
  const ConvexCore a = convex_core(shape_a, before), moved = convex_core(shape_a, after),
                   b = convex_core(shape_b, Pose{});
  const double radii = a.radius + b.radius, size = length_scale(a, b), slack = touching * size;
  const auto least_gap = [&](const Vec3& n) {
    return std::min(core_separation(a, b, n), core_separation(moved, b, n)) - radii;
  };
  std::optional<Vec3> n = separating_direction(shape_a, after, shape_b);
  if (!n || least_gap(*n) < -slack)
    n = gjk_direction(SweptCore{a, moved}, ShrunkCore{b, middle_of(b), touching}, between_centres(a, b),
                      size);
  if (!n || least_gap(*n) < -slack) return {};
  const Vec3 normal = frame.orientation * *n;
  const double origin = normal.dot(frame.position);
  return Passing{normal, origin + n->dot(a.support(*n)) + a.radius,
                 origin + n->dot(b.support(-*n)) - b.radius, least_gap(*n)};
}

/// What of a solid lies under a triangle of its surface: a flat pyramid, whose apex is as deep as no edge of
/// a solid is sharp. Nothing for a triangle without area.
std::optional<Polyhedron> under(const MeshFeatures& mesh, std::uint32_t triangle) {
  constexpr double depth = 0.1;  // part of the radius of the triangle's inner circle
  std::array<Vec3, 3> x = mesh.surface().corners(triangle);
  const Vec3 n = mesh.normal(triangle);
  if (n.isZero(0)) return {};
  if (mesh.mesh().hollow) std::swap(x[1], x[2]);
  const double area = 0.5 * mesh.surface().area_normal(triangle).norm();
  const double around = (x[1] - x[0]).norm() + (x[2] - x[1]).norm() + (x[0] - x[2]).norm();
  const Vec3 apex = (x[0] + x[1] + x[2]) / 3 - depth * 2 * area / around * n;
  try {
    return Polyhedron{
        make_polyhedron_mesh({x[0], x[1], x[2], apex}, {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}})};
  } catch (const std::invalid_argument&) {
    return {};
  }
}

/// Calls use(convex shape, pose before, pose after) for what of a part a contact lies on.
template <class Use>
void for_convex(const MovingPart& part, std::uint32_t code, const Vec3& near, double reach, Use&& use) {
  if (part.convex) return use(*part.convex, part.before, part.after);
  const Vec3 x = part.before.to_body(near);
  part.mesh->surface().for_near({x.array() - reach, x.array() + reach}, [&](std::uint32_t t) {
    if (!part.mesh->is_at(t, code)) return;
    if (const auto solid = under(*part.mesh, t)) use(*solid, part.before, part.after);
  });
}

}  // namespace

std::optional<Passing> passing(const MovingPart& a, std::uint32_t code_a, const MovingPart& b,
                               std::uint32_t code_b, const Vec3& near, double reach) {
  std::optional<Passing> closest;
  bool meets = false;
  for_convex(a, code_a, near, reach, [&](const ConvexShape& of_a, const Pose& before_a, const Pose& after_a) {
    for_convex(
        b, code_b, near, reach, [&](const ConvexShape& of_b, const Pose& before_b, const Pose& after_b) {
          if (meets) return;
          const auto found =
              convex_passing(of_a, before_a.seen_from(before_b), after_a.seen_from(after_b), of_b, before_b);
          if (!found)
            meets = true;
          else if (!closest || found->least < closest->least)
            closest = found;
        });
  });
  return meets ? std::nullopt : closest;
}

}  // namespace silt::rigid
