#include "coupler/results/skipped_passes.hpp"

#include <algorithm>

namespace silt::coupler {

using adapters::Json;

bool has_stage(const Scene& scene, Stage stage) {
  switch (stage) {
    case Stage::object_mapping:
    case Stage::force_evaluation:
      return scene.flow && scene.has_surfaces();
    case Stage::lbm_communication:
    case Stage::stream_collide:
      return scene.flow != nullptr;
    case Stage::integrate:
    case Stage::collision_detection:
    case Stage::contact_response:
    case Stage::body_synchronisation:
      return scene.rigid_step != nullptr;
    case Stage::count:
      break;
  }
  return false;
}

Json skipped_passes(const Scene& scene, const std::optional<FluidSpec>& fluid, const OutputSpec& output) {
  Json skipped = Json::array();
  for (int s = 0; s < int(Stage::count); ++s)
    if (!has_stage(scene, Stage(s))) skipped.push_back(stage_names[s]);
  const auto skip = [&](bool absent, const char* name) {
    if (absent) skipped.push_back(name);
  };
  skip(scene.ranks == 1, "messages between ranks");
  skip(scene.flow && scene.has_surfaces() && !scene.anything_moves, "remapping");
  skip(scene.rigid_step && scene.world.gravity.isZero(0), "gravity");
  skip(scene.flow && fluid->body_force.isZero(0), "body force");
  const auto none = [&](double rigid::Material::*coefficient) {
    return std::all_of(scene.world.materials.begin(), scene.world.materials.end(),
                       [&](const rigid::Material& m) { return m.*coefficient == 0; });
  };
  skip(scene.rigid_step && none(&rigid::Material::restitution), "restitution");
  skip(scene.rigid_step && none(&rigid::Material::friction), "friction");
  skip(scene.flow && scene.rigid_step && !scene.world.lubrication, "lubrication");
  skip(output.fields.every == 0, "field output");
  skip(output.bodies.every == 0, "body output");
  skip(output.checkpoint.every == 0, "checkpoints");
  return skipped;
}

}  // namespace silt::coupler
