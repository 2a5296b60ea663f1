#include "silt/results/body_output.hpp"

#include <limits>

#include "parallel/together.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/results/tessellation.hpp"

namespace silt {

namespace {

using rigid::Vec3;

std::array<double, 3> scaled(const Vec3& v, double scale) {
  return {scale * v[0], scale * v[1], scale * v[2]};
}

adapters::BodySeriesInfo series_info(const Simulation& simulation) {
  const Case& setup = simulation.setup();
  adapters::BodySeriesInfo info;
  info.columns = {setup.fluid && !setup.gravity.isZero(0), setup.output.body_contacts, setup.has_sizes(),
                  !setup.springs.empty()};
  for (int d = 0; d < 3; ++d) info.domain_upper[d] = setup.cells[d] * setup.units.cell_size;
  info.length = setup.units.unit_text(dimension::length);
  info.time = setup.units.unit_text(dimension::time);
  if (setup.units.si) info.mass = setup.units.unit_text(dimension::mass);
  info.kinds = drawn_kinds(setup);
  return info;
}

adapters::Wrench scaled(const coupler::BodyLoad& load, const Units& units) {
  return {scaled(load.force, units.scale(dimension::force)),
          scaled(load.torque, units.scale(dimension::torque))};
}

/// The loads of the last step, by row.
struct Loads {
  std::vector<coupler::BodyLoad> fluid, contacts, springs;
};

adapters::BodyRow body_row(const Simulation& simulation, std::size_t row, const Loads& loads,
                           const Vec3& gravity) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const rigid::BodySet& bodies = simulation.bodies();
  const Case& setup = simulation.setup();
  const Units& units = setup.units;
  const std::vector<double>& radii = simulation.scene().world.bounding_radii;
  const rigid::Quat& q = bodies.orientation[row];
  adapters::BodyRow r;
  r.id = bodies.id[row];
  r.kind = bodies.kind[row];
  r.image = bodies.image[row];
  r.position = scaled(bodies.position[row], units.scale(dimension::length));
  r.orientation = {q.w(), q.x(), q.y(), q.z()};
  r.velocity = scaled(bodies.velocity[row], units.scale(dimension::velocity));
  r.angular_velocity = scaled(bodies.angular_velocity[row], units.scale(dimension::angular_velocity));
  r.buoyancy = scaled(-bodies.displaced_mass(row) * gravity, units.scale(dimension::force));
  r.load = scaled(loads.fluid[row], units);
  r.contacts = {{nan, nan, nan}, {nan, nan, nan}};  // of a body that is not free this rank does not know it
  if (bodies.is_dynamic(row)) r.contacts = scaled(loads.contacts[row], units);
  r.springs = scaled(loads.springs[row], units);
  r.mass = units.scale(dimension::mass) * bodies.mass[row];
  r.scale = radii[bodies.shape[row]] / radii[setup.kind_shapes[r.kind]];
  return r;
}

}  // namespace

std::vector<adapters::BodyKind> drawn_kinds(const Case& setup) {
  const double cell = setup.units.cell_size;
  std::vector<adapters::BodyKind> kinds(setup.kind_names.size());
  const auto describe = [&](int kind, double density) {
    adapters::BodyKind& k = kinds[kind];
    if (!k.parts.empty()) return;  // entries of a kind have one shape
    const rigid::Shape& shape = setup.shapes[setup.kind_shapes[kind]];
    k.name = setup.kind_names[kind];
    k.bounding_radius = cell * rigid::bounding_radius(shape);
    k.density = setup.units.physical(density, dimension::density);
    for (const rigid::Part& part : rigid::convex_parts(shape)) k.parts.push_back(tessellation(part, cell));
    if (const auto* mesh = std::get_if<rigid::Mesh>(&shape))
      k.parts.push_back(tessellation(*mesh->surface, cell));
  };
  setup.for_each_given([&](const BodySpec& body, std::uint64_t) { describe(body.kind, body.density); });
  for (const FillSpec& fill : setup.fills) describe(fill.kind, fill.density);
  return kinds;
}

BodyOutput::BodyOutput(const Simulation& simulation, const std::filesystem::path& folder,
                       const adapters::Provenance& provenance, bool resumed)
    : path_(folder / "bodies.h5"),
      series_(simulation.scene().comm, path_, series_info(simulation), provenance,
              resumed ? std::optional(simulation.steps_done()) : std::nullopt) {}

void BodyOutput::append(const Simulation& simulation) {
  const Loads loads{simulation.last_loads(), simulation.last_contact_loads(), simulation.last_spring_loads()};
  const std::int64_t step = simulation.steps_done();
  const Vec3 gravity = simulation.setup().gravity_at(double(step) - (step > 0 ? 0.5 : -0.5));  // of the step
  parallel::with_file_name(path_.string(), [&] {
    series_.append(step, double(step) * simulation.setup().units.time_step, simulation.bodies().owned,
                   [&](std::size_t row) { return body_row(simulation, row, loads, gravity); });
  });
}

}  // namespace silt
