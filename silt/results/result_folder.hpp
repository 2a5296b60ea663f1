#pragma once
// CASE/out: where the results of a run go, and what happens to those of an earlier one.
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

namespace silt {

/// FileError: the system does not let a file or folder be made, moved, written or removed.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// ResultLock is held by rank 0 of a run as long as it lives: FOLDER/run.lock, locked by the system (flock),
/// which lets go of it when the process ends, however it ends; its text names host and process. Where the
/// file system knows no locks it keeps nobody out.
class ResultLock {
 public:
  static constexpr const char* name = "run.lock";

  /// Takes the lock of a folder that is there. std::runtime_error if another run has it, which the text
  /// names, and FileError if the file cannot be made.
  explicit ResultLock(const std::filesystem::path& folder);
  /// Removes the file, unless the folder has been renamed.
  ~ResultLock();
  ResultLock(const ResultLock&) = delete;
  ResultLock& operator=(const ResultLock&) = delete;

  /// Returns whether the folder's lock is still this one: not if the folder has been renamed and made again.
  bool is_in_place() const;

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

/// Returns whether a run, or a picture made of it, leaves a file of this name.
bool is_result(const std::filesystem::path&);

/// Makes `folder` ready for a new run. Results of an earlier run are never overwritten silently: the folder
/// is renamed to FOLDER.1 (or .2, ... the first that is free), unless `overwrite`, which deletes the earlier
/// results (only those). A link to a folder, a mount point and a folder that the system does not let be
/// renamed stay: the earlier results move to a folder of that name inside. FileError if nothing can be made
/// or moved there; std::runtime_error if a folder to be renamed also holds other files, or if a run is
/// writing there.
struct ReadyFolder {
  std::unique_ptr<ResultLock> lock;
  std::string note;  // what was done, for the user, or ""
};
ReadyFolder prepare_result_folder(const std::filesystem::path& folder, bool overwrite);
/// Makes a folder ready for a resumed run: removes unfinished files of a killed one. Errors as above.
ReadyFolder return_to_result_folder(const std::filesystem::path& folder);

/// FileError for a file, a link to one, and a link that leads nowhere.
void require_folder(const std::filesystem::path&);

/// The file by which ranks that fail alone agree who speaks.
inline constexpr const char* last_words = "last_words.part";

/// Writes a text file under a temporary name and renames it. FileError naming file and reason.
void write_text(const std::filesystem::path&, const std::string& text);

}  // namespace silt
