#pragma once
// Searches for the contact normal of two convex cores: the direction of greatest separation or least
// penetration depth. n is a unit vector from a to b; lengths are in lattice units.
#include <limits>
#include <optional>

#include "rigid/collision/convex_core.hpp"
#include "rigid/collision/outline.hpp"

namespace silt::rigid {

/// The contact normal of two cores, with the separation along it and the point where they meet.
struct Approach {
  Peak peak;
  CommonPoint where;  // not set for two boxes
};

/// Returns nothing if the shapes are found to be more than `tolerance` apart. Uses deepest_separation() for
/// two boxes, deepest_direction() for all other pairs.
std::optional<Approach> nearest_approach(const ConvexCore& a, const ConvexCore& b, double tolerance);

/// Returns nothing if the cores are found to be more than `reach` apart. With a curved core and no polyhedron
/// of many vertices, climb() starts at once, from the direction between the centres or, with an ellipsoid,
/// from the normal of a plane between two ellipsoids of these widths. For other pairs, or if that has no
/// proof, proven_direction() starts from the result of GJK (separated cores) or walk_uphill() (overlapping
/// cores). The depth of overlapping polytopes with few edges comes from least_depth().
std::optional<Approach> deepest_direction(const ConvexCore& a, const ConvexCore& b, double reach);

/// Returns the approach that climb() finds from n. If both cores have a point on the normal found, the
/// direction is a local maximum of the separation. For separated cores it is the only one: the separation is
/// concave. For overlapping cores is_least_depth() may prove it; else least_depth() or search_directions()
/// decides.
std::optional<Approach> proven_direction(const ConvexCore& a, const ConvexCore& b, const Vec3& n,
                                         double reach);

/// Returns the direction between the centres; for coinciding centres an arbitrary one, always the same.
Vec3 between_centres(const ConvexCore& a, const ConvexCore& b);

// ---- deepest_direction_boxes.cpp: closed forms for two boxes, exact up to rounding (1e-12 of the size) ----

/// Returns nothing if the gap is found to exceed `tolerance` (cores more than tolerance + radii apart).
/// Overlapping cores: the largest of the separating-axis candidates, the faces of the Minkowski difference
/// (face normals and crossed edges; Gottschalk, Lin, Manocha, SIGGRAPH 1996, section 5). Separated cores: the
/// closest features of two polytopes are a vertex and any feature (16 distances from a point to a box), or
/// two edges whose interiors cross, which the separating axis normal to both detects.
std::optional<Peak> deepest_separation(const ConvexCore& a, const ConvexCore& b, double tolerance);

/// Returns the largest of the separating-axis candidates: a lower bound of the cores' gap, exact if they
/// overlap and one is a box. core_gap is minus infinity for a pair without candidates (spheres, parallel
/// capsules). The search ends at the first face normal with a separation above `enough`.
Peak best_separating_axis(const ConvexCore& a, const ConvexCore& b,
                          double enough = std::numeric_limits<double>::infinity());

/// Returns the separating-axis candidate within `angle` (radians) of n, or n itself.
Vec3 nearest_candidate_axis(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double angle);

// ---- deepest_direction_climb.cpp ----

/// Default limit of the rounds in which climb() tries nearby features.
inline constexpr int climb_rounds = 12;

/// Returns a local maximum of core_separation(n) near n, exact to rounding if it converges (it does from
/// anywhere near); never lower than at n by more than rounding. On a smooth piece of both boundaries it is
/// Newton's method on the sphere: with the difference D(n) of the support points and K = -dD/dn, the step x
/// in the tangent plane T solves (T'KT + n.D) x = T'D. Where the supporting feature changes with n (an edge
/// of either core stays normal to n) the same is done on that great circle; two circles, or a face, leave one
/// direction. Each round tries all of these within `angle` (radians) of n and keeps the highest, until none
/// is higher. One round suffices if no other feature gets in the way.
Peak climb(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double angle,
           int most_rounds = climb_rounds);

// ---- deepest_direction_gjk.cpp (Gilbert, Johnson, Keerthi, IEEE J. Robotics Automation 4 (1988) 193) ----

/// Returns the direction from a to b translated by `shift`, to some 1e-4 radian. `start` is any direction; a
/// good one saves iterations. Returns nothing if the cores overlap or are less than 1e-9 of their size apart.
std::optional<Vec3> gjk_direction(const ConvexCore& a, const ConvexCore& b, const Vec3& shift,
                                  const Vec3& start);

/// The convex hull of a core at two poses.
struct SweptCore {
  const ConvexCore &before, &after;
  Vec3 support(const Vec3& n) const {
    const Vec3 x = before.support(n), y = after.support(n);
    return n.dot(x) >= n.dot(y) ? x : y;
  }
};
/// A core shrunk about an interior point, so that touching bodies become separated.
struct ShrunkCore {
  const ConvexCore& core;
  Vec3 middle;
  double by;  // fraction of its size
  Vec3 support(const Vec3& n) const { return (1 - by) * core.support(n) + by * middle; }
};
/// The same for a swept and a shrunk core; rounding is relative to `size`.
std::optional<Vec3> gjk_direction(const SweptCore& a, const ShrunkCore& b, const Vec3& start, double size);

/// Walks uphill from n on the separation of the cores, overlapping or not: b is translated along n, and the
/// direction between the nearest points becomes the next n, until it is constant. This is the proximal-point
/// method: each round maximises s(m) + t m.n.
Vec3 walk_uphill(const ConvexCore& a, const ConvexCore& b, const Vec3& n);

/// Returns whether both are boxes or polyhedra with a volume, with so few edges that testing all pairs of
/// edges is faster than a search over directions.
bool has_few_edges(const ConvexCore& a, const ConvexCore& b);

/// Returns the largest separation of two such overlapping cores, exact to rounding. The Minkowski difference
/// b - a is a polytope; each of its faces is normal to a face of a or b or spanned by an edge of each, and
/// the depth is the least distance from the origin to a face. Two edges span a face if the arcs of directions
/// that support them (of a, and of b reversed) cross on the Gauss map (Gregorius, "The separating axis test
/// between convex polyhedra", GDC 2013). Among equal ones faces of a come first, then faces of b.
Peak least_depth(const ConvexCore& a, const ConvexCore& b);

/// Returns whether -s(n) = depth > 0 is proven to be the least depth of cores that meet at `where`. A
/// sufficient condition: the difference b - a contains the ball of radius `depth` about the origin, so it
/// extends that far in every direction m. With p the foot of the normal and t the part of m across n:
/// - m within 90 degrees of n: a ball of radius r inside a core that touches its boundary at p extends
///   r (1 - m.n) further along m than p; a disc of radius r with p on its rim and tangent f at least
///   r (t.f)^2 / 2; a line through p along u of length l to both sides l |t.u| >= l (t.u)^2. The
///   contributions of both cores add up, and t^2 >= 1 - m.n, so their coefficients must sum to the depth for
///   every unit t.
/// - other m: balls inside the cores, near the point where they meet, extend as far.
bool is_least_depth(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double depth,
                    const CommonPoint& where);

inline constexpr double search_resolution = 0.02;  // radian

/// Branch and bound over a triangulation of the sphere of directions. The difference of support points at any
/// m, w = support_B(-m) - support_A(m), bounds the separation at all n: s(n) <= n.w. Over the triangle of
/// directions n_1, n_2, n_3, n.w is at most the largest n_j.w (where positive, divided by the least distance
/// of the flat triangle from the centre). A triangle whose bound does not exceed the best separation found is
/// discarded, any other is bisected across its longest edge; climb() improves every direction that exceeds
/// the best. Triangles smaller than search_resolution are tried by climb() and discarded.
///
/// `seed` is the best direction known. Returns nothing as soon as a separation above `enough` is found. The
/// cost is some 100 support points of either core, more for nearly concentric bodies, at most some 10000.
std::optional<Peak> search_directions(const ConvexCore& a, const ConvexCore& b, const Peak& seed,
                                      double enough);

}  // namespace silt::rigid
