#pragma once
// The checkpoints of a folder: checkpoint_000000005000.h5, the number being the step.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace silt::adapters {

struct CheckpointName {
  std::int64_t step;
  std::filesystem::path path;
};

std::filesystem::path checkpoint_path(const std::filesystem::path& folder, std::int64_t step);

/// The step of a checkpoint's name, if it is one.
std::optional<std::int64_t> checkpoint_step(const std::filesystem::path&);

/// The checkpoints of a folder, the newest (largest step) first; by name only, none for a folder that is not
/// there.
std::vector<CheckpointName> list_checkpoints(const std::filesystem::path& folder);

/// The newest checkpoint in the same folder whose step is smaller than that of `path`.
std::optional<std::filesystem::path> previous_checkpoint(const std::filesystem::path& path);

/// Deletes all but the `keep` newest of those up to and including the step of `path`, and unfinished ones
/// that a killed run left. keep < 1 keeps all. Errors are ignored: an old checkpoint too many harms nobody.
void drop_old_checkpoints(const std::filesystem::path& path, int keep);

}  // namespace silt::adapters
