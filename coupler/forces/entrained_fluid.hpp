#pragma once
// The effect of an impact on the fluid around a body (method.md, equations 44 and 45): the impulse that a
// contact would also give to the fluid is kept with the bodies (CouplingState::pending_impact, equal and
// opposite for the two), which pass it on as the fluid answers.
#include "rigid/response/contact_resolver.hpp"

namespace silt::coupler {

/// Added mass over displaced mass of a sphere that touches a plane and moves along its normal (and of two
/// equal ones that part): 3/2 zeta(3) - 1 by the images of its dipole, n-th strength n^-3 (H. Lamb,
/// Hydrodynamics, articles 98, 99). Taken for every shape.
inline constexpr double entrained_at_contact = 0.8030853;

/// Keeps with either body of an impact what the fluid that moves with it has to take of it.
class EntrainedFluid final : public rigid::ImpactSink {
 public:
  /// `entrained`: mass of the fluid that moves with a body, over the mass it displaces.
  explicit EntrainedFluid(double entrained = entrained_at_contact) : entrained_(entrained) {}
  rigid::Vec3 operator()(rigid::BodySet&, const rigid::Impact&) const override;

 private:
  double entrained_;
};

/// Adds to the forces of this step on owned bodies what is due of their pending impacts. Call before any body
/// is solved for. The pressure on a sphere set off at once falls as exp(-s) cos(s), s = c_s t / R (sound of
/// an impulsive start); what is pending falls as exp(-s), R that of the sphere of the body's volume.
void give_pending_impacts(rigid::BodySet&);

}  // namespace silt::coupler
