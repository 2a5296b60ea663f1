#include "coupler/results/skipped_passes.hpp"

#include <algorithm>

#include "coupler/case/case.hpp"

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
    default:
      return scene.rigid_step != nullptr;
  }
}

Json skipped_passes(const Scene& scene) {
  Json skipped = Json::array();
  for (int s = 0; s < int(Stage::count); ++s)
    if (!has_stage(scene, Stage(s))) skipped.push_back(stage_names[s]);
  const Case& setup = scene.setup;
  const auto skip = [&](bool absent, const char* name) {
    if (absent) skipped.push_back(name);
  };
  skip(scene.ranks == 1, "messages between ranks");
  skip(scene.flow && scene.has_surfaces() && !scene.anything_moves, "remapping");
  skip(scene.rigid_step && setup.gravity.isZero(0), "gravity");
  skip(scene.flow && setup.fluid->body_force.isZero(0), "body force");
  const auto none = [&](double rigid::Material::*coefficient) {
    return std::all_of(setup.pair_materials.begin(), setup.pair_materials.end(),
                       [&](const rigid::Material& m) { return m.*coefficient == 0; });
  };
  skip(scene.rigid_step && none(&rigid::Material::restitution), "restitution");
  skip(scene.rigid_step && none(&rigid::Material::friction), "friction");
  skip(scene.flow && scene.rigid_step && !scene.world.lubrication, "lubrication");
  skip(setup.output.fields.every == 0, "field output");
  skip(setup.output.bodies.every == 0, "body output");
  skip(setup.output.checkpoint.every == 0, "checkpoints");
  return skipped;
}

}  // namespace silt::coupler
