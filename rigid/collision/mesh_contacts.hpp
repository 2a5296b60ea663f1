#pragma once
// Contacts of meshes with all other shapes. A mesh is not convex: a collision backend finds the triangles
// nearby (CollisionBackend::triangles_near, triangle_pairs_near), and the contacts are computed here.
#include <span>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/convex_core.hpp"
#include "rigid/collision/mesh_features.hpp"

namespace silt::rigid {

/// A convex part and its pose; `surface` has the features of a box or polyhedron, else null.
struct ConvexAt {
  const ConvexShape& shape;
  const MeshFeatures* surface;
  const Pose& pose;
};
struct MeshAt {
  const MeshFeatures& mesh;
  const Pose& pose;
};

/// The overloads append the contacts within `tolerance` (lattice units), each once, ordered by feature; of
/// nearly equal normals at most most_contact_points. Normals point from the first argument to the second. A
/// body whose centre is in the mesh's solid touches the half-space under the nearest surface point instead.
/// Features have 52 bits, for two meshes 63.
void append_mesh_contacts(const ConvexAt&, const MeshAt&, double tolerance, CollisionBackend&,
                          std::vector<ContactPoint>& out);
void append_mesh_contacts(const MeshAt& a, const MeshAt& b, double tolerance, CollisionBackend&,
                          std::vector<ContactPoint>& out);
/// Contacts of the mesh's vertices.
void append_mesh_contacts(const MeshAt&, const HalfSpace&, const Pose& pose_of_plane, double tolerance,
                          std::vector<ContactPoint>& out);
void append_mesh_contacts(const MeshAt&, const Tube&, const Pose& pose_of_wall, double tolerance,
                          std::vector<ContactPoint>& out);

// ---- building blocks: contacts in the frame of the (second) mesh, in any order ----

/// The feature of a contact with a code for each body.
inline std::uint64_t mesh_feature(std::uint32_t code_a, std::uint32_t code_b) {
  return std::uint64_t{code_a} << 32 | code_b;
}

/// Appends the contacts of a ball; `near` has at least the triangles within its radius plus tolerance,
/// ascending, each once. With the centre outside the solid: every surface point within the tolerance that is
/// a local minimum of the distance to the centre, so that a ball on a flat surface touches no edge. With the
/// centre inside: the nearest surface point. The feature is that of the mesh.
void append_ball_contacts(const Vec3& centre, double radius, const MeshFeatures&,
                          std::span<const std::uint32_t> near, double tolerance,
                          std::vector<ContactPoint>& out);

/// Appends the contacts of two solids, some perhaps twice; a has the pose `pose`. `near` has at least the
/// pairs of triangles within the tolerance and within deepest(a, b), the greatest depth considered.
///
/// A vertex touches a face over which it lies unless its own mesh near it extends further that way by more
/// than `tilt`; behind several faces, it touches the nearest and those that meet this one at an angle below
/// pi. Beside faces it touches edges and vertices as on convex bodies. Two sharp crossing edges touch along
/// their common normal if it is within the normal cone of both, up to `tilt`, and, if they overlap, if they
/// continue behind the other's faces for at least their depth; otherwise that direction does not separate
/// them. Features within a facet touch nothing themselves.
void append_mesh_on_mesh(const MeshFeatures& a, const Pose& pose, const MeshFeatures& b,
                         std::span<const TrianglePair> near, double tolerance,
                         std::vector<ContactPoint>& out);
/// Returns a fraction of the least side of both meshes' boxes (lattice units).
double deepest(const MeshFeatures& a, const MeshFeatures& b);
/// Sine of the largest tilt at which bodies that lie flat touch with all their corners.
inline constexpr double tilt = 0.1;

/// Appends the contacts of a convex body other than a polytope, with its centre outside the solid, some
/// perhaps twice; `near` has at least the triangles within the tolerance of it.
///
/// Only triangles that face the body's centre count. With such a triangle the body has those contacts with
/// the half-space under it (plane_points) and lie over the triangle. With sharp edges and corners it has the
/// contacts of two convex bodies, unless the mesh nearby extends further along their normal. A triangle that
/// the body is deep behind counts only if the direction of least penetration leads there.
void append_curved_on_mesh(const ConvexShape& body, const Pose& pose, const MeshFeatures& mesh,
                           std::span<const std::uint32_t> near, double tolerance,
                           std::vector<ContactPoint>& out);
/// Appends one contact of a convex body that overlaps triangles but has no contact otherwise: that of least
/// penetration of the triangles' hull, as climb() finds it from their normals.
void append_overlap(const ConvexShape& body, const Pose& pose, const MeshFeatures& mesh,
                    std::span<const std::uint32_t> near, std::vector<ContactPoint>& out);
/// Returns the greatest depth (lattice units) behind triangles without contact that `near` must contain.
double deep_behind_faces(const ConvexShape& body);
/// Appends the points of the body within `tolerance` of the half-space below the plane through `origin` with
/// unit normal `outward`, as contacts with a mesh's feature.
void append_on_plane(const ConvexCore& body, const Vec3& origin, const Vec3& outward, std::uint32_t code,
                     double tolerance, std::vector<ContactPoint>& out);

}  // namespace silt::rigid
