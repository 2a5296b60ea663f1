#include "rigid/collision/separating_plane.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "rigid/collision/deepest_direction.hpp"

namespace silt::rigid {
namespace {

/// Overlap, relative to the pair's size, that separated bodies may have.
constexpr double touching = 1e-7;

/// Returns a point inside a core.
Vec3 middle_of(const ConvexCore& core) {
  Vec3 sum = Vec3::Zero();
  for (int d = 0; d < 3; ++d) sum += core.support(Vec3::Unit(d)) + core.support(-Vec3::Unit(d));
  return sum / 6;
}

/// Two convex bodies, the first of which moves relative to the second.
std::optional<SeparatingPlane> plane_between(const ConvexShape& shape_a, const Pose& before,
                                             const Pose& after, const ConvexShape& shape_b,
                                             const Pose& frame) {
  const ConvexCore a = convex_core(shape_a, before), moved = convex_core(shape_a, after),
                   b = convex_core(shape_b, Pose{});
  const double radii = a.radius + b.radius, size = length_scale(a, b), slack = touching * size;
  const auto least_gap = [&](const Vec3& n) {
    return std::min(core_separation(a, b, n), core_separation(moved, b, n)) - radii;
  };
  std::optional<Vec3> n;
  if (const auto found = nearest_approach(moved, b, std::numeric_limits<double>::infinity()))
    n = found->peak.normal;
  if (!n || least_gap(*n) < -slack)
    n = gjk_direction(SweptCore{a, moved}, ShrunkCore{b, middle_of(b), touching}, between_centres(a, b),
                      size);
  if (!n || least_gap(*n) < -slack) return {};
  const Vec3 normal = frame.orientation * *n;
  const double origin = normal.dot(frame.position);
  return SeparatingPlane{normal, origin + n->dot(a.support(*n)) + a.radius,
                         origin + n->dot(b.support(-*n)) - b.radius, least_gap(*n)};
}

/// Returns the vertices of the convex hull of points in a plane, counter-clockwise about its unit normal (A.
/// M. Andrew, Inf. Process. Lett. 9 (1979) 216).
std::vector<Vec3> hull_in_plane(const std::vector<Vec3>& points, const Vec3& normal) {
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<std::array<double, 2>> flat;
  for (const Vec3& x : points) flat.push_back({u.dot(x), v.dot(x)});
  std::sort(flat.begin(), flat.end());
  flat.erase(std::unique(flat.begin(), flat.end()), flat.end());
  std::vector<std::array<double, 2>> hull;
  const auto add_chain = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (auto p = first; p != last; ++p) {
      const auto turns_right = [&] {
        const auto &b = hull.back(), &a = hull[hull.size() - 2];
        return (b[0] - a[0]) * ((*p)[1] - a[1]) - (b[1] - a[1]) * ((*p)[0] - a[0]) <= 0;
      };
      while (hull.size() >= start + 2 && turns_right()) hull.pop_back();
      hull.push_back(*p);
    }
    hull.pop_back();  // the first point of the next chain
  };
  add_chain(flat.begin(), flat.end());
  add_chain(flat.rbegin(), flat.rend());
  const double height = normal.dot(points[0]);
  std::vector<Vec3> corners;
  for (const auto& [x, y] : hull) corners.push_back(x * u + y * v + height * normal);
  return corners;
}

/// Returns the part of a solid below a facet, given points of the facet: a pyramid of small slope, which is
/// inside the solid unless it has a very sharp edge there. Nothing for a facet without area.
std::optional<Polyhedron> under(const std::vector<Vec3>& points, const Vec3& normal) {
  constexpr double slope = 0.1, flatness = 1e-3;  // a facet's triangles are flat to 1e-4
  std::vector<Vec3> corners = hull_in_plane(points, normal);
  const int n = static_cast<int>(corners.size());
  if (n < 3) return {};
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : corners) middle += x / n;
  double area = 0, around = 0;
  std::vector<std::vector<int>> faces(1);
  for (int k = 0; k < n; ++k) {
    const Vec3 &x = corners[k], &y = corners[(k + 1) % n];
    area += 0.5 * normal.dot((x - middle).cross(y - middle));
    around += (y - x).norm();
    faces[0].push_back(k);
    faces.push_back({(k + 1) % n, k, n});
  }
  corners.push_back(middle - slope * 2 * area / around * normal);
  try {
    return Polyhedron{make_polyhedron_mesh(corners, faces, flatness)};
  } catch (const std::invalid_argument&) {
    return {};
  }
}

/// Returns the parts below the facets at a contact of a mesh, and below adjacent facets at small angles to
/// them, from triangles within `reach` of the contact at x (frame of the mesh).
std::vector<Polyhedron> solids_at(const MeshFeatures& mesh, std::uint32_t code, const Vec3& x, double reach) {
  constexpr double nearly_parallel = 0.9;  // cosine
  std::vector<Vec3> normals;
  std::map<std::uint32_t, std::pair<Vec3, std::vector<Vec3>>> facets;  // by number: normal and points
  mesh.surface().for_near({x.array() - reach, x.array() + reach}, [&](std::uint32_t t) {
    const Vec3 n = mesh.normal(t);
    if (n.isZero(0)) return;
    if (mesh.is_at(t, code)) normals.push_back(n);
    auto& [normal, corners] = facets.try_emplace(mesh.facet(t), n, std::vector<Vec3>{}).first->second;
    for (const Vec3& corner : mesh.surface().corners(t)) corners.push_back(corner);
  });
  std::vector<Polyhedron> solids;
  for (const auto& [number, facet] : facets) {
    const auto& [normal, corners] = facet;
    if (std::ranges::any_of(normals, [&](const Vec3& n) { return n.dot(normal) > nearly_parallel; }))
      if (const auto solid = under(corners, normal)) solids.push_back(*solid);
  }
  return solids;
}

/// Calls use(convex shape) for the shapes on which a contact of a part lies.
template <class Use>
void for_convex(const MovingPart& part, const Vec3& near, double reach, Use&& use) {
  if (part.convex) return use(*part.convex);
  for (const Polyhedron& solid : solids_at(*part.mesh, part.code, part.before.to_body(near), reach))
    use(solid);
}

/// The same for one of the poses after the step.
std::optional<SeparatingPlane> plane_until(const MovingPart& a, const MovingPart& b, Pose MovingPart::*after,
                                           const Vec3& near, double reach) {
  std::optional<SeparatingPlane> closest;
  bool meets = false;
  for_convex(a, near, reach, [&](const ConvexShape& of_a) {
    for_convex(b, near, reach, [&](const ConvexShape& of_b) {
      if (meets) return;
      const auto found = plane_between(of_a, a.before.relative_to(b.before), (a.*after).relative_to(b.*after),
                                       of_b, b.before);
      if (!found)
        meets = true;
      else if (!closest || found->least < closest->least)
        closest = found;
    });
  });
  return meets ? std::nullopt : closest;
}

}  // namespace

std::optional<SeparatingPlane> separating_plane(const MovingPart& a, const MovingPart& b, const Vec3& near,
                                                double reach) {
  const auto found = plane_until(a, b, &MovingPart::after, near, reach);
  if (!found || found->least + found->normal.dot(b.fall - a.fall) >= 0) return found;
  const auto falling = plane_until(a, b, &MovingPart::fallen, near, reach);
  return falling ? falling : found;
}

}  // namespace silt::rigid
