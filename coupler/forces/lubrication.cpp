#include "coupler/forces/lubrication.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coupler/forces/gap_cells.hpp"
#include "lbm/collision/collision_model.hpp"
#include "lbm/walls/wall_scheme.hpp"
#include "rigid/math/elementary.hpp"

namespace silt::coupler {

namespace {

constexpr double negligible_travel = 1e-6;  // relative to the gap

/// Returns the integral over h, from h = least, of the positive part of 1 / max(h, least) - 1 / cutoff.
double squeeze_integral(double h, double least, double cutoff) {
  if (least >= cutoff) return 0;
  if (h <= least) return (h - least) * (1 / least - 1 / cutoff);
  const double end = std::min(h, cutoff);
  return rigid::elementary::log(end / least) - (end - least) / cutoff;
}

/// Returns the mean of 1 / h - 1 / cutoff over a change of the gap from this width, which may be large.
double mean_squeeze(double width, double travel, double least, double cutoff) {
  if (std::abs(travel) <= negligible_travel * std::max(width, least))
    return std::max(0.0, 1 / std::max(width, least) - 1 / cutoff);
  const double end = std::max(width + travel, 0.0), begin = std::max(width, 0.0);
  if (end == begin) return 1 / least - 1 / cutoff;
  return (squeeze_integral(end, least, cutoff) - squeeze_integral(begin, least, cutoff)) / (end - begin);
}

double log_excess(double width, double cutoff) {
  return width < cutoff ? rigid::elementary::log(cutoff / width) : 0;
}

ResolvedFlow mean(double share, const ResolvedFlow& a, const ResolvedFlow& b) {
  const auto of = [&](double ResolvedFlow::*x) { return share * a.*x + (1 - share) * b.*x; };
  return {of(&ResolvedFlow::base), of(&ResolvedFlow::width), of(&ResolvedFlow::cells),
          of(&ResolvedFlow::slip_gap), of(&ResolvedFlow::rolling_gap)};
}

}  // namespace

ResolvedFlows resolved_flows(WallScheme scheme, double share) {
  if (scheme == WallScheme::parabolic)
    return {{0.618, 0.642, 3.564, 0.482, 0.282}, {0.340, 1.849, 3.825, 0.482, 0.282}};
  if (scheme == WallScheme::multireflection) {
    const ResolvedFlows whole{{0.591, 0.664, 2.947, 0.484, 0.312}, {0.391, 1.387, 2.980, 0.484, 0.312}},
        rest = resolved_flows(WallScheme::cli);
    return {mean(share, whole.bodies, rest.bodies), mean(share, whole.side, rest.side)};
  }
  if (lbm::follows_distance(scheme))  // `cli`, and schemes without a calibration
    return {{0.764, 0.550, 2.652, 0.472, 0.286}, {0.489, 1.298, 2.538, 0.472, 0.286}};
  return {{1.159, 0.167, 1.331, 0.402, 0.264}, {0.692, 1.299, 1.424, 0.402, 0.264}};
}

namespace {

/// Returns the gap at which the lattice resolves everything even without a cell in it: 1 = (b + w h) h.
double reach_of(const ResolvedFlow& resolved) {
  const double b = resolved.base, w = resolved.width;
  const double squeeze = w == 0 ? 1 / b : (std::sqrt(b * b + 4 * w) - b) / (2 * w);
  return std::max({squeeze, resolved.slip_gap, resolved.rolling_gap});
}

}  // namespace

Lubrication::Lubrication(double viscosity, const ResolvedFlows& resolved, double least_gap)
    : viscosity_(viscosity),
      resolved_(resolved),
      least_gap_(least_gap),
      reach_(std::max(reach_of(resolved.bodies), reach_of(resolved.side))) {}

rigid::LubricationResistance Lubrication::operator()(const rigid::LubricatedGap& gap) const {
  const double radius = 1 / std::sqrt(gap.curvature_product());
  const double least = std::min(least_gap_ > 0 ? least_gap_ : relative_least_gap * radius, reach_);
  const double width = std::max(gap.width, least), drag = std::numbers::pi * viscosity_ * radius;
  const ResolvedFlow& of = gap.at_side ? resolved_.side : resolved_.bodies;
  const double resolved = of.base + of.width * width + of.cells * std::sqrt(cells_in_gap(gap));
  const auto squeeze = [&](double from, double travel) {
    return 12 * drag / gap.curvature_sum() * mean_squeeze(from, travel, least, 1 / resolved);
  };
  const bool meets = gap.width + gap.travel < 0;
  return {squeeze(gap.width, gap.travel), 2 * drag * log_excess(width, of.slip_gap),
          1.2 * drag * log_excess(width, of.rolling_gap), meets ? squeeze(0, gap.width - gap.travel) : 0};
}

std::shared_ptr<const rigid::LubricationLaw> make_lubrication(const FluidSpec& fluid,
                                                              const CouplingSpec& coupling) {
  const lbm::CollisionSpec collision{fluid.relaxation_time, fluid.magic, fluid.collision, {}};
  const double share = lbm::stable_share(collision);
  return std::make_shared<Lubrication>(fluid.kinematic_viscosity, resolved_flows(coupling.wall_scheme, share),
                                       coupling.lubrication_min_gap);
}

}  // namespace silt::coupler
