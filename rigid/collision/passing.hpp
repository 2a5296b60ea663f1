#pragma once
// Bodies that pass each other stay apart in some direction while they move (method-bodies.md, The normal of
// an open contact).
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

/// Returns the plane between two parts that pass each other; nothing where they meet. The direction is that
/// of closest approach after the step, else the one in which the hull of both poses of a is nearest to b (as
/// seen from b; a turn by an angle theta bulges out of this hull by 1 - cos theta/2 of its arm). The motion
/// is that before the kick, and that with the kick if the parts pass each other then as well. Of a mesh only
/// the facets at the contact's corner, edge or facet are looked at, and those that continue them at a small
/// angle, no further than `reach` (lattice units) from the point `near` before the step.
std::optional<Passing> passing(const MovingPart& a, const MovingPart& b, const Vec3& near, double reach);

/// Part of a pair's size: a contact that is closed by less is not looked at.
inline constexpr double passing_slack = 1e-9;

}  // namespace silt::rigid
