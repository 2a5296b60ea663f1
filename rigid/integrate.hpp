#pragma once
// The half steps of Algorithm 1 (lines 2-5 and 21-22): drift without force.
//
// Rotation: implicit midpoint on the angular momentum in the body frame (method.md, M5 and M6; Simo,
// Wong 1991),
//   L_B' - L_B = h Lbar x (I_B^-1 Lbar),  Lbar = (L_B + L_B') / 2,   q' = q cay(h I_B^-1 Lbar),
// which keeps L in the world frame, its length and the kinetic energy to round-off, for any h.
#include "rigid/bodies/body_set.hpp"
#include "rigid/math/twist.hpp"

namespace silt::rigid {

/// Moves the bodies of the first `rows` rows by h: free ones with constant v and L, prescribed ones with
/// constant v and omega. Leaves angular_velocity = I_W^-1 L at the new orientation. Fixed bodies stay.
void drift(BodySet&, std::size_t rows, double h);

/// Returns the orientation after a free rotation over h; L_W is constant. Exposed for tests.
Quat free_rotation(const Quat& orientation, const Mat3& inertia_B, const Vec3& angular_momentum_W, double h);

}  // namespace silt::rigid
