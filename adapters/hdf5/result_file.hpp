#pragma once
// What all files of results have in common: where they came from, which cells a rank gives or takes, how
// numbers are stored, and what files of a step are called.
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace silt::adapters {

/// Provenance says where a file came from. Each member becomes an attribute of /provenance, except case_text,
/// which may be long and becomes the scalar string dataset /provenance/case_text. Only rank 0's values are
/// used.
struct Provenance {
  std::string version, commit;   // of silt
  std::string title, case_text;  // case.toml as read, with overrides applied
  std::int64_t ranks = 1;
  std::string backend;  // of the collision detection
  std::string compiler, flags, libraries;
  std::string host, processor, created;  // created: ISO 8601
};

/// CellBox holds the cells lower <= x < upper, in global cell coordinates. Boxes of all ranks must not
/// overlap.
struct CellBox {
  std::array<int, 3> lower, upper;

  std::size_t cells() const {
    std::size_t n = 1;
    for (int d = 0; d < 3; ++d) n *= upper[d] > lower[d] ? upper[d] - lower[d] : 0;
    return n;
  }
};

/// How a number of a cell is stored.
enum class Storage { single, double_, byte };

/// Returns FOLDER/NAME_000000000100SUFFIX for step 100: names sort like steps.
std::filesystem::path step_path(const std::filesystem::path& folder, const std::string& name,
                                std::int64_t step, const std::string& suffix);

/// StepFile is a file with such a name.
struct StepFile {
  std::int64_t step;
  std::filesystem::path path;
};

/// Returns the step in a file's name, if the name is one.
std::optional<std::int64_t> step_of(const std::filesystem::path&, std::string_view name,
                                    std::string_view suffix);

/// Lists the files of a folder by their names, newest (largest step) first; none of a folder that is not
/// there.
std::vector<StepFile> step_files(const std::filesystem::path& folder, std::string_view name,
                                 std::string_view suffix);

}  // namespace silt::adapters
