#include "coupler/case/body_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "coupler/case/case.hpp"

namespace silt::coupler {

std::string body_name(const Case& scene, rigid::BodyId id) {
  if (!rigid::is_wall(id)) return fmt::format("body {}", id);
  if (id < rigid::first_tube_id)
    return fmt::format("the side {}", side_names[Side(id - rigid::first_wall_id)]);
  return fmt::format("the wall '{}'", scene.walls[id - rigid::first_tube_id].name);
}

std::string entry_key(int entry) {
  return fmt::format("bodies[{}]", entry);
}

std::string position_key(const Case& scene, int entry) {
  const std::string key = entry_key(entry);
  return key + (scene.places.count(key + ".positions") ? ".positions" : ".position");
}

std::string position_text(const Case& scene, const BodySpec& body) {
  const std::string key = position_key(scene, body.entry);
  if (body.point == 0) return key;
  const auto filed = std::find_if(scene.filed.begin(), scene.filed.end(),
                                  [&](const FiledBodies& f) { return f.alike.entry == body.entry; });
  return fmt::format("{}, point {} of {}", key, body.point, filed->positions.name());
}

std::string shown_point(const Case& scene, const rigid::Vec3& x) {
  const double cell = scene.units.cell_size;
  return fmt::format("[{}, {}, {}]", shown(x[0] * cell), shown(x[1] * cell), shown(x[2] * cell));
}

std::string shown_length(const Case& scene, double x) {
  return shown(x * scene.units.cell_size);
}

}  // namespace silt::coupler
