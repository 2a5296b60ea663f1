#pragma once
// scene.h5, which a run writes when it begins, so that pictures show what was run.
#include <filesystem>

namespace silt::coupler {

struct Case;

/// Writes the sides, gravity, walls and driven kinds of a case into the folder. std::runtime_error.
void write_scene_file(const Case&, const std::filesystem::path& folder);

}  // namespace silt::coupler
