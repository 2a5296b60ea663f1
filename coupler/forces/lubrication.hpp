#pragma once
// Lubrication: what the lattice cannot resolve of the flow between close surfaces.
//
// In a gap of width h with principal curvatures k1, k2 the pressure of the squeeze flow is
// p = 6 mu u / ((k1 + k2) h^2), which makes the normal force 12 pi mu u / ((k1 + k2) sqrt(k1 k2) h): for
// spheres the 6 pi mu R^2 u / h of Jeffrey, Onishi, J. Fluid Mech. 139 (1984) 261, R the reduced radius.
// Their tangential logarithms, for any two radii, are 2 pi mu R ln(1/h) against slip and 6/5 of pi mu R
// ln(1/h) against rolling (rigid/bodies/lubrication.hpp); here R becomes 1 / sqrt(k1 k2).
//
// Each law is given less what the lattice resolves by itself. Of the squeeze flow that is not the same
// wherever the gap lies in the lattice: without a fluid cell in it the lattice knows nothing of the gap, with
// a layer of cells in its middle it sees one of a cell's width. So 1/h - G stands in the place of 1/h, with
//   G = base + width h + cells sqrt(S),   S = sum over the cells of the gap of (1 - H)^2 / (2 pi R),
// H < 1 the gap's width at the cell (coupler/forces/gap_cells). A surface that fills every other place has S
// = 1/6, whatever R. The three numbers are calibrated by scripts/calibrate_lubrication, on a sphere that
// approaches a plate; and once more on one that approaches a side of the domain, which lies between cells and
// reflects by itself.
#include <memory>

#include "coupler/case/fluid_spec.hpp"
#include "rigid/bodies/lubrication.hpp"

namespace silt::coupler {

/// What a wall scheme resolves; cells.
struct ResolvedFlow {
  double base, width, cells;     // of the squeeze flow: G, 1/cells
  double slip_gap, rolling_gap;  // gaps at which it resolves these motions
};
/// Of gaps between bodies, and of a body and a side of the domain.
struct ResolvedFlows {
  ResolvedFlow bodies, side;
};
/// `share` of multireflection, the rest is `cli` (lbm/README.md, equation 20); without effect on other
/// schemes.
ResolvedFlows resolved_flows(WallScheme, double share = 1);

class Lubrication final : public rigid::LubricationLaw {
 public:
  /// least_gap: below it the film resists no more, in cells; 0: relative_least_gap of the reduced radius.
  Lubrication(double viscosity, const ResolvedFlows&, double least_gap);
  /// Where the lattice resolves the squeeze flow even with no cell in the gap.
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
