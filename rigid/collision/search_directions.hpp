#pragma once
// The direction in which two convex cores are furthest apart, or least deep in each other, with proof.
#include <optional>

#include "rigid/collision/climb.hpp"

namespace silt::rigid {

/// Branch and bound over the sphere of directions, by its division into triangles. The supports' difference
/// w = support_B(-m) - support_A(m) found at any m bounds the separation at all n: s(n) <= n.w. Over the
/// triangle of the directions n_1, n_2, n_3, n.w is at most its largest n_j.w (divided, where that is
/// positive, by the least distance of the flat triangle from the centre). A triangle whose bound is not above
/// the best separation found so far is dropped, else halved across its longest edge; a direction that beats
/// the best is improved by climb(). Triangles smaller than search_resolution are tried by climb() and
/// dropped: a maximum of s less than that from another that it does not lead to is not told apart from it.
///
/// `seed` is the best known so far. Returns nothing as soon as a separation above `enough` (lattice units) is
/// found. Deterministic; its cost is some 100 supports of either core, more for bodies nearly concentric, at
/// most some 10000.
std::optional<Peak> search_directions(const ConvexCore& a, const ConvexCore& b, const Peak& seed,
                                      double enough);

/// Radian.
inline constexpr double search_resolution = 0.02;

}  // namespace silt::rigid
