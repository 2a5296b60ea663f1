#pragma once
// The direction in which two convex shapes are furthest apart, or least deep in each other, in closed form.
#include <limits>
#include <optional>

#include "rigid/collision/rounded_box.hpp"

namespace silt::rigid {

struct Separation {
  Vec3 normal;  // unit, from a to b
  double
      core_gap;  // largest core_separation over all directions: distance of the cores, or minus their depth
};

/// Exact up to rounding (1e-12 of the size). Nothing where the gap is found to exceed `tolerance` (lattice
/// units; cores apart by more than tolerance + radii).
/// Overlapping cores: the largest of the separating-axis candidates (the faces of the Minkowski difference:
/// face normals and crossed edges; Gottschalk, Lin, Manocha, SIGGRAPH 1996, section 5). Cores apart: the
/// closest features of two polytopes are a vertex and anything (16 distances from a point to a box) or two
/// edges whose interiors cross, which the separating axis normal to both shows.
std::optional<Separation> deepest_separation(const RoundedBox& a, const RoundedBox& b, double tolerance);

/// The largest of the separating-axis candidates: a lower bound of the gap of the cores, and exact where they
/// overlap and one is a box. core_gap is minus infinity for a pair without candidates (spheres, parallel
/// capsules). Any face's axis with a separation above `enough` ends the search.
Separation best_separating_axis(const RoundedBox& a, const RoundedBox& b,
                                double enough = std::numeric_limits<double>::infinity());

/// The separating-axis candidate within `angle` (radian) of unit n, or n itself.
Vec3 nearest_candidate_axis(const RoundedBox& a, const RoundedBox& b, const Vec3& n, double angle);

}  // namespace silt::rigid
