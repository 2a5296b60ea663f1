#pragma once
// Says what is in a file of results, to a reader at a terminal.
#include <filesystem>
#include <string>

namespace silt::adapters {

/// Lines of text: where the file came from, the attributes of its groups, its datasets with their shapes and
/// units. The case's text is left out. To be called on one rank. Throws std::runtime_error naming the file
/// and the reason.
std::string describe_file(const std::filesystem::path&);

}  // namespace silt::adapters
