#pragma once
// Reads a case directory: case.toml, and nothing outside the directory.
#include <filesystem>
#include <string>
#include <vector>

#include "coupler/case/case.hpp"
#include "coupler/case/case_source.hpp"

namespace silt::coupler {

/// Reads `directory`/case.toml (or the file itself, if a .toml file is given) and converts everything to
/// lattice units. `overrides` are the values of `--set`: "key.path=value", the value in TOML, strings also
/// without quotes; list entries as in bodies[0].density. Throws CaseError with everything that is wrong:
/// syntax, unknown keys, types, ranges. Whether the scene makes sense is for check_case.
Case read_case(const std::filesystem::path& directory, const std::vector<std::string>& overrides = {});

/// Reads from a source as read_case does from a directory; the files that it had to read are in it then.
Case read_case(CaseSource&, const std::vector<std::string>& overrides = {});

/// Reads text at hand as read_case does a file; `file` labels the messages.
Case read_case_text(const std::string& text, const std::string& file,
                    const std::vector<std::string>& overrides = {});

}  // namespace silt::coupler
