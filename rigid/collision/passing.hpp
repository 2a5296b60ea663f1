#pragma once
// Bodies that pass each other: the direction in which they stay apart while they move.
#include <optional>

#include "rigid/collision/mesh_features.hpp"
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// A part of a body in a step: its shape, or its mesh, and its poses before and after, as its motion
/// without contacts takes it. All poses of a pair are in one frame, lattice units.
struct MovingPart {
  const ConvexShape* convex;
  const MeshFeatures* mesh;    // where it is no convex part
  std::uint32_t code;          // of a mesh: what the contact lies on
  Pose before, after, fallen;  // fallen: after, with the kick of gravity
  Vec3 fall;                   // by that kick
};

/// A plane that a stays on one side of and b on the other.
struct Passing {
  Vec3 normal;              // unit, from a to b, at the poses before the step
  double front_a, front_b;  // normal . x of the supporting planes of a and of b, before the step
  double least = 0;         // the gap between these planes, before or after the step, the lesser
};

/// Returns the plane between two parts that pass each other; nothing where they meet. Two convex parts pass
/// each other if some direction separates them at both poses: the one of closest approach after the step,
/// else the one in which the hull of both poses of a is nearest to b (as seen from b; a turn by an angle
/// theta bulges out of this hull by 1 - cos theta/2 of its arm). Parts that touch, up to 1e-7 of their size,
/// do not meet.
///
/// That is by the motion before the kick, which bodies at rest on others have, and by that with the kick if
/// they pass each other then as well, as bodies do that fall.
///
/// Of a mesh only what a contact lies on is looked at: the facets at the corner or edge of that code, or the
/// facet, and those that go on from them at a small angle, no further than `reach` (lattice units) from the
/// point `near` before the step.
std::optional<Passing> passing(const MovingPart& a, const MovingPart& b, const Vec3& near, double reach);

/// Part of a pair's size: a contact that is closed by less is not looked at.
inline constexpr double passing_slack = 1e-9;

}  // namespace silt::rigid
