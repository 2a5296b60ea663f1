#pragma once
// The keys that the reader of case files knows, as it says itself.
#include <map>
#include <string>
#include <vector>

namespace silt::coupler {

/// Returns the keys that reading a text asks for, by the path of their table without indices ("" for the
/// file, "fluid", "bodies", "output.fields") and in the order of asking: what a table of keys must name. Only
/// tables that the text has are read; what is wrong with their values does not matter. CaseError for text
/// that is not TOML.
std::map<std::string, std::vector<std::string>> keys_asked_for(const std::string& text);

}  // namespace silt::coupler
