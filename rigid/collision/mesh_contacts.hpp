#pragma once
// Where a mesh touches any other shape. It is not convex: a collision backend says which triangles are near
// (CollisionBackend::triangles_near, triangle_pairs_near), what they touch is found here, alike for every
// backend.
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/mesh_features.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

/// A convex part of a body, and the features of its surface if it is a box or a polyhedron, else null.
struct ConvexPart {
  const ConvexShape& shape;
  const MeshFeatures* surface;
};

/// All append the contacts within `tolerance` (lattice units) ordered by feature, each once; normals point
/// from the first to the second; of those with much the same normal no more than most_contact_points. A body
/// whose centre is in the mesh's solid is seen as on the half-space under the surface's nearest point.
/// Features have 52 bits but for two meshes, where they have 63.
void append_mesh_contacts(const ConvexPart&, const Pose&, const MeshFeatures&, const Pose& pose_of_mesh,
                          double tolerance, CollisionBackend&, std::vector<ContactPoint>& out);
void append_mesh_contacts(const MeshFeatures& a, const Pose& pose_a, const MeshFeatures& b,
                          const Pose& pose_b, double tolerance, CollisionBackend&,
                          std::vector<ContactPoint>& out);
/// The corners of the mesh.
void append_mesh_contacts(const MeshFeatures&, const Pose&, const HalfSpace&, const Pose& pose_of_plane,
                          double tolerance, std::vector<ContactPoint>& out);
void append_mesh_contacts(const MeshFeatures&, const Pose&, const HollowShape&, const Pose& pose_of_hollow,
                          double tolerance, std::vector<ContactPoint>& out);

/// Exchanges the two bodies of the points.
void exchange_sides(std::vector<ContactPoint>& points);

}  // namespace silt::rigid
