#include "coupler/results/bed_quantities.hpp"

#include <numbers>

#include "coupler/case/case.hpp"
#include "coupler/simulation.hpp"
#include "rigid/math/elementary.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

/// Adds mass(row) times the place from `centre`, from the quantity's time on.
template <class Mass>
bool add_moment_of(const Simulation& simulation, const QuantitySpec& q, Mass&& mass,
                   std::span<rigid::ExactSum> moment) {
  const rigid::BodySet& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (!q.is_about(bodies.kind[row])) continue;
    const Vec3 m = mass(row) * (bodies.position[row] - q.centre);
    for (int d = 0; d < 3; ++d) moment[d].add(m[d]);
  }
  return true;
}

}  // namespace

bool add_moment(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory&,
                std::span<rigid::ExactSum> moment) {
  const rigid::BodySet& bodies = simulation.bodies();
  return add_moment_of(
      simulation, q, [&](std::size_t row) { return bodies.mass[row]; }, moment);
}

/// The angle by which the line from the centre to the bodies' centre of mass is turned from gravity about the
/// axis: that of the surface, where it is flat and the container round.
double bed_angle(const Case& scene, const QuantitySpec& q, std::span<const double> sums) {
  const Vec3 g = scene.gravity, moment(sums[0], sums[1], sums[2]);
  const Vec3 axis = Vec3::Unit(q.axis), across = moment - moment.dot(axis) * axis;
  return rigid::elementary::atan2(axis.dot(g.cross(across)), g.dot(across)) * 180 / std::numbers::pi;
}

bool add_weighing_moment(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory&,
                         std::span<rigid::ExactSum> moment) {
  const rigid::BodySet& bodies = simulation.bodies();
  return add_moment_of(
      simulation, q,
      [&](std::size_t row) {
        return bodies.is_dynamic(row) ? bodies.mass[row] * bodies.weight_in_fluid[row] : 0;
      },
      moment);
}

/// The sum of r x (m g) along the axis.
double weight_torque(const Case& scene, const QuantitySpec& q, std::span<const double> moment) {
  return Vec3(moment[0], moment[1], moment[2]).cross(scene.gravity)[q.axis];
}

}  // namespace silt::coupler
