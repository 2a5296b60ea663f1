#pragma once
// One run a folder of results.
#include <filesystem>

namespace silt::coupler {

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

  /// Whether the folder's lock is still this one: not if the folder has been renamed and made anew.
  bool is_in_place() const;

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace silt::coupler
