#pragma once
// Lubrication: what the lattice cannot resolve of the flow between close surfaces (method.md, equations 40 to
// 43). The numbers are calibrated by scripts/calibrate_lubrication, on a sphere that approaches a plate, and
// once more on one that approaches a side of the domain, which lies between cells and reflects by itself.
#include <memory>

#include "coupler/spec/coupling_spec.hpp"
#include "coupler/spec/fluid_spec.hpp"
#include "rigid/bodies/lubrication.hpp"

namespace silt::coupler {

/// The part of the flow in a gap that a wall scheme resolves, in cells.
struct ResolvedFlow {
  double base, width, cells;     // of the squeeze flow: G, 1/cells
  double slip_gap, rolling_gap;  // gaps at which it resolves these motions
};
/// The resolved flows for gaps between bodies, and between a body and a side of the domain.
struct ResolvedFlows {
  ResolvedFlow bodies, side;
};
/// `share` of multireflection, the rest is `cli` (method.md, equation 20); without effect on other
/// schemes.
ResolvedFlows resolved_flows(WallScheme, double share = 1);

class Lubrication final : public rigid::LubricationLaw {
 public:
  /// least_gap: below it the film resists no more, in cells; 0: relative_least_gap of the reduced radius.
  Lubrication(double viscosity, const ResolvedFlows&, double least_gap);
  /// Returns the gap from which on the lattice resolves the squeeze flow even with no cell in the gap.
  double reach() const override { return reach_; }
  rigid::LubricationResistance operator()(const rigid::LubricatedGap&) const override;

  static constexpr double relative_least_gap = 1e-3;  // roughness of smooth spheres

 private:
  double viscosity_;
  ResolvedFlows resolved_;
  double least_gap_, reach_;
};

/// Returns the law of a fluid of this kinematic viscosity, for what the wall scheme leaves unresolved.
std::shared_ptr<const rigid::LubricationLaw> make_lubrication(const FluidSpec&, const CouplingSpec&);

}  // namespace silt::coupler
