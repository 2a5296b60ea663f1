#pragma once
// Where two surfaces of triangles touch: corners on faces and edges on edges.
#include <span>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/mesh_features.hpp"

namespace silt::rigid {

/// A contact of two meshes: its feature has not the bits for two of theirs.
struct MeshContact {
  ContactPoint point;  // its feature is not set
  std::uint32_t code_a, code_b;
  auto key() const { return std::tuple(code_a, code_b, point.gap); }
};

/// Appends the contacts within `tolerance` (lattice units) of two solids, in any order, perhaps one twice, in
/// the frame of b, a at `pose`; `near`: at least the pairs of triangles no further
/// apart than the tolerance and than deepest(a, b), to which overlaps of corners and edges are seen.
///
/// A corner touches a face that it is over, if nothing near it on its own mesh is further that way by more
/// than `tilt`; of faces that it is behind, the nearest and those that meet this one at an angle below pi.
/// Beside faces it touches edges and corners as those of convex bodies do. Two sharp edges that cross touch
/// along their common normal, if that is within the angle of each of them, up to `tilt`, and, where they
/// overlap, if they go on behind the other's faces for as long as they are deep: else this is no way out.
/// Corners and edges within a facet touch nothing that others do not.
void append_mesh_on_mesh(const MeshFeatures& a, const Pose& pose, const MeshFeatures& b,
                         std::span<const TrianglePair> near, double tolerance, std::vector<MeshContact>& out);

/// Lattice units: a part of the least side of both meshes' boxes.
double deepest(const MeshFeatures& a, const MeshFeatures& b);

/// Sine of the angle by which bodies that lie flat may be tilted and still touch with all corners.
inline constexpr double tilt = 0.1;

}  // namespace silt::rigid
