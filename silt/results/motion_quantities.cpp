// Quantities of the bodies' heights, velocities and angular velocities, a component along an axis each: mean,
// standard deviation, least and largest over the bodies. Sums are exact, so the mean of equal numbers is that
// number and their deviation 0 or of the size of rounding.
#include <algorithm>
#include <cmath>

#include "silt/results/quantity_computation.hpp"

namespace silt {

namespace {

using rigid::BodySet;
using rigid::ExactSum;
using rigid::Vec3;
using Vectors = std::vector<Vec3> rigid::BodyMotions::*;

/// Adds the three components, their squares, and 1 a body.
template <Vectors vectors>
void add_moments(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> sums) {
  const BodySet& bodies = simulation.bodies();
  for_bodies_of(bodies, q, [&](std::size_t row) {
    const Vec3& x = (bodies.*vectors)[row];
    for (int d = 0; d < 3; ++d) sums[d].add(x[d]), sums[3 + d].add(x[d] * x[d]);
    sums[6].add(1);
  });
}

/// The three components and their opposites.
template <Vectors vectors>
void see_extremes(const Simulation& simulation, const QuantitySpec& q, std::span<double> largest) {
  const BodySet& bodies = simulation.bodies();
  for_bodies_of(bodies, q, [&](std::size_t row) {
    const Vec3& x = (bodies.*vectors)[row];
    for (int d = 0; d < 3; ++d) {
      largest[d] = std::max(largest[d], x[d]);
      largest[3 + d] = std::max(largest[3 + d], -x[d]);
    }
  });
}

double mean(const Case&, const QuantitySpec& q, std::int64_t, std::span<const double> sums) {
  return sums[6] == 0 ? no_value : sums[q.axis] / sums[6];
}

double deviation(const Case&, const QuantitySpec& q, std::int64_t, std::span<const double> sums) {
  const double mean = sums[q.axis] / sums[6];
  return sums[6] == 0 ? no_value : std::sqrt(std::max(0., sums[3 + q.axis] / sums[6] - mean * mean));
}

double largest(const Case&, const QuantitySpec& q, std::int64_t, std::span<const double> found) {
  return found[q.axis] == not_yet ? no_value : found[q.axis];
}

double least(const Case&, const QuantitySpec& q, std::int64_t, std::span<const double> found) {
  return found[3 + q.axis] == not_yet ? no_value : -found[3 + q.axis];
}

template <Vectors vectors>
constexpr Computation of_sums(std::string_view type, decltype(StepValue::of) of) {
  return in_step(type, {7, add_moments<vectors>}, {of, true});
}
template <Vectors vectors>
constexpr Computation of_extremes(std::string_view type, decltype(StepValue::of) of) {
  return in_step(type, {}, {of, true, 6, see_extremes<vectors>});
}

constexpr auto heights = &BodySet::position, velocities = &BodySet::velocity,
               angular_velocities = &BodySet::angular_velocity;

constexpr Computation of_motions[] = {
    of_sums<heights>("mean-height", mean),
    of_sums<heights>("height-deviation", deviation),
    of_extremes<heights>("least-height", least),
    of_extremes<heights>("largest-height", largest),
    of_sums<velocities>("mean-velocity", mean),
    of_sums<velocities>("velocity-deviation", deviation),
    of_extremes<velocities>("least-velocity", least),
    of_extremes<velocities>("largest-velocity", largest),
    of_sums<angular_velocities>("mean-angular-velocity", mean),
    of_sums<angular_velocities>("angular-velocity-deviation", deviation),
    of_extremes<angular_velocities>("least-angular-velocity", least),
    of_extremes<angular_velocities>("largest-angular-velocity", largest),
};

}  // namespace

std::span<const Computation> motion_computations() {
  return of_motions;
}

}  // namespace silt
