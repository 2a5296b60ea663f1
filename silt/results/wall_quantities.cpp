// Forces of fluid and bodies on walls: means over steps, and loads on walls and bodies in a step. The parts
// of the stress of a suspension, averaged over a box: of the fluid, and by bodies through their presence and
// through contacts (G. K. Batchelor, J. Fluid Mech. 41 (1970) 545). Tension is positive.
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/contact_loads.hpp"
#include "lbm/walls/cut_links.hpp"
#include "silt/case/case.hpp"
#include "silt/results/quantity_computation.hpp"
#include "silt/results/solid_cells.hpp"
#include "silt/results/velocity_gradient.hpp"

namespace silt {

namespace {

using lbm::Int3;
using rigid::BodySet;
using rigid::ExactSum;
using rigid::Vec3;

bool is_in(const QuantitySpec& q, const Vec3& x) {
  return (x.array() >= q.box.lower.array()).all() && (x.array() < q.box.upper.array()).all();
}

/// Cells are weighted by their part in the box.
void add_viscous_stress(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> stress) {
  const double twice_viscosity = 2 * simulation.setup().fluid->kinematic_viscosity;
  simulation.scene().flow->for_levels([&](const coupler::FluidFields& fields) {
    for_each_fluid_cell(fields, fields.cells_meeting(q.box), [&](Int3 cell, const lbm::Moments& m) {
      const double share = twice_viscosity * fields.volume_in(q.box, cell);
      stress[0].add(share * strain_rate(fields, m)[q.component]);
    });
  });
}

/// Adds the force of the links of each body (method.md, equations 22 and 33) times the vector from its centre
/// to the cut, taken half-way between cells.
void add_particle_stress(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> stress) {
  const coupler::FluidFields& fields = simulation.scene().flow->fields();
  const rigid::BodySet& bodies = simulation.bodies();
  const SolidCells solid(simulation, fields);
  const bool galilean = simulation.setup().coupling.force == coupler::ForceForm::galilean;
  for (int b = 0; b < fields.blocks(); ++b) {
    const Int3 size = fields.block(b).size, one{1, 1, 1};
    solid.for_each({b, Int3{} - one, size + one}, [&](std::size_t row, Int3 cell, const Vec3& r) {
      if (!q.is_about(bodies.kind[row]) || !is_in(q, bodies.position[row])) return;
      for (int i = 1; i < lbm::D3Q19::directions; ++i) {
        const Int3 c = lbm::D3Q19::c[i], x = cell - c;
        if (!lbm::CellBox{{}, size}.contains(x) || !fields.is_fluid(b, x)) continue;
        const Vec3 along(c.x, c.y, c.z), arm = r - 0.5 * along;
        const auto [out, back] = fields.link(b, x, i);
        Vec3 force = (out + back) * along;
        if (galilean) force -= (out - back) * bodies.velocity_at(row, arm);
        stress[0].add(coupler::symmetric_product(arm, force)[q.component]);
      }
    });
  }
}

void add_contact_stress(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> stress) {
  for (const coupler::ContactMoment& of : simulation.contact_moments())
    if (q.is_about(of.kind) && is_in(q, of.position)) stress[0].add(of.moment[q.component]);
}

double over_volume(const Case&, const QuantitySpec& q, std::int64_t, std::span<const double> sum) {
  return sum[0] / (q.box.upper - q.box.lower).prod();
}

void add(const Vec3& v, std::span<ExactSum> sums) {
  for (int d = 0; d < 3; ++d) sums[d].add(v[d]);
}

// A load is a force and, with six sums, the torque about the origin of a frame.

/// Adds the loads of this rank's bodies on a wall in the last step, times sign.
void add_contacts(const Simulation& simulation, rigid::BodyId wall, std::span<ExactSum> load, int sign = 1) {
  for (const coupler::ContactLoad& contact : simulation.contact_loads()) {
    if (contact.on != wall) continue;
    add(sign * contact.impulse, load.first(3));
    if (load.size() > 3) add(sign * contact.torque, load.subspan(3));
  }
}

double area_of(const Case& setup, int axis) {
  return 1. * setup.cells[(axis + 1) % 3] * setup.cells[(axis + 2) % 3];
}

/// Adds the force of the fluid on a side of the domain, times sign.
void add_fluid_side_force(const Simulation& simulation, int side, int sign, std::span<ExactSum> force) {
  simulation.scene().flow->for_levels([&](const coupler::FluidFields& fields) {
    const auto fluid = fields.side_force(side / 2, side % 2 != 0);
    for (int d = 0; d < 3; ++d) force[d].add(sign * fluid[d], lbm::link_quantum);
  });
}

/// Adds the force of fluid and bodies on a side, times sign.
void add_side_force(const Simulation& simulation, int side, int sign, std::span<ExactSum> force) {
  add_fluid_side_force(simulation, side, sign, force);
  add_contacts(simulation, rigid::first_wall_id + side, force, sign);
}

/// Adds the load of the fluid on one of [[walls]], whose rows follow those of the sides.
void add_fluid_wall_load(const Simulation& simulation, int wall, std::span<ExactSum> sums) {
  if (!simulation.scene().flow) return;
  const std::size_t sides = simulation.bodies().walls - simulation.setup().walls.size();
  const auto load = simulation.scene().flow->account().wall_load(sides + wall);
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k].add(load[k], lbm::link_quantum);
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

/// Adds the force on the lower side across the axis less that on the upper side.
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

/// Adds the load of fluid and bodies on a wall.
void add_wall_load(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> load) {
  add_fluid_wall_load(simulation, q.wall, load);
  add_contacts(simulation, rigid::first_tube_id + q.wall, load);
}

/// Returns the torque about the point of the axis: that about the frame's origin plus r x F.
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

/// Returns the power with the wall's velocities of the step.
double wall_power(const Case& setup, const QuantitySpec& q, std::int64_t step, std::span<const double> load) {
  const rigid::PrescribedMotion::Velocity velocity = setup.walls[q.wall].velocity_at(double(step - 1));
  return -(vector_of(load.first(3)).dot(velocity.linear) + vector_of(load.subspan(3)).dot(velocity.angular));
}

// ---- loads of fluid or contacts on bodies, a wall or a side in a step ----

/// Adds a load stored in a column of the bodies, of movable bodies only or of all.
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
  if (q.bearer == Bearer::wall) add_fluid_wall_load(simulation, q.wall, load);
}

/// Adds the impulses on bodies that contacts do not move, as stored by their partners.
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
  if (q.bearer == Bearer::wall) return add_contacts(simulation, rigid::first_tube_id + q.wall, load);
  add_contacts(simulation, rigid::first_wall_id + q.side, load.first(3));
}

double force_of(const Case&, const QuantitySpec& q, std::int64_t, std::span<const double> load) {
  return load[q.axis];
}

double torque_of(const Case& setup, const QuantitySpec& q, std::int64_t step, std::span<const double> load) {
  return q.bearer == Bearer::wall ? torque_about_point(setup.walls[q.wall], step, load)[q.axis]
                                  : load[3 + q.axis];
}

constexpr Quantity of_walls[] = {
    {"axis-distance", dimension::length, Q::body | Q::wall, Q::bodies, at_end<axis_distance>(),
     "mean distance of the bodies' centres from the axis of a tube, at the end"},
    {"wall-stress", dimension::pressure, Q::side | Q::axis, Q::fluid,
     mean_of<wall_stress>({3, add_wall_stress, has_acted}),
     "force of fluid and bodies along the axis on a side of the domain, per area, mean from a time on"},
    {"relative-viscosity", dimension::none, Q::axis, Q::fluid | Q::sheared,
     mean_of<relative_viscosity>({3, add_shear_resistance, has_acted}),
     "shear stress on the two walls across the axis over that of the fluid alone at the same velocities, "
     "mean from a time on"},
    {"wall-force", dimension::force, Q::wall | Q::axis, 0, mean_of<force_of>({3, add_wall_load, has_acted}),
     "force of fluid and bodies along the axis on a tube or mesh, mean from a time on"},
    {"wall-torque", dimension::torque, Q::wall, 0, mean_of<wall_torque>({6, add_wall_load, has_acted}),
     "torque of fluid and bodies on a tube or mesh about its axis, mean from a time on"},
    {"wall-power", Dimension{2, -3, 1}, Q::wall, 0, mean_of<wall_power>({6, add_wall_load, has_acted}),
     "power that keeps a tube or mesh moving against fluid and bodies, mean from a time on"},
    {"fluid-force", dimension::force, Q::bearer | Q::side_bears | Q::axis, Q::fluid,
     in_step({6, add_fluid_load, has_acted}, {force_of, true}),
     "force of the fluid along the axis on bodies, a wall or a side of the domain in the last step; without "
     "hydrostatic pressure"},
    {"fluid-torque", dimension::torque, Q::bearer | Q::axis, Q::fluid,
     in_step({6, add_fluid_load, has_acted}, {torque_of, true}),
     "torque of the fluid about the axis: on bodies about their centres of mass, on a wall about its point; "
     "in the last step"},
    {"contact-force", dimension::force, Q::bearer | Q::side_bears | Q::axis, Q::bodies,
     in_step({6, add_contact_load, has_acted}, {force_of, true}),
     "force of contacts and films along the axis on bodies, a wall or a side of the domain in the last step"},
    {"contact-torque", dimension::torque, Q::bearer | Q::axis, Q::bodies,
     in_step({6, add_contact_load, has_acted}, {torque_of, true}),
     "torque of contacts about the axis: on bodies about their centres of mass, on a wall about its point; "
     "in the last step"},
    {"viscous-stress", dimension::pressure, Q::box | Q::component, Q::fluid,
     in_step({1, add_viscous_stress}, {over_volume}),
     "2 ρ ν S of the fluid in the box, over the volume of the box, at the end; a cell counts by its part in "
     "the box"},
    {"particle-stress", dimension::pressure, Q::body | Q::box | Q::component, Q::fluid | Q::bodies,
     in_step({1, add_particle_stress, has_acted}, {over_volume}),
     "what bodies with their centres in the box add to it: force of the fluid on their surfaces times the "
     "way to it from their centres, the symmetric part, at the end"},
    {"contact-stress", dimension::pressure, Q::body | Q::box | Q::component, Q::bodies,
     in_step({1, add_contact_stress, has_acted}, {over_volume}),
     "the same of contacts and films; pull is positive"},
};

}  // namespace

constinit const std::span<const Quantity> wall_quantities = of_walls;

}  // namespace silt
