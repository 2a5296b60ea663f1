#pragma once
// CASE/out, the folder for results of a run, and the handling of earlier results.
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

namespace silt {

/// The system refused to make, move, write or remove a file or folder.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The lock of a run's rank 0: FOLDER/run.lock, locked by the system (flock), which releases it when the
/// process ends in any way; its text names host and process. Has no effect on file systems without locks.
class ResultLock {
 public:
  static constexpr const char* name = "run.lock";

  /// Takes the lock of an existing folder. Throws std::runtime_error, naming the run, if another has it, and
  /// FileError if the file cannot be made.
  explicit ResultLock(const std::filesystem::path& folder);
  /// Removes the file, unless the folder has been renamed.
  ~ResultLock();
  ResultLock(const ResultLock&) = delete;
  ResultLock& operator=(const ResultLock&) = delete;

  /// Returns whether the folder's lock is this one; not after the folder was renamed and made anew.
  bool is_in_place() const;

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

/// Returns whether a run, or a picture of it, writes a file of this name.
bool is_result(const std::filesystem::path&);

/// Prepares `folder` for a new run. Earlier results are never overwritten silently: the folder is renamed to
/// FOLDER.1 (or .2, ... the first unused), unless `overwrite`, which deletes earlier results only. In a link,
/// a mount point and a folder that cannot be renamed, results move to a subfolder of that name. Throws
/// FileError if making or moving fails, and std::runtime_error if the folder has other files or a run writes
/// to it.
struct ReadyFolder {
  std::unique_ptr<ResultLock> lock;
  std::string note;  // what was done, for the user, or ""
};
ReadyFolder prepare_result_folder(const std::filesystem::path& folder, bool overwrite);
/// Prepares the folder of a resumed run: removes unfinished files of a killed run. Throws likewise.
ReadyFolder return_to_result_folder(const std::filesystem::path& folder);

/// Throws FileError for a file, a link to a file, and a dangling link.
void require_folder(const std::filesystem::path&);

/// The file by which ranks that fail alone choose the one that reports.
inline constexpr const char* last_words = "last_words.part";

/// Writes a text file under a temporary name and renames it. Throws FileError with file and reason.
void write_text(const std::filesystem::path&, const std::string& text);

}  // namespace silt
