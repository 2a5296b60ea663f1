#include "adapters/hdf5/checkpoint_file.hpp"

namespace silt::adapters {
namespace {
constexpr std::string_view name = "checkpoint";

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}
}  // namespace

std::optional<std::int64_t> checkpoint_step(const std::filesystem::path& path) {
  return step_of(path, name, ".h5");
}

std::vector<StepFile> list_checkpoints(const std::filesystem::path& folder) {
  return step_files(folder, name, ".h5");
}

std::optional<std::filesystem::path> previous_checkpoint(const std::filesystem::path& path) {
  const auto own = checkpoint_step(path);
  for (const auto& c : list_checkpoints(folder_of(path)))
    if (c.path.filename() != path.filename() && (!own || c.step < *own)) return c.path;
  return {};
}

void drop_old_checkpoints(const std::filesystem::path& path, int keep) {
  std::error_code ignored;
  const auto own = checkpoint_step(path);
  if (!own) return;
  int kept = 0;
  for (const auto& c : list_checkpoints(folder_of(path)))
    if (c.step <= *own && kept++ >= keep && keep > 0) std::filesystem::remove(c.path, ignored);
  for (const auto& entry : std::filesystem::directory_iterator(folder_of(path), ignored)) {
    auto part = entry.path();
    if (part.extension() == ".part" && checkpoint_step(part.replace_extension()))
      std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace silt::adapters
