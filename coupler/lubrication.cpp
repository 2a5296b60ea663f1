#include "coupler/lubrication.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::coupler {

namespace {

using rigid::Vec3;

constexpr double negligible_travel = 1e-6;  // of the gap
constexpr double widest = 1;                // cells: of a gap that its cells do not resolve
constexpr double furthest = 8;              // cells from the middle, where a surface hardly bends

/// Integral over h of the positive part of 1 / max(h, least) - 1 / cutoff, from h = least.
double squeeze_integral(double h, double least, double cutoff) {
  if (least >= cutoff) return 0;
  if (h <= least) return (h - least) * (1 / least - 1 / cutoff);
  const double end = std::min(h, cutoff);
  return std::log(end / least) - (end - least) / cutoff;
}

/// Mean of 1 / h - 1 / cutoff over the way that the gap is about to go: a step may take it far.
double mean_squeeze(const rigid::FilmGap& gap, double least, double cutoff) {
  if (std::abs(gap.travel) <= negligible_travel * std::max(gap.width, least))
    return std::max(0.0, 1 / std::max(gap.width, least) - 1 / cutoff);
  const double end = std::max(gap.width + gap.travel, 0.0), begin = std::max(gap.width, 0.0);
  if (end == begin) return 1 / least - 1 / cutoff;
  return (squeeze_integral(end, least, cutoff) - squeeze_integral(begin, least, cutoff)) / (end - begin);
}

double log_excess(double width, double cutoff) {
  return std::max(0.0, std::log(cutoff / width));
}

/// Cells of a column of the lattice, along the axis nearest to the normal, that lie in the gap: sum of their
/// (1 - H)^2. from: the column's point in the plane of the gap's middle across that axis, from the middle.
double column(const rigid::FilmGap& gap, Vec3 from, int axis) {
  const double slope = gap.normal[axis], height = gap.normal.dot(from);
  const double ends[2] = {(-widest - height) / slope, (widest - height) / slope};
  const double shift = gap.middle[axis] - 0.5;  // a cell's centre is a whole number from it
  const double last = std::floor(std::max(ends[0], ends[1]) + shift);
  double sum = 0;
  for (double cell = std::ceil(std::min(ends[0], ends[1]) + shift); cell <= last; cell += 1) {
    const double x = cell - shift;
    from[axis] = x;
    const double z = height + slope * x;
    const double below = 0.5 * (gap.width + from.dot(gap.bend_a * from));
    const double above = 0.5 * (gap.width + from.dot(gap.bend_b * from));
    if (z <= -below || z >= above || below + above >= widest) continue;
    sum += (1 - below - above) * (1 - below - above);
  }
  return sum;
}

}  // namespace

double cells_in_gap(const rigid::FilmGap& gap) {
  if (gap.width >= widest) return 0;
  const double k = gap.curvature_sum(), product = gap.curvature_product();
  const double least_bend = 0.5 * (k - std::sqrt(std::max(0.0, k * k - 4 * product)));
  const double far = std::min(std::sqrt(2 * (widest - gap.width) / least_bend), furthest) + widest;
  int axis = 0;
  gap.normal.cwiseAbs().maxCoeff(&axis);
  const int e = (axis + 1) % 3, f = (axis + 2) % 3;
  const auto first = [&](int d) { return std::ceil(gap.middle[d] - 0.5 - far) + 0.5 - gap.middle[d]; };
  double sum = 0;
  for (double y = first(e); y <= far; y += 1)
    for (double z = first(f); z <= far; z += 1) {
      Vec3 from = Vec3::Zero();
      from[e] = y, from[f] = z;
      sum += column(gap, from, axis);
    }
  return sum * std::sqrt(product) / (2 * std::numbers::pi);
}

ResolvedFlows resolved_flows(WallScheme scheme) {
  if (scheme == WallScheme::parabolic)
    return {{0.370, 0.838, 3.405, 0.503, 0.328}, {0, 2.121, 4.465, 0.503, 0.328}};
  if (scheme == WallScheme::cli)
    return {{0.510, 0.739, 2.688, 0.487, 0.329}, {0.560, 1.383, 1.658, 0.487, 0.329}};
  return {{1.063, 0.286, 1.491, 0.401, 0.264}, {0.612, 1.389, 1.592, 0.401, 0.264}};
}

namespace {

/// The gap at which even without a cell in it the lattice resolves all: 1 = (b + w h) h.
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

rigid::Film Lubrication::operator()(const rigid::FilmGap& gap) const {
  const double radius = 1 / std::sqrt(gap.curvature_product());
  const double least = std::min(least_gap_ > 0 ? least_gap_ : relative_least_gap * radius, reach_);
  const double width = std::max(gap.width, least), drag = std::numbers::pi * viscosity_ * radius;
  const ResolvedFlow& of = gap.at_side ? resolved_.side : resolved_.bodies;
  const double resolved = of.base + of.width * width + of.cells * std::sqrt(cells_in_gap(gap));
  return {12 * drag / gap.curvature_sum() * mean_squeeze(gap, least, 1 / resolved),
          2 * drag * log_excess(width, of.slip_gap), 1.2 * drag * log_excess(width, of.rolling_gap)};
}

std::shared_ptr<const rigid::FilmLaw> make_lubrication(const Case& scene) {
  if (!scene.has_lubrication()) return nullptr;
  return std::make_shared<Lubrication>(scene.fluid->kinematic_viscosity,
                                       resolved_flows(scene.coupling.wall_scheme),
                                       scene.coupling.lubrication_min_gap);
}

}  // namespace silt::coupler
