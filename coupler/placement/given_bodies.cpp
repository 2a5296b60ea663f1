#include "coupler/placement/given_bodies.hpp"

#include <algorithm>

#include "coupler/case/case.hpp"
#include "coupler/placement/filed_bodies.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

std::uint64_t count_given(const Case& scene) {
  std::uint64_t n = scene.bodies.size();
  for (const FiledBodies& filed : scene.filed) n += filed.contents.points;
  return n;
}

double mean_width(const Case& scene, std::span<const GivenBody> bodies) {
  double sum = 0;
  for (const GivenBody& body : bodies) sum += 2 * rigid::bounding_radius(scene.shapes[body.spec.shape]);
  return bodies.empty() ? 1 : std::max(1.0, sum / static_cast<double>(bodies.size()));
}

int entry_of(const Case& scene, rigid::BodyId id) {
  if (id <= scene.bodies.size()) return scene.bodies[id - 1].entry;
  id -= scene.bodies.size();
  auto filed = scene.filed.begin();
  for (; id > filed->contents.points; ++filed) id -= filed->contents.points;
  return filed->alike.entry;
}

std::vector<GivenBody> given_bodies(const Case& scene, Surroundings& around) {
  std::vector<GivenBody> bodies;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const BodySpec& spec = scene.bodies[i];
    const bool own = around.is_here(spec.pose.position);
    const auto& near = around.ranks_near(rigid::bounding_box(scene.shapes[spec.shape], spec.pose));
    if (own || std::binary_search(near.begin(), near.end(), around.rank))
      bodies.push_back({i + 1, spec, own});
  }
  add_filed_bodies(scene, around, bodies);
  return bodies;
}

}  // namespace silt::coupler
