// Mean, standard deviation, minimum and maximum over bodies of a component of position, velocity or angular
// velocity. Sums are exact: the mean of equal numbers is that number, their deviation 0 up to rounding.
#include <algorithm>
#include <cmath>

#include "silt/results/quantity_computation.hpp"

namespace silt {

namespace {

using rigid::BodySet;
using rigid::Vec3;
using Vectors = std::vector<Vec3> rigid::BodyMotions::*;

/// Returns three components, their squares, and 1 for the count.
template <Vectors vectors>
std::array<double, 7> moments(const Simulation& simulation, const QuantitySpec&, std::size_t row) {
  const Vec3& x = (simulation.bodies().*vectors)[row];
  return {x[0], x[1], x[2], x[0] * x[0], x[1] * x[1], x[2] * x[2], 1};
}

/// Notes the three components and their negatives.
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
constexpr Computation of_sums(decltype(StepValue::of) of) {
  return in_step({7, add_over_bodies<moments<vectors>>}, {of, true});
}
template <Vectors vectors>
constexpr Computation of_extremes(decltype(StepValue::of) of) {
  return in_step({}, {of, true, 6, see_extremes<vectors>});
}

constexpr auto heights = &BodySet::position, velocities = &BodySet::velocity,
               angular_velocities = &BodySet::angular_velocity;

constexpr Quantity of_motions[] = {
    {"mean-height", dimension::length, Q::body | Q::axis, Q::bodies, of_sums<heights>(mean),
     "mean coordinate of the bodies' centres along the axis, at the end"},
    {"height-deviation", dimension::length, Q::body | Q::axis, Q::bodies, of_sums<heights>(deviation),
     "standard deviation of that coordinate over the bodies, at the end"},
    {"least-height", dimension::length, Q::body | Q::axis, Q::bodies, of_extremes<heights>(least),
     "least of these coordinates, at the end"},
    {"largest-height", dimension::length, Q::body | Q::axis, Q::bodies, of_extremes<heights>(largest),
     "largest of these coordinates, at the end"},
    {"mean-velocity", dimension::velocity, Q::body | Q::axis, Q::bodies, of_sums<velocities>(mean),
     "mean velocity of the bodies along the axis, at the end"},
    {"velocity-deviation", dimension::velocity, Q::body | Q::axis, Q::bodies, of_sums<velocities>(deviation),
     "standard deviation of that velocity over the bodies, at the end"},
    {"least-velocity", dimension::velocity, Q::body | Q::axis, Q::bodies, of_extremes<velocities>(least),
     "least of these velocities, at the end"},
    {"largest-velocity", dimension::velocity, Q::body | Q::axis, Q::bodies, of_extremes<velocities>(largest),
     "largest of these velocities, at the end"},
    {"mean-angular-velocity", dimension::angular_velocity, Q::body | Q::axis, Q::bodies,
     of_sums<angular_velocities>(mean), "mean angular velocity of the bodies about the axis, at the end"},
    {"angular-velocity-deviation", dimension::angular_velocity, Q::body | Q::axis, Q::bodies,
     of_sums<angular_velocities>(deviation),
     "standard deviation of that angular velocity over the bodies, at the end"},
    {"least-angular-velocity", dimension::angular_velocity, Q::body | Q::axis, Q::bodies,
     of_extremes<angular_velocities>(least), "least of these angular velocities, at the end"},
    {"largest-angular-velocity", dimension::angular_velocity, Q::body | Q::axis, Q::bodies,
     of_extremes<angular_velocities>(largest), "largest of these angular velocities, at the end"},
};

}  // namespace

constinit const std::span<const Quantity> motion_quantities = of_motions;

}  // namespace silt
