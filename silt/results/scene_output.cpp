#include "adapters/hdf5/scene_file.hpp"
#include "silt/case/case.hpp"
#include "silt/results/body_output.hpp"

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
  setup.for_each_given([&](const BodySpec& body, std::uint64_t) {
    if (body.motion != rigid::Motion::free) driven[body.kind] = true;
  });
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

}  // namespace silt
