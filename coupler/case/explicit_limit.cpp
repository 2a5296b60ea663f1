#include "coupler/case/explicit_limit.hpp"

#include <algorithm>
#include <cmath>

#include "coupler/case/case.hpp"

namespace silt::coupler {

double least_explicit_density(const Case& scene, const rigid::Shape& shape) {
  if (!scene.fluid || scene.coupling.time != TimeCoupling::explicit_) return 0;
  const bool steps = scene.coupling.wall_scheme == WallScheme::bounce_back;
  const double stiffness = steps ? 4.7 : 5.13, bearable = steps ? 0.80 : 0.40;
  return stiffness / (rigid::least_width(shape) * bearable * std::sqrt(scene.fluid->relaxation_time - 0.5));
}

bool has_bodies_too_light(const Case& scene) {
  bool found = false;
  const auto look = [&](int shape, double density) {
    found = found || density < least_explicit_density(scene, scene.shapes[shape]);
  };
  scene.for_each_given([&](const BodySpec& body, std::uint64_t) {
    if (body.motion == rigid::Motion::free) look(body.shape, body.density);
  });
  for (const FillSpec& fill : scene.fills) look(fill.shape, fill.density);
  return found;
}

}  // namespace silt::coupler
