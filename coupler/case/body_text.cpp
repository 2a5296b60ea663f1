#include "coupler/case/body_text.hpp"

#include <fmt/format.h>

#include "coupler/case/case.hpp"

namespace silt::coupler {

std::string entry_key(int entry) {
  return fmt::format("bodies[{}]", entry);
}

std::string position_key(const Case& scene, int entry) {
  const std::string key = entry_key(entry);
  return key + (scene.places.count(key + ".positions") ? ".positions" : ".position");
}

std::string shown_point(const Case& scene, const rigid::Vec3& x) {
  const double cell = scene.units.cell_size;
  return fmt::format("[{}, {}, {}]", shown(x[0] * cell), shown(x[1] * cell), shown(x[2] * cell));
}

std::string shown_length(const Case& scene, double x) {
  return shown(x * scene.units.cell_size);
}

}  // namespace silt::coupler
