#include "coupler/results/scene_output.hpp"

#include "adapters/hdf5/scene_file.hpp"
#include "coupler/case/case.hpp"

namespace silt::coupler {

namespace {

using adapters::SceneWall;
using rigid::Vec3;

/// Puts numbers of the lattice into the units of a case.
struct InCaseUnits {
  const Units& units;
  double operator()(double x, Dimension d) const { return units.physical(x, d); }
  SceneWall::Vector operator()(const Vec3& x, Dimension d) const {
    return {units.physical(x[0], d), units.physical(x[1], d), units.physical(x[2], d)};
  }
};

void describe(const rigid::HollowWallSpec& hollow, const InCaseUnits& physical, SceneWall& wall) {
  wall.type = hollow.shape.name();
  wall.position = physical(hollow.point, dimension::length);
  wall.axis = physical(hollow.axis, dimension::none);
  hollow.shape.for_sizes(
      [&](const char* key, double size) { wall.sizes.emplace_back(key, physical(size, dimension::length)); });
}

void describe(const MeshWall& mesh, const InCaseUnits& physical, SceneWall& wall) {
  const rigid::PrescribedMotion& motion = mesh.motion;
  const rigid::Quat& q = mesh.start.orientation;
  wall.type = rigid::Mesh::name;
  wall.hollow = mesh.mesh.hollow;
  wall.position = physical(mesh.start.position, dimension::length);
  wall.orientation = {q.w(), q.x(), q.y(), q.z()};
  const bool steady = !motion.over_time.varies();  // else a table has what comes of these
  wall.velocity = physical(steady * motion.velocity, dimension::velocity);
  wall.angular_velocity = physical(steady * motion.angular_velocity, dimension::angular_velocity);
  wall.amplitude = physical(motion.amplitude, dimension::length);
  wall.frequency = physical(motion.frequency, dimension::angular_velocity);
  wall.phase = motion.phase;
  for (const Vec3& x : mesh.mesh.surface->vertices())
    wall.vertices.push_back(physical(Vec3(mesh.arm + x), dimension::length));
  const auto triangles = mesh.mesh.surface->triangles();
  wall.triangles.assign(triangles.begin(), triangles.end());
  for (const rigid::MotionRow& row : motion.table) {
    const SceneWall::Vector to = physical(row.displacement, dimension::length);
    const Vec3& turn = row.rotation;
    wall.table.push_back(
        {physical(row.time, dimension::time), to[0], to[1], to[2], turn[0], turn[1], turn[2]});
  }
}

/// Adds a motion that changes over time, as a table.
void add_table(const rigid::PrescribedMotion& motion, double steps, const InCaseUnits& physical,
               SceneWall& wall) {
  constexpr int rows = 1000;
  for (int k = 0; k <= rows; ++k) {
    const double time = steps * k / rows, so_far = motion.over_time.integral(time);
    const SceneWall::Vector to = physical(Vec3(motion.velocity * so_far), dimension::length);
    const Vec3 turn = motion.angular_velocity * so_far;
    wall.table.push_back({physical(time, dimension::time), to[0], to[1], to[2], turn[0], turn[1], turn[2]});
  }
}

/// The names of the kinds that hold a body whose motion is given, each once.
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
  adapters::SceneInfo info;
  info.title = setup.title;
  if (setup.units.si) {
    info.length_unit = std::string("m");
    info.time_unit = std::string("s");
  }
  info.domain_upper = physical(Vec3(setup.cells[0], setup.cells[1], setup.cells[2]), dimension::length);
  info.gravity = physical(setup.gravity, dimension::acceleration);
  for (const BoundarySpec& side : setup.boundary) info.sides.emplace_back(boundary_names[side.kind]);
  info.driven_kinds = driven_kinds(setup);
  for (const CurvedWall& curved : setup.walls) {
    SceneWall& wall = info.walls.emplace_back();
    wall.name = curved.name;
    std::visit([&](const auto& surface) { describe(surface, physical, wall); }, curved.surface);
    if (const MeshWall* const mesh = curved.mesh(); mesh && mesh->motion.over_time.varies())
      add_table(mesh->motion, static_cast<double>(setup.steps), physical, wall);
  }
  adapters::write_scene(folder / "scene.h5", info);
}

}  // namespace silt::coupler
