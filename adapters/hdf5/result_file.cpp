#include "adapters/hdf5/result_file.hpp"

#include <algorithm>
#include <charconv>

namespace silt::adapters {

std::filesystem::path step_path(const std::filesystem::path& folder, const std::string& name,
                                std::int64_t step, const std::string& suffix) {
  constexpr std::size_t digits = 12;
  std::string number = std::to_string(step);
  if (number.size() < digits) number.insert(0, digits - number.size(), '0');
  return folder / (name + "_" + number + suffix);
}

std::optional<std::int64_t> step_of(const std::filesystem::path& path, std::string_view name,
                                    std::string_view suffix) {
  const std::string file = path.filename().string(), prefix = std::string(name) + "_";
  if (file.size() <= prefix.size() + suffix.size() || !file.starts_with(prefix) || !file.ends_with(suffix))
    return {};
  std::int64_t step = 0;
  const char *from = file.data() + prefix.size(), *to = file.data() + file.size() - suffix.size();
  const auto [end, error] = std::from_chars(from, to, step);
  if (error != std::errc{} || end != to) return {};
  return step;
}

std::vector<StepFile> step_files(const std::filesystem::path& folder, std::string_view name,
                                 std::string_view suffix) {
  std::vector<StepFile> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (const auto step = step_of(entry.path(), name, suffix); step && entry.is_regular_file(error))
      found.push_back({*step, entry.path()});
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.step > b.step; });
  return found;
}

}  // namespace silt::adapters
