#include "adapters/hdf5/scene_file.hpp"

#include "adapters/hdf5/file.hpp"

namespace silt::adapters {
namespace {

using hdf5::File;
using hdf5::Handle;

void write_attributes(File& file, hid_t group, const SceneGroup& from) {
  for (const auto& [name, value] : from.attributes)
    if (const auto* const number = std::get_if<double>(&value))
      file.number(group, name, *number);
    else if (const auto* const numbers = std::get_if<std::vector<double>>(&value))
      file.attribute(group, name, H5T_NATIVE_DOUBLE, {numbers->size()}, numbers->data());
    else if (const auto* const texts = std::get_if<std::vector<std::string>>(&value))
      file.attribute(group, name, *texts);
    else
      file.attribute(group, name, std::get<std::string>(value));
}

void write_wall(File& file, const std::string& name, const SceneGroup& wall) {
  write_attributes(file, file.create_group(name), wall);
  if (wall.triangles.empty()) return;
  file.write_list(name + "/vertices", H5T_IEEE_F64LE, wall.vertices);
  file.write_list(name + "/triangles", H5T_STD_U32LE, wall.triangles);
  file.write_list(name + "/table", H5T_IEEE_F64LE, wall.table);
}

}  // namespace

void write_scene(const std::filesystem::path& path, const SceneGroup& scene,
                 const std::vector<SceneGroup>& walls) {
  hdf5::TemporaryFile part(path.string() + ".part", true);
  File file = File::create(part.path(), hdf5::Format::classic);
  write_attributes(file, file.group("/"), scene);
  const Handle group = file.create_group("/walls");
  for (std::size_t w = 0; w < walls.size(); ++w) write_wall(file, "/walls/" + std::to_string(w), walls[w]);
  file.close();
  part.rename_to(path);
}

}  // namespace silt::adapters
