#include "adapters/hdf5/scene_file.hpp"

#include "adapters/hdf5/file.hpp"

namespace silt::adapters {
namespace {

using hdf5::File;
using hdf5::Handle;

template <std::size_t n>
void numbers(File& file, hid_t owner, const char* name, const std::array<double, n>& x) {
  file.attribute(owner, name, H5T_NATIVE_DOUBLE, {n}, x.data());
}

template <class Row>
void rows(File& file, const std::string& name, hid_t memory_type, hid_t file_type,
          const std::vector<Row>& data) {
  const Handle dataset = file.create_contiguous(name, file_type, {data.size(), std::tuple_size_v<Row>});
  if (!data.empty())
    file.check(H5Dwrite(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()),
               "cannot write " + name + " (is the disk full?)");
}

void write_mesh(File& file, hid_t group, const std::string& name, const SceneWall& wall) {
  file.attribute(group, "solid", std::string(wall.hollow ? "outside" : "inside"));
  numbers(file, group, "orientation", wall.orientation);
  numbers(file, group, "velocity", wall.velocity);
  numbers(file, group, "angular_velocity", wall.angular_velocity);
  numbers(file, group, "amplitude", wall.amplitude);
  file.attribute(group, "frequency", wall.frequency);
  file.attribute(group, "phase", wall.phase);
  rows(file, name + "/vertices", H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, wall.vertices);
  rows(file, name + "/triangles", H5T_NATIVE_UINT32, H5T_STD_U32LE, wall.triangles);
  rows(file, name + "/table", H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, wall.table);
}

void write_wall(File& file, const std::string& name, const SceneWall& wall) {
  const Handle group = file.group(name, true);
  file.attribute(group, "name", wall.name);
  file.attribute(group, "type", wall.type);
  numbers(file, group, "position", wall.position);
  if (wall.type == "mesh") return write_mesh(file, group, name, wall);
  numbers(file, group, "axis", wall.axis);
  for (const auto& [key, size] : wall.sizes) file.attribute(group, key, size);
}

}  // namespace

void write_scene(const std::filesystem::path& path, const SceneInfo& scene) {
  hdf5::TemporaryFile part(path.string() + ".part", true);
  File file = File::create(part.path(), hdf5::Format::classic);
  const Handle root = file.group("/", false);
  file.attribute(root, "title", scene.title);
  file.attribute(root, "length_unit", scene.length_unit);
  file.attribute(root, "time_unit", scene.time_unit);
  numbers(file, root, "domain_upper", scene.domain_upper);
  numbers(file, root, "gravity", scene.gravity);
  file.attribute(root, "sides", scene.sides);
  if (!scene.driven_kinds.empty()) file.attribute(root, "driven_kinds", scene.driven_kinds);
  const Handle walls = file.group("/walls", true);
  for (std::size_t w = 0; w < scene.walls.size(); ++w)
    write_wall(file, "/walls/" + std::to_string(w), scene.walls[w]);
  file.close();
  part.rename_to(path);
}

}  // namespace silt::adapters
