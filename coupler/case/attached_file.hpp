#pragma once
// A file that a case names, beside its case.toml: its bytes, and what a checkpoint remembers of it.
#include <filesystem>
#include <string>

#include "coupler/case/position_file.hpp"

namespace silt::coupler {

struct AttachedFile {
  std::string bytes;
  std::string fingerprint;     // "rock.stl: 684 bytes, XXH3 00112233aabbccdd"
  PositionContents positions;  // of a file of positions, whose bytes stay where they are
};

/// Reads the file `name`, which is relative to the directory of the case and may not lead out of it.
/// std::invalid_argument says what is wrong with it.
AttachedFile read_attached(const std::filesystem::path& directory, const std::string& name);

/// Looks at positions, "cloud.csv" or "cloud.h5:/points", without keeping them; errors alike.
AttachedFile look_at_positions(const std::filesystem::path& directory, const std::string& name);

}  // namespace silt::coupler
