#pragma once
// Which parts of a step a scene does not need, for report.json: "skipped".
#include <optional>

#include "adapters/json/json.hpp"
#include "coupler/case/fluid_spec.hpp"
#include "coupler/case/output_spec.hpp"
#include "coupler/scene.hpp"

namespace silt::coupler {

/// Whether the scene's step has this stage at all.
bool has_stage(const Scene&, Stage);

/// Returns the names of the stages, forces and outputs that the scene does without.
adapters::Json skipped_passes(const Scene&, const std::optional<FluidSpec>&, const OutputSpec&);

}  // namespace silt::coupler
