#pragma once
// Where a convex body that is not a polytope touches a surface of triangles.
#include <span>
#include <vector>

#include "rigid/collision/mesh_on_mesh.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

/// Appends the contacts within `tolerance` (lattice units) of a convex body at `pose`, its centre not in the
/// solid, in the frame of the mesh, in any order, perhaps one twice; `near`: at least the triangles within
/// the tolerance of it.
///
/// Triangles that look at the body's centre count. Over one of them the body has the points that it has over
/// the half-space under it (plane_points); with a sharp edge or corner of one it has those of two convex
/// bodies, if nothing of the mesh near that is further out along their normal. A triangle that the body is
/// deeply behind counts only if the way out is over it.
void append_curved_on_mesh(const ConvexShape& body, const Pose& pose, const MeshFeatures& mesh,
                           std::span<const std::uint32_t> near, double tolerance,
                           std::vector<MeshContact>& out);

/// Appends, for a body that overlaps triangles and yet has no contact, as corners that are deep in corners
/// may have none, the one in which it is the least deep in the hull of these triangles, of those that climb()
/// finds from their normals. Of any convex body.
void append_overlap(const ConvexShape& body, const Pose& pose, const MeshFeatures& mesh,
                    std::span<const std::uint32_t> near, std::vector<MeshContact>& out);

/// How deep (lattice units) it may be behind a triangle that it does not touch; `near` has to hold those.
double deep_behind_faces(const ConvexShape& body);

/// Appends the points of the body within `tolerance` of the half-space under the plane through `origin` with
/// unit `outward` normal, as those of a mesh's feature.
void append_on_plane(const ConvexShape& body, const Pose& pose, const Vec3& origin, const Vec3& outward,
                     std::uint32_t code, double tolerance, std::vector<MeshContact>& out);

}  // namespace silt::rigid
