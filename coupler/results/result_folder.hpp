#pragma once
// CASE/out: where the results of a run go, and what happens to those of an earlier one.
#include <filesystem>
#include <string>

namespace silt::coupler {

/// Whether this is a file that a run, or the pictures made of it, leaves.
bool is_result(const std::filesystem::path&);

/// Makes `folder` ready for a new run. Results of an earlier run are never overwritten silently: the folder
/// is renamed to FOLDER.1 (or .2, ... the first that is free), unless `overwrite`, which deletes the earlier
/// results (only those). Returns what was done, for the user, or "". std::runtime_error if the folder cannot
/// be made or moved, or if it holds results and also files that are not.
std::string prepare_result_folder(const std::filesystem::path& folder, bool overwrite);

/// Writes a text file under a temporary name and renames it. std::runtime_error naming file and reason.
void write_text(const std::filesystem::path&, const std::string& text);

}  // namespace silt::coupler
