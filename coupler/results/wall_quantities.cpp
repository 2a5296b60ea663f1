#include "coupler/results/wall_quantities.hpp"

#include <limits>

#include "coupler/case/case.hpp"
#include "coupler/exchange/reduce.hpp"
#include "coupler/results/body_quantities.hpp"
#include "rigid/collision/tube_contacts.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

using rigid::BodySet;
using rigid::FixedSum;
using rigid::Vec3;

/// One more value for the mean, after a step that counts.
template <class Value>
void add(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& sum, Value&& value) {
  const double now = static_cast<double>(simulation.steps_done());
  if (now < q.time || now == 0) return;
  if (sum[0] == not_yet) sum = {0, 0};
  sum[0] += value();
  sum[1] += 1;
}

/// Returns the load of the bodies that touched a wall in the last step; arm(row, stored impulse) is the
/// vector from the point of reference of the torque to the contact.
template <class Arm>
Load contact_load(const Simulation& simulation, rigid::BodyId wall, Arm&& arm) {
  const BodySet& bodies = simulation.bodies();
  FixedSum sums[6] = {};
  for (std::size_t row = 0; row < bodies.owned; ++row)
    for (const rigid::StoredImpulse& s : bodies.stored_impulses[row]) {
      if (s.partner != wall) continue;
      const Vec3 torque = arm(row, s).cross(s.impulse);
      for (int d = 0; d < 3; ++d) {
        sums[d] += rigid::to_fixed(s.impulse[d]);
        sums[3 + d] += rigid::to_fixed(torque[d]);
      }
    }
  sum_over_ranks(simulation.scene().comm, sums);
  Load load;
  const double steps = simulation.setup().contacts.substeps;
  for (int d = 0; d < 3; ++d) {
    load.force[d] = steps * rigid::from_fixed(sums[d]);
    load.torque[d] = steps * rigid::from_fixed(sums[3 + d]);
  }
  return load;
}

/// Returns the vector from the point of the tube's axis to where a body touches the tube; zero where the body
/// no longer has that feature.
Vec3 arm_in_tube(const Simulation& simulation, const rigid::TubeSpec& tube, std::size_t row,
                 const rigid::StoredImpulse& s) {
  const BodySet& bodies = simulation.bodies();
  const auto parts = rigid::convex_parts(simulation.scene().world.shapes[bodies.shape[row]]);
  const rigid::Part& part = parts[rigid::part_a_of(s.feature)];
  std::vector<rigid::ContactPoint> points;
  rigid::append_tube_contacts(part.shape, bodies.pose(row) * part.pose, {tube.radius}, rigid::pose_of(tube),
                              std::numeric_limits<double>::infinity(), points);
  for (const rigid::ContactPoint& p : points)
    if (p.feature == rigid::feature_of(s.feature)) return p.on_a - tube.point;
  return Vec3::Zero();
}

/// Force on a side of the domain, per area.
Vec3 side_stress(const Simulation& simulation, int side) {
  const auto& n = simulation.setup().cells;
  const int axis = side / 2;
  const double area = 1. * n[(axis + 1) % 3] * n[(axis + 2) % 3];
  const Vec3 fluid = simulation.scene().flow->side_force(axis, side % 2 != 0);
  const Load contacts =
      contact_load(simulation, rigid::first_wall_id + side,
                   [](std::size_t, const rigid::StoredImpulse&) { return Vec3(Vec3::Zero()); });
  return (fluid + contacts.force) / area;
}

/// Returns the load on one of [[walls]], whose rows come after those of the sides; its torque is about its
/// point.
Load load_on(const Simulation& simulation, int wall) {
  const std::size_t sides = simulation.bodies().walls - simulation.setup().walls.size();
  const rigid::TubeSpec& tube = simulation.setup().walls[wall].tube;
  Load load = contact_load(
      simulation, rigid::first_tube_id + wall,
      [&](std::size_t row, const rigid::StoredImpulse& s) { return arm_in_tube(simulation, tube, row, s); });
  if (!simulation.scene().flow) return load;
  const Load fluid = simulation.scene().flow->wall_load(sides + wall);
  load.force += fluid.force;
  load.torque += fluid.torque;
  return load;
}

}  // namespace

double axis_distance(const Simulation& simulation, const QuantitySpec& q) {
  const BodySet& bodies = simulation.bodies();
  const rigid::TubeSpec& tube = simulation.setup().walls[q.wall].tube;
  return mean_over_bodies(simulation, q, [&](std::size_t row) {
    const Vec3 from = bodies.position[row] - tube.point;
    return (from - tube.axis.dot(from) * tube.axis).norm();
  });
}

void observe_wall_stress(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& sum) {
  add(simulation, q, sum, [&] { return side_stress(simulation, q.side)[q.axis]; });
}

void observe_relative_viscosity(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& sum) {
  add(simulation, q, sum, [&] {
    const Case& scene = simulation.setup();
    const int low = 2 * q.axis, high = low + 1;
    const Vec3 shear = (scene.boundary[high].velocity - scene.boundary[low].velocity) / scene.cells[q.axis];
    const Vec3 resistance = side_stress(simulation, low) - side_stress(simulation, high);
    return 0.5 * resistance.dot(shear) / (scene.fluid->kinematic_viscosity * shear.squaredNorm());
  });
}

void observe_wall_force(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& sum) {
  add(simulation, q, sum, [&] { return load_on(simulation, q.wall).force[q.axis]; });
}

void observe_wall_torque(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& sum) {
  add(simulation, q, sum,
      [&] { return load_on(simulation, q.wall).torque.dot(simulation.setup().walls[q.wall].tube.axis); });
}

}  // namespace silt::coupler
