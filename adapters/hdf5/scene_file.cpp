#include "adapters/hdf5/scene_file.hpp"

#include "adapters/hdf5/file.hpp"

namespace silt::adapters {
namespace {

using hdf5::File;
using hdf5::Handle;

void write_mesh(File& file, hid_t group, const std::string& name, const SceneWall& wall) {
  file.attribute(group, "solid", std::string(wall.hollow ? "outside" : "inside"));
  file.numbers(group, "orientation", wall.orientation);
  file.numbers(group, "velocity", wall.velocity);
  file.numbers(group, "angular_velocity", wall.angular_velocity);
  file.numbers(group, "amplitude", wall.amplitude);
  file.number(group, "frequency", wall.frequency);
  file.number(group, "phase", wall.phase);
  file.write_list(name + "/vertices", H5T_IEEE_F64LE, wall.vertices);
  file.write_list(name + "/triangles", H5T_STD_U32LE, wall.triangles);
  file.write_list(name + "/table", H5T_IEEE_F64LE, wall.table);
}

void write_wall(File& file, const std::string& name, const SceneWall& wall) {
  const Handle group = file.create_group(name);
  file.attribute(group, "name", wall.name);
  file.attribute(group, "type", wall.type);
  file.numbers(group, "position", wall.position);
  if (wall.type == "mesh") return write_mesh(file, group, name, wall);
  file.numbers(group, "axis", wall.axis);
  for (const auto& [key, size] : wall.sizes) file.number(group, key, size);
}

}  // namespace

void write_scene(const std::filesystem::path& path, const SceneInfo& scene) {
  hdf5::TemporaryFile part(path.string() + ".part", true);
  File file = File::create(part.path(), hdf5::Format::classic);
  const Handle root = file.group("/");
  file.attribute(root, "title", scene.title);
  file.attribute(root, "length_unit", scene.length_unit);
  file.attribute(root, "time_unit", scene.time_unit);
  file.numbers(root, "domain_upper", scene.domain_upper);
  file.numbers(root, "gravity", scene.gravity);
  file.attribute(root, "sides", scene.sides);
  if (!scene.driven_kinds.empty()) file.attribute(root, "driven_kinds", scene.driven_kinds);
  const Handle walls = file.create_group("/walls");
  for (std::size_t w = 0; w < scene.walls.size(); ++w)
    write_wall(file, "/walls/" + std::to_string(w), scene.walls[w]);
  file.close();
  part.rename_to(path);
}

}  // namespace silt::adapters
