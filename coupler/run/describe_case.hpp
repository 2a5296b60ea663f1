#pragma once
// What `silt info` says of a case and of a folder of results.
#include <filesystem>
#include <string>

namespace silt::coupler {

/// Returns the derived table of a case (a folder with a case.toml, or a .toml file) and a list of the results
/// in its folder `out`; of a folder without a case.toml the list alone. CaseError; std::runtime_error for a
/// folder with neither.
std::string describe_case(const std::filesystem::path&);

}  // namespace silt::coupler
