#include <algorithm>
#include <charconv>

#include "adapters/hdf5/checkpoint_file.hpp"

namespace silt::adapters {
namespace {
constexpr std::string_view prefix = "checkpoint_", suffix = ".h5";

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}
}  // namespace

std::optional<std::int64_t> checkpoint_step(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  if (name.size() <= prefix.size() + suffix.size() || !name.starts_with(prefix) || !name.ends_with(suffix))
    return {};
  std::int64_t step = 0;
  const char *from = name.data() + prefix.size(), *to = name.data() + name.size() - suffix.size();
  const auto [end, error] = std::from_chars(from, to, step);
  if (error != std::errc{} || end != to) return {};
  return step;
}

std::vector<CheckpointName> list_checkpoints(const std::filesystem::path& folder) {
  std::vector<CheckpointName> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (const auto step = checkpoint_step(entry.path()); step && entry.is_regular_file(error))
      found.push_back({*step, entry.path()});
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.step > b.step; });
  return found;
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
    auto name = entry.path();
    if (name.extension() == ".part" && checkpoint_step(name.replace_extension()))
      std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace silt::adapters
