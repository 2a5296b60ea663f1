// Quantities that look at what fluid and bodies do to the walls, means over the steps from a time on, and at
// what fluid and contacts do to walls and bodies in a step.
#include "coupler/exchange/coupling_state.hpp"
#include "lbm/walls/cut_links.hpp"
#include "silt/case/case.hpp"
#include "silt/results/quantity_computation.hpp"

namespace silt {

namespace {

using rigid::BodySet;
using rigid::ExactSum;
using rigid::Vec3;

void add(const Vec3& v, std::span<ExactSum> sums) {
  for (int d = 0; d < 3; ++d) sums[d].add(v[d]);
}

/// Adds the force, or the torque, of what this rank's bodies did to a wall in the last step.
void add_contacts(const Simulation& simulation, rigid::BodyId wall, rigid::Vec3 coupler::ContactLoad::*of,
                  std::span<ExactSum> sums, int sign = 1) {
  for (const coupler::ContactLoad& contact : simulation.contact_loads())
    if (contact.on == wall) add(sign * contact.*of, sums);
}

double area_of(const Case& setup, int axis) {
  return 1. * setup.cells[(axis + 1) % 3] * setup.cells[(axis + 2) % 3];
}

/// Adds the force of the fluid on a side of the domain, +1 or -1 times.
void add_fluid_side_force(const Simulation& simulation, int side, int sign, std::span<ExactSum> force) {
  simulation.scene().flow->for_levels([&](const coupler::FluidFields& fields) {
    const auto fluid = fields.side_force(side / 2, side % 2 != 0);
    for (int d = 0; d < 3; ++d) force[d].add(sign * fluid[d], lbm::link_quantum);
  });
}

/// Adds the force of fluid and bodies on it.
void add_side_force(const Simulation& simulation, int side, int sign, std::span<ExactSum> force) {
  add_fluid_side_force(simulation, side, sign, force);
  add_contacts(simulation, rigid::first_wall_id + side, &coupler::ContactLoad::impulse, force, sign);
}

/// Adds what the fluid does to one of [[walls]], whose rows come after those of the sides: its force, or its
/// torque about the origin of the wall's frame.
void add_fluid_wall_load(const Simulation& simulation, int wall, bool torque, std::span<ExactSum> sums) {
  if (!simulation.scene().flow) return;
  const std::size_t sides = simulation.bodies().walls - simulation.setup().walls.size();
  const auto load = simulation.scene().flow->account().wall_load(sides + wall);
  for (int d = 0; d < 3; ++d) sums[d].add(load[3 * torque + d], lbm::link_quantum);
}

Vec3 vector_of(std::span<const double> sums) {
  return {sums[0], sums[1], sums[2]};
}

double axis_distance(const Simulation& simulation, const QuantitySpec& q) {
  const BodySet& bodies = simulation.bodies();
  const CurvedWall& wall = simulation.setup().walls[q.wall];
  const Vec3 point = wall.point_of_axis(), along = wall.axis();
  return mean_over_bodies(simulation, q, [&](std::size_t row) {
    const Vec3 from = bodies.position[row] - point;
    return (from - along.dot(from) * along).norm();
  });
}

void add_wall_stress(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> force) {
  add_side_force(simulation, q.side, 1, force);
}

double wall_stress(const Case& setup, const QuantitySpec& q, std::span<const double> force) {
  return force[q.axis] / area_of(setup, q.side / 2);
}

/// Adds the force on the lower side across the axis less that on the upper one.
void add_shear_resistance(const Simulation& simulation, const QuantitySpec& q,
                          std::span<ExactSum> resistance) {
  add_side_force(simulation, 2 * q.axis, 1, resistance);
  add_side_force(simulation, 2 * q.axis + 1, -1, resistance);
}

double relative_viscosity(const Case& setup, const QuantitySpec& q, std::int64_t step,
                          std::span<const double> resistance) {
  const auto velocity = [&](int side) { return setup.boundary[side].velocity_at(double(step) - 0.5); };
  const Vec3 shear = (velocity(2 * q.axis + 1) - velocity(2 * q.axis)) / setup.cells[q.axis];
  const double stress = 0.5 * vector_of(resistance).dot(shear) / area_of(setup, q.axis);
  return stress / (setup.fluid->kinematic_viscosity * shear.squaredNorm());
}

void add_wall_force(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> force) {
  add_fluid_wall_load(simulation, q.wall, false, force);
  add_contacts(simulation, rigid::first_tube_id + q.wall, &coupler::ContactLoad::impulse, force);
}

/// Adds the force, and the torque about the origin of the wall's frame.
void add_wall_load(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> load) {
  add_wall_force(simulation, q, load.first(3));
  add_fluid_wall_load(simulation, q.wall, true, load.subspan(3));
  add_contacts(simulation, rigid::first_tube_id + q.wall, &coupler::ContactLoad::torque, load.subspan(3));
}

/// Returns the torque about the point of the axis: that about the frame's origin and r x F.
Vec3 torque_about_point(const CurvedWall& wall, std::int64_t step, std::span<const double> load) {
  Vec3 torque = vector_of(load.subspan(3));
  if (const MeshWall* mesh = wall.mesh()) {
    const rigid::Quat turned = mesh->motion.pose(mesh->start, double(step - 1)).orientation;
    torque += (turned * mesh->arm).cross(vector_of(load.first(3)));
  }
  return torque;
}

double wall_torque(const Case& setup, const QuantitySpec& q, std::int64_t step,
                   std::span<const double> load) {
  const CurvedWall& wall = setup.walls[q.wall];
  return torque_about_point(wall, step, load).dot(wall.axis());
}

/// Takes the velocities that the wall had in the step.
double wall_power(const Case& setup, const QuantitySpec& q, std::int64_t step, std::span<const double> load) {
  const rigid::PrescribedMotion::Velocity velocity = setup.walls[q.wall].velocity_at(double(step - 1));
  return -(vector_of(load.first(3)).dot(velocity.linear) + vector_of(load.subspan(3)).dot(velocity.angular));
}

// ---- what fluid or contacts do to bodies, a wall or a side in a step: force and torque ----

/// Adds what was noted in a column of the bodies that are, or are not, moved by it.
void add_noted_loads(const BodySet& bodies, const QuantitySpec& q, coupler::StoredLoad noted, bool moved_only,
                     std::span<ExactSum> load) {
  for_bodies_of(bodies, q, [&](std::size_t row) {
    if (moved_only && !bodies.is_dynamic(row)) return;
    const auto& on_body = (coupler::coupling_of(bodies, row).*noted).numbers;
    for (int k = 0; k < 6; ++k) load[k].add(on_body[k]);
  });
}

void add_fluid_load(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> load) {
  if (q.bearer == Bearer::side) add_fluid_side_force(simulation, q.side, 1, load.first(3));
  if (q.bearer == Bearer::bodies)
    add_noted_loads(simulation.bodies(), q, &coupler::CouplingState::seen_load, false, load);
  if (q.bearer != Bearer::wall) return;
  add_fluid_wall_load(simulation, q.wall, false, load.first(3));
  add_fluid_wall_load(simulation, q.wall, true, load.subspan(3));
}

/// Adds the impulses on bodies that contacts do not move, as their partners remember them.
void add_contact_load_of_bodies(const Simulation& simulation, const QuantitySpec& q,
                                std::span<ExactSum> load) {
  add_noted_loads(simulation.bodies(), q, &coupler::CouplingState::contact_load, true, load);
  for (const coupler::ContactLoad& contact : simulation.contact_loads()) {
    if (contact.on >= rigid::first_wall_id || !q.is_about(contact.kind)) continue;
    add(contact.impulse, load.first(3));
    add(contact.torque, load.subspan(3));
  }
}

void add_contact_load(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> load) {
  if (q.bearer == Bearer::bodies) return add_contact_load_of_bodies(simulation, q, load);
  const bool is_wall = q.bearer == Bearer::wall;
  const rigid::BodyId on = is_wall ? rigid::first_tube_id + q.wall : rigid::first_wall_id + q.side;
  add_contacts(simulation, on, &coupler::ContactLoad::impulse, load.first(3));
  if (is_wall) add_contacts(simulation, on, &coupler::ContactLoad::torque, load.subspan(3));
}

double force_of(const Case&, const QuantitySpec& q, std::int64_t, std::span<const double> load) {
  return load[q.axis];
}

double torque_of(const Case& setup, const QuantitySpec& q, std::int64_t step, std::span<const double> load) {
  return q.bearer == Bearer::wall ? torque_about_point(setup.walls[q.wall], step, load)[q.axis]
                                  : load[3 + q.axis];
}

constexpr Computation of_walls[] = {
    at_end<axis_distance>("axis-distance"),
    mean_of<wall_stress>("wall-stress", {3, add_wall_stress, has_acted}),
    mean_of<relative_viscosity>("relative-viscosity", {3, add_shear_resistance, has_acted}),
    mean_of<force_of>("wall-force", {3, add_wall_force, has_acted}),
    mean_of<wall_torque>("wall-torque", {6, add_wall_load, has_acted}),
    mean_of<wall_power>("wall-power", {6, add_wall_load, has_acted}),
    in_step("fluid-force", {6, add_fluid_load, has_acted}, {force_of, true}),
    in_step("fluid-torque", {6, add_fluid_load, has_acted}, {torque_of, true}),
    in_step("contact-force", {6, add_contact_load, has_acted}, {force_of, true}),
    in_step("contact-torque", {6, add_contact_load, has_acted}, {torque_of, true}),
};

}  // namespace

std::span<const Computation> wall_computations() {
  return of_walls;
}

}  // namespace silt
