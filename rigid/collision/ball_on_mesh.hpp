#pragma once
// Where a ball touches a surface of triangles.
#include <span>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/collision/mesh_features.hpp"

namespace silt::rigid {

/// Appends the contacts of a ball (frame of the mesh; `near`: at least the triangles within its radius and
/// the tolerance, ascending, each once): outside of the solid at every point of the surface that is nearer to
/// the centre than all points around it and within the tolerance (lattice units), so that a ball on the flat
/// feels no edge; with the centre in the solid at the point nearest to it. Normals point from the ball to the
/// mesh; the feature is that of the mesh.
void append_ball_contacts(const Vec3& centre, double radius, const MeshFeatures&,
                          std::span<const std::uint32_t> near, double tolerance,
                          std::vector<ContactPoint>& out);

}  // namespace silt::rigid
