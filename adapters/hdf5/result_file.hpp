#pragma once
// Common to all result files: provenance, boxes of cells, number types, file names of a step.
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lbm/blocks/lattice.hpp"

namespace silt::adapters {

/// The origin of a file. Each member becomes an attribute of /provenance, except case_text, which becomes the
/// scalar string dataset /provenance/case_text. Rank 0's values are used.
struct Provenance {
  std::string version, commit;   // of silt
  std::string title, case_text;  // case.toml as read, with overrides
  std::int64_t ranks = 1;
  std::string backend;  // of the collision detection
  std::string compiler, flags, libraries;
  std::string host, processor, created;  // created: ISO 8601
};

/// Boxes are in global cell coordinates; those of different ranks must not overlap.
using lbm::CellBox;

/// This rank's tiles of a lattice, which form a box, and the entries that each has in a list, by z, y, x.
struct ListedTiles {
  std::array<int, 3> lattice;
  CellBox box;
  std::span<const std::uint32_t> counts;
};

/// The number type of a stored cell value.
enum class Storage { single, double_, byte };

/// Returns FOLDER/NAME_000000000100SUFFIX for step 100, so that names sort by step.
std::filesystem::path step_path(const std::filesystem::path& folder, const std::string& name,
                                std::int64_t step, const std::string& suffix);

struct StepFile {
  std::int64_t step;
  std::filesystem::path path;
};

/// Returns the step in the name of such a file; nothing for other names.
std::optional<std::int64_t> step_of(const std::filesystem::path&, std::string_view name,
                                    std::string_view suffix);

/// Lists such files of a folder, the newest (largest step) first; none if there is no folder.
std::vector<StepFile> step_files(const std::filesystem::path& folder, std::string_view name,
                                 std::string_view suffix);

}  // namespace silt::adapters
