#pragma once
// A mesh touches any other shape. It is not convex: a collision backend says which triangles are near
// (CollisionBackend::triangles_near, triangle_pairs_near), and the contacts are found here, alike for every
// backend.
#include <span>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/convex_core.hpp"
#include "rigid/collision/mesh_features.hpp"

namespace silt::rigid {

/// A convex part of a body and where it is; the features of its surface if it is a box or a polyhedron, else
/// null.
struct ConvexAt {
  const ConvexShape& shape;
  const MeshFeatures* surface;
  const Pose& pose;
};
struct MeshAt {
  const MeshFeatures& mesh;
  const Pose& pose;
};

/// All append the contacts within `tolerance` (lattice units) ordered by feature, each once; normals point
/// from the first to the second; of those with much the same normal no more than most_contact_points. A body
/// whose centre is in the mesh's solid is seen as on the half-space under the surface's nearest point.
/// Features have 52 bits but for two meshes, where they have 63.
void append_mesh_contacts(const ConvexAt&, const MeshAt&, double tolerance, CollisionBackend&,
                          std::vector<ContactPoint>& out);
void append_mesh_contacts(const MeshAt& a, const MeshAt& b, double tolerance, CollisionBackend&,
                          std::vector<ContactPoint>& out);
/// The corners of the mesh.
void append_mesh_contacts(const MeshAt&, const HalfSpace&, const Pose& pose_of_plane, double tolerance,
                          std::vector<ContactPoint>& out);
void append_mesh_contacts(const MeshAt&, const Tube&, const Pose& pose_of_wall, double tolerance,
                          std::vector<ContactPoint>& out);

// ---- what these are made of: contacts in the frame of the (second) mesh, in any order ----

/// The feature of a contact of which either body's feature has a code of its own.
inline std::uint64_t mesh_feature(std::uint32_t code_a, std::uint32_t code_b) {
  return std::uint64_t{code_a} << 32 | code_b;
}

/// Appends the contacts of a ball (`near`: at least the triangles within its radius and the tolerance,
/// ascending, each once): outside of the solid at every point of the surface that is nearer to the centre
/// than all points around it and within the tolerance, so that a ball on the flat feels no edge; with the
/// centre in the solid at the point nearest to it. The feature is that of the mesh.
void append_ball_contacts(const Vec3& centre, double radius, const MeshFeatures&,
                          std::span<const std::uint32_t> near, double tolerance,
                          std::vector<ContactPoint>& out);

/// Appends the contacts of two solids, perhaps one twice, a at `pose`; `near`: at least the pairs of
/// triangles no further apart than the tolerance and than deepest(a, b), to which overlaps of corners and
/// edges are seen.
///
/// A corner touches a face that it is over, if nothing near it on its own mesh is further that way by more
/// than `tilt`; of faces that it is behind, the nearest and those that meet this one at an angle below pi.
/// Beside faces it touches edges and corners as those of convex bodies do. Two sharp edges that cross touch
/// along their common normal, if that is within the angle of each of them, up to `tilt`, and, where they
/// overlap, if they go on behind the other's faces for as long as they are deep: else this is no way out.
/// Corners and edges within a facet touch nothing that others do not.
void append_mesh_on_mesh(const MeshFeatures& a, const Pose& pose, const MeshFeatures& b,
                         std::span<const TrianglePair> near, double tolerance,
                         std::vector<ContactPoint>& out);
/// Lattice units: a part of the least side of both meshes' boxes.
double deepest(const MeshFeatures& a, const MeshFeatures& b);
/// Sine of the angle by which bodies that lie flat may be tilted and still touch with all corners.
inline constexpr double tilt = 0.1;

/// Appends the contacts of a convex body that is not a polytope, its centre not in the solid, perhaps one
/// twice; `near`: at least the triangles within the tolerance of it.
///
/// Triangles that look at the body's centre count. Over one of them the body has the points that it has over
/// the half-space under it (plane_points); with a sharp edge or corner of one it has those of two convex
/// bodies, if nothing of the mesh near that is further out along their normal. A triangle that the body is
/// deeply behind counts only if the way out is over it.
void append_curved_on_mesh(const ConvexShape& body, const Pose& pose, const MeshFeatures& mesh,
                           std::span<const std::uint32_t> near, double tolerance,
                           std::vector<ContactPoint>& out);
/// Appends, for any convex body that overlaps triangles and yet has no contact, as corners that are deep in
/// corners may have none, the one in which it is the least deep in the hull of these triangles, of those that
/// climb() finds from their normals.
void append_overlap(const ConvexShape& body, const Pose& pose, const MeshFeatures& mesh,
                    std::span<const std::uint32_t> near, std::vector<ContactPoint>& out);
/// Returns how deep (lattice units) a body may be behind a triangle that it does not touch; `near` has to
/// hold such triangles.
double deep_behind_faces(const ConvexShape& body);
/// Appends the points of the body within `tolerance` of the half-space under the plane through `origin` with
/// unit `outward` normal, as those of a mesh's feature.
void append_on_plane(const ConvexCore& body, const Vec3& origin, const Vec3& outward, std::uint32_t code,
                     double tolerance, std::vector<ContactPoint>& out);

}  // namespace silt::rigid
