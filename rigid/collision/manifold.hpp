#pragma once
// From the direction of a contact to its points: what lies flat touches in more than one.
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/collision/rounded_box.hpp"

namespace silt::rigid {

/// Appends the points of a contact along unit `normal` (from a to b), ordered by feature, those with
/// gap <= tolerance (lattice units): for two boxes the corners of the common patch of the two faces that face
/// each other (Sutherland, Hodgman, CACM 17 (1974) 32, the face of b clipped by the planes through the edges
/// of a's face along the normal); for a capsule the ends of its part over the face; for capsules within
/// parallel_sine of parallel the ends of their common length. Requires: `core_gap`
/// is the core_separation along `normal` and the largest there is. The point that is deepest is always among
/// them.
void append_manifold(const RoundedBox& a, const RoundedBox& b, const Vec3& normal, double core_gap,
                     double tolerance, std::vector<ContactPoint>& out);

/// Appends the vertices of a box, the ends of a capsule, the lowest point of a sphere that are within
/// `tolerance` of the plane through `origin` with unit `outward` normal (out of the solid half-space b).
void append_plane_manifold(const RoundedBox& a, const Vec3& origin, const Vec3& outward, double tolerance,
                           std::vector<ContactPoint>& out);

}  // namespace silt::rigid
