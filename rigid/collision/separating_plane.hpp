#pragma once
// Planes between passing bodies (method-bodies.md, The normal of an open contact).
#include <optional>

#include "rigid/collision/mesh_features.hpp"
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// A part of a body, a convex shape or a mesh, with its poses before and after the step if contacts did not
/// act. All poses of a pair are in one frame, lattice units.
struct MovingPart {
  const ConvexShape* convex;
  const MeshFeatures* mesh;    // null for a convex part
  std::uint32_t code;          // of the mesh's feature in contact
  Pose before, after, fallen;  // fallen: after, including gravity's change of velocity
  Vec3 fall;                   // displacement by that change
};

/// A plane that separates a from b during the step.
struct SeparatingPlane {
  Vec3 normal;              // unit, from a to b, at the poses before the step
  double front_a, front_b;  // normal . x of the supporting planes of a and b, before the step
  double least = 0;         // the lesser gap between these planes, before and after the step
};

/// Returns the plane that separates two parts throughout the step; nothing if they meet. Its normal is the
/// direction of closest approach after the step, or else that between b and the hull of both poses of a
/// (relative to b; a rotation by theta bulges out of this hull by 1 - cos theta/2 of its arm). The motion is
/// without gravity's change of velocity, and with it if the parts are separated then, too. Of a mesh only
/// facets at the contact's feature, and adjacent ones at small angles, within `reach` (lattice units) of the
/// point `near` before the step are considered.
std::optional<SeparatingPlane> separating_plane(const MovingPart& a, const MovingPart& b, const Vec3& near,
                                                double reach);

/// Relative to the pair's size: contacts that close by less are not tested.
inline constexpr double separation_slack = 1e-9;

}  // namespace silt::rigid
