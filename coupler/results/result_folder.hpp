#pragma once
// CASE/out: where the results of a run go, and what happens to those of an earlier one.
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "coupler/results/result_lock.hpp"

namespace silt::coupler {

/// FileError: the system does not let a file or folder be made, moved, written or removed.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Whether this is a file that a run, or the pictures made of it, leaves.
bool is_result(const std::filesystem::path&);

/// Makes `folder` ready for a new run. Results of an earlier run are never overwritten silently: the folder
/// is renamed to FOLDER.1 (or .2, ... the first that is free), unless `overwrite`, which deletes the earlier
/// results (only those). A link to a folder, a mount point and a folder that the system does not let be
/// renamed stay: the earlier results move to a folder of that name inside. FileError if nothing can be made
/// or moved there; std::runtime_error if a folder that would be renamed also holds files that are no results,
/// or if a run is writing there.
struct ReadyFolder {
  std::unique_ptr<ResultLock> lock;
  std::string note;  // what was done, for the user, or ""
};
ReadyFolder prepare_result_folder(const std::filesystem::path& folder, bool overwrite);
/// Makes a folder ready for a run that goes on: what a killed run left unfinished is removed. Errors as
/// above.
ReadyFolder return_to_result_folder(const std::filesystem::path& folder);

/// FileError for a file, a link to one, and a link that leads nowhere.
void require_folder(const std::filesystem::path&);

/// The file by which ranks that fail alone agree who speaks.
inline constexpr const char* last_words = "last_words.part";

/// Writes a text file under a temporary name and renames it. FileError naming file and reason.
void write_text(const std::filesystem::path&, const std::string& text);

}  // namespace silt::coupler
