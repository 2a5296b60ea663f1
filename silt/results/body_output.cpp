#include "silt/results/body_output.hpp"

#include <algorithm>
#include <limits>

#include "adapters/hdf5/scene_file.hpp"
#include "parallel/together.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"

namespace silt {
namespace {

using adapters::SceneGroup;
using rigid::Vec3;

/// Converts numbers from lattice units to those of a case.
struct InCaseUnits {
  const Units& units;
  double operator()(double x, Dimension d) const { return units.physical(x, d); }
  std::vector<double> operator()(const Vec3& x, Dimension d) const {
    return {units.physical(x[0], d), units.physical(x[1], d), units.physical(x[2], d)};
  }
};

void add(SceneGroup& group, std::initializer_list<std::pair<std::string, SceneGroup::Value>> attributes) {
  group.attributes.insert(group.attributes.end(), attributes);
}

void add_row(double time, const Vec3& displacement, const Vec3& turn, const InCaseUnits& physical,
             SceneGroup& wall) {
  const std::vector<double> to = physical(displacement, dimension::length);
  wall.table.push_back({physical(time, dimension::time), to[0], to[1], to[2], turn[0], turn[1], turn[2]});
}

void describe(const rigid::TubeWallSpec& tube, const InCaseUnits& physical, SceneGroup& wall) {
  add(wall, {{"type", std::string(rigid::Tube::name)},
             {"position", physical(tube.point, dimension::length)},
             {"axis", physical(tube.axis, dimension::none)},
             {"radius", physical(tube.tube.radius, dimension::length)}});
}

void describe(const MeshWall& mesh, const InCaseUnits& physical, SceneGroup& wall) {
  const rigid::PrescribedMotion& motion = mesh.motion;
  const rigid::Quat& q = mesh.start.orientation;
  add(wall, {{"type", std::string(rigid::Mesh::name)},
             {"position", physical(mesh.start.position, dimension::length)},
             {"solid", std::string(mesh.mesh.hollow ? "outside" : "inside")},
             {"orientation", std::vector{q.w(), q.x(), q.y(), q.z()}},
             {"velocity", physical(motion.velocity, dimension::velocity)},
             {"angular_velocity", physical(motion.angular_velocity, dimension::angular_velocity)},
             {"amplitude", physical(motion.amplitude, dimension::length)},
             {"frequency", physical(motion.frequency, dimension::angular_velocity)}});
  for (const Vec3& x : mesh.mesh.surface->vertices()) {
    const std::vector<double> vertex = physical(Vec3(mesh.arm + x), dimension::length);
    wall.vertices.push_back({vertex[0], vertex[1], vertex[2]});
  }
  const auto triangles = mesh.mesh.surface->triangles();
  wall.triangles.assign(triangles.begin(), triangles.end());
  for (const rigid::MotionRow& row : motion.table)
    add_row(row.time, row.displacement, row.rotation, physical, wall);
}

/// Returns the names of kinds with bodies of prescribed motion, each once.
std::vector<std::string> driven_kinds(const Case& setup) {
  std::vector<bool> driven(setup.kind_names.size(), false);
  const auto look = [&](const BodySpec& body, std::uint64_t = 1) {
    if (body.motion != rigid::Motion::free) driven[body.kind] = true;
  };
  setup.for_each_given(look);
  std::ranges::for_each(setup.continued, look);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < driven.size(); ++k)
    if (driven[k]) names.push_back(setup.kind_names[k]);
  return names;
}

}  // namespace

void write_scene_file(const Case& setup, const std::filesystem::path& folder) {
  const InCaseUnits physical{setup.units};
  std::vector<std::string> sides;
  for (const coupler::BoundarySpec& side : setup.boundary)
    sides.emplace_back(coupler::boundary_names[side.kind]);
  const Vec3 upper(setup.cells[0], setup.cells[1], setup.cells[2]);
  SceneGroup scene;
  add(scene, {{"title", setup.title},
              {"length_unit", setup.units.unit_text(dimension::length)},
              {"time_unit", setup.units.unit_text(dimension::time)},
              {"domain_upper", physical(upper, dimension::length)},
              {"gravity", physical(setup.gravity, dimension::acceleration)},
              {"sides", sides}});
  if (const auto driven = driven_kinds(setup); !driven.empty()) add(scene, {{"driven_kinds", driven}});
  std::vector<SceneGroup> walls;
  for (const CurvedWall& curved : setup.walls) {
    SceneGroup& wall = walls.emplace_back();
    add(wall, {{"name", curved.name}});
    std::visit([&](const auto& surface) { describe(surface, physical, wall); }, curved.surface);
  }
  adapters::write_scene(folder / "scene.h5", scene, walls);
}

namespace {

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
  info.mass = setup.units.unit_text(dimension::mass);
  info.density = setup.units.unit_text(dimension::density);
  info.force = setup.units.unit_text(dimension::force);
  info.torque = setup.units.unit_text(dimension::torque);
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
  for (const BodySpec& body : setup.continued) describe(body.kind, body.density);
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
