#pragma once
// The effect of an impact on the fluid around a body (method.md, equations 44 and 45): the impulse of a
// contact on the entrained fluid is stored with the bodies (CouplingState::pending_impact, equal and
// opposite), which pass it on as the fluid responds.
#include "rigid/response/contact_resolver.hpp"

namespace silt::coupler {

/// Added mass over displaced mass of a sphere in contact with a plane that moves along the normal (and of two
/// equal spheres that separate): 3/2 zeta(3) - 1, from the images of its dipole, the n-th of strength n^-3
/// (H. Lamb, Hydrodynamics, articles 98, 99). Used for every shape.
inline constexpr double entrained_at_contact = 0.8030853;

/// Stores the entrained fluid's part of each impact with both bodies.
class EntrainedFluid final : public rigid::ImpactSink {
 public:
  /// `entrained`: mass of the entrained fluid over displaced mass.
  explicit EntrainedFluid(double entrained = entrained_at_contact) : entrained_(entrained) {}
  rigid::Vec3 operator()(rigid::BodySet&, const rigid::Impact&) const override;

 private:
  double entrained_;
};

/// Adds this step's part of pending impacts to the forces on owned bodies. Call before solving for any body.
/// The pressure on a sphere started impulsively decays as exp(-s) cos(s), s = c_s t / R (sound); the pending
/// impulse decays as exp(-s), with R of the sphere of equal volume.
void apply_pending_impacts(rigid::BodySet&);

}  // namespace silt::coupler
