#pragma once
// The direction in which two convex cores are furthest apart, or least deep in each other, and the ways that
// lead to it. n is a unit vector from a to b, lengths are lattice units; all are deterministic.
#include <limits>
#include <optional>

#include "rigid/collision/convex_core.hpp"
#include "rigid/collision/outline.hpp"

namespace silt::rigid {

/// A direction in which two cores are nearest or least deep in each other, and where they meet.
struct Approach {
  Peak peak;
  CommonPoint where;  // not set for two boxes
};

/// Returns nothing where the shapes are found to be more than `tolerance` apart. Two boxes are answered by
/// deepest_separation(), all others by deepest_direction().
std::optional<Approach> nearest_approach(const ConvexCore& a, const ConvexCore& b, double tolerance);

/// Returns nothing where the cores are found to be more than `reach` apart. With a curved core, and no
/// polyhedron of many corners, climb() is tried at once, from the direction between the centres or, with an
/// ellipsoid, from the normal to the plane that would part two ellipsoids of these widths; else, and where
/// that has no proof, GJK for cores that are apart, and walk_uphill() for those that overlap, both from the
/// direction between the centres, lead to where proven_direction() starts. Polytopes that overlap have their
/// least depth by least_depth(), if they have few edges.
std::optional<Approach> deepest_direction(const ConvexCore& a, const ConvexCore& b, double reach);

/// Returns the approach that climb() finds from n. If both cores have a point on the normal that it found,
/// the direction is one of nearest approach. It is the only one if the cores are apart: then the separation
/// is a concave function of the direction. It is the best one of cores that overlap if is_least_depth() says
/// so; else least_depth() or search_directions() tells.
std::optional<Approach> proven_direction(const ConvexCore& a, const ConvexCore& b, const Vec3& n,
                                         double reach);

/// The direction between the centres; the same one every time for cores with one centre.
Vec3 between_centres(const ConvexCore& a, const ConvexCore& b);

// ---- deepest_direction_boxes.cpp: closed forms for two boxes, exact up to rounding (1e-12 of the size) ----

/// Returns nothing where the gap is found to exceed `tolerance` (cores apart by more than tolerance + radii).
/// Overlapping cores: the largest of the separating-axis candidates (the faces of the Minkowski difference:
/// face normals and crossed edges; Gottschalk, Lin, Manocha, SIGGRAPH 1996, section 5). Cores apart: the
/// closest features of two polytopes are a vertex and anything (16 distances from a point to a box) or two
/// edges whose interiors cross, which the separating axis normal to both shows.
std::optional<Peak> deepest_separation(const ConvexCore& a, const ConvexCore& b, double tolerance);

/// The largest of the separating-axis candidates: a lower bound of the gap of the cores, and exact where they
/// overlap and one is a box. core_gap is minus infinity for a pair without candidates (spheres, parallel
/// capsules). Any face's axis with a separation above `enough` ends the search.
Peak best_separating_axis(const ConvexCore& a, const ConvexCore& b,
                          double enough = std::numeric_limits<double>::infinity());

/// The separating-axis candidate within `angle` (radian) of n, or n itself.
Vec3 nearest_candidate_axis(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double angle);

// ---- deepest_direction_climb.cpp ----

/// climb() tries the features near by this often, by default.
inline constexpr int climb_rounds = 12;

/// Returns a local maximum of core_separation(n) near n: never lower than at n by more than rounding, exact
/// to rounding where it gets there, which it does from anywhere near. Along a smooth piece of both boundaries
/// Newton's method on the sphere: with the supports' difference D(n) and K = -dD/dn the step in the tangent
/// plane T solves (T'KT + n.D) x = T'D. Where n stays where the supporting feature changes (an edge of either
/// core stays normal to n) the same on that circle; two circles, or a face, leave one direction. All of these
/// within `angle` (radian) of n are tried and the highest kept, until nothing rises, at most so many times:
/// the first finds it where no other features come up on the way.
Peak climb(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double angle,
           int most_rounds = climb_rounds);

// ---- deepest_direction_gjk.cpp (Gilbert, Johnson, Keerthi, IEEE J. Robotics Automation 4 (1988) 193) ----

/// Returns the direction from a to b moved by `shift`, good to some 1e-4 radian; `start` is any direction,
/// the nearer to the answer the sooner done. Nothing where the cores overlap or are apart by less than 1e-9
/// of their size.
std::optional<Vec3> gjk_direction(const ConvexCore& a, const ConvexCore& b, const Vec3& shift,
                                  const Vec3& start);

/// The hull of a core at two poses.
struct SweptCore {
  const ConvexCore &before, &after;
  Vec3 support(const Vec3& n) const {
    const Vec3 x = before.support(n), y = after.support(n);
    return n.dot(x) >= n.dot(y) ? x : y;
  }
};
/// A core made smaller about a point inside it: what it touches is then apart from it.
struct ShrunkCore {
  const ConvexCore& core;
  Vec3 middle;
  double by;  // part of its size
  Vec3 support(const Vec3& n) const { return (1 - by) * core.support(n) + by * middle; }
};
/// Returns that direction for cores swept and shrunk; rounding is relative to `size`.
std::optional<Vec3> gjk_direction(const SweptCore& a, const ShrunkCore& b, const Vec3& start, double size);

/// Walks uphill from n in the separation of the cores, overlapping or not: b is moved off along n and the
/// nearest direction taken for n, until it stays. That is the proximal-point method: every round finds the
/// largest s(m) + t m.n.
Vec3 walk_uphill(const ConvexCore& a, const ConvexCore& b, const Vec3& n);

/// Says whether both are boxes or polyhedra with volume, and have so few edges that to look at all pairs of
/// them takes less time than a search over directions.
bool has_few_edges(const ConvexCore& a, const ConvexCore& b);

/// The largest separation of two such cores that overlap, exact to rounding: the difference b - a is a
/// polytope, whose faces are normal to a face of either or span an edge of each, and the origin in it is
/// least deep below one of them. Two edges span a face if the arcs of directions in which they support their
/// core cross (of a, and of b turned round: the Gauss map; Gregorius, "The separating axis test between
/// convex polyhedra", GDC 2013). Of equal ones faces of a, then of b, come first.
Peak least_depth(const ConvexCore& a, const ConvexCore& b);

/// Says whether no direction has a larger separation than n, along which it is -depth (> 0), the cores
/// meeting at `where`. It is sufficient, not necessary, that the difference b - a contains the ball of radius
/// `depth` about the origin, which it does where it reaches as far in every direction m. With p the foot of
/// the normal and t the part of m across n:
/// - m within 90 degrees of n: a ball of radius r within a core that touches its boundary at p reaches
///   r (1 - m.n) further along m than p; a disc of radius r with p on its rim, whose tangent is f, at least
///   r (t.f)^2 / 2; a line through p along u that goes on for l to both sides l |t.u| >= l (t.u)^2. Those of
///   the two cores add up, and t^2 >= 1 - m.n. So it is enough that the sum of what they are of the squares
///   of a unit t is nowhere below the depth.
/// - m beyond: balls inside of the cores, near where they meet, reach as far.
bool is_least_depth(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double depth,
                    const CommonPoint& where);

inline constexpr double search_resolution = 0.02;  // radian

/// Branch and bound over the sphere of directions, by its division into triangles. The supports' difference
/// w = support_B(-m) - support_A(m) found at any m bounds the separation at all n: s(n) <= n.w. Over the
/// triangle of the directions n_1, n_2, n_3, n.w is at most its largest n_j.w (divided, where that is
/// positive, by the least distance of the flat triangle from the centre). A triangle whose bound is not above
/// the best separation found so far is dropped, else halved across its longest edge; a direction that beats
/// the best is improved by climb(). Triangles smaller than search_resolution are tried by climb() and
/// dropped: a maximum of s less than that from another that it does not lead to is not told apart from it.
///
/// `seed` is the best known so far. Returns nothing as soon as a separation above `enough` is found. Its cost
/// is some 100 supports of either core, more for bodies nearly concentric, at most some 10000.
std::optional<Peak> search_directions(const ConvexCore& a, const ConvexCore& b, const Peak& seed,
                                      double enough);

}  // namespace silt::rigid
