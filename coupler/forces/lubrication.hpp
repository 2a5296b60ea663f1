#pragma once
// Lubrication: the part of the flow between close surfaces that the lattice does not resolve (method.md,
// equations 40 to 43). scripts/calibrate_lubrication determines the numbers, for a sphere that approaches a
// plate, and separately for one that approaches a side of the domain, which lies midway between nodes.
#include <memory>

#include "coupler/spec/flow_spec.hpp"
#include "rigid/bodies/lubrication.hpp"

namespace silt::coupler {

/// The resolved part of the flow in a gap for a wall scheme, in cells.
struct ResolvedFlow {
  double base, width, cells;     // for squeezing: G, 1/cells
  double slip_gap, rolling_gap;  // gaps from which these motions are resolved
};
/// The same for gaps between bodies, and between a body and a side of the domain.
struct ResolvedFlows {
  ResolvedFlow bodies, side;
};
/// `share`: fraction of multireflection, the rest being `cli` (method.md, equation 20).
ResolvedFlows resolved_flows(WallScheme, double share = 1);

class Lubrication final : public rigid::LubricationLaw {
 public:
  /// least_gap: cells; below it the resistance is constant; 0: relative_least_gap times the reduced radius.
  Lubrication(double viscosity, const ResolvedFlows&, double least_gap);
  /// Returns the gap above which the lattice resolves squeezing even without a cell in the gap.
  double reach() const override { return reach_; }
  rigid::LubricationResistance operator()(const rigid::LubricatedGap&) const override;

  static constexpr double relative_least_gap = 1e-3;  // roughness of smooth spheres

 private:
  double viscosity_;
  ResolvedFlows resolved_;
  double least_gap_, reach_;
};

/// Returns the law for the fluid's kinematic viscosity and what the wall scheme leaves unresolved.
std::shared_ptr<const rigid::LubricationLaw> make_lubrication(const FluidSpec&, const CouplingSpec&);

}  // namespace silt::coupler
