#include "coupler/case/choose_collision.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace silt::coupler {

double fastest_given(const Case& scene) {
  double fastest = scene.fluid ? scene.fluid->initial.largest_speed() : 0;
  for (const BoundarySpec& side : scene.boundary) fastest = std::max(fastest, side.velocity.norm());
  scene.for_each_given(
      [&](const BodySpec& body, std::uint64_t) { fastest = std::max(fastest, body.velocity.norm()); });
  for (const FillSpec& fill : scene.fills) fastest = std::max(fastest, fill.velocity.norm());
  return fastest;
}

double cell_reynolds(const Case& scene) {
  return fastest_given(scene) / scene.fluid->kinematic_viscosity;
}

double measured_reynolds(lbm::Collision model) {
  switch (model) {
    case lbm::Collision::trt:
      return 10;
    case lbm::Collision::bgk:
      return 10;
    case lbm::Collision::regularised:
      return 3000;
  }
  __builtin_unreachable();
}

void choose_collision(Case& scene) {
  if (!scene.fluid || !scene.fluid->collision_by_scene) return;
  const bool fast = cell_reynolds(scene) > measured_reynolds(lbm::Collision::trt);
  scene.fluid->collision = fast ? lbm::Collision::regularised : lbm::Collision::trt;
}

std::string collision_reason(const Case& scene) {
  if (!scene.fluid->collision_by_scene) return "given";
  return fmt::format("auto: u/nu = {}, trt lasts to {}", shown(cell_reynolds(scene)),
                     shown(measured_reynolds(lbm::Collision::trt)));
}

}  // namespace silt::coupler
