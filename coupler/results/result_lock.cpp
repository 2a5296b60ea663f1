#include "coupler/results/result_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "adapters/hdf5/system_reason.hpp"
#include "coupler/results/result_folder.hpp"

namespace silt::coupler {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& path) {
  std::ifstream in(path);
  std::string holder{std::istreambuf_iterator<char>(in), {}};
  while (!holder.empty() && holder.back() == '\n') holder.pop_back();
  throw std::runtime_error(fmt::format(
      "{}: a run is writing here: {}; wait for its end, stop it, or choose another folder with --out",
      path.parent_path().string(), holder.empty() ? "it has only just begun" : holder));
}

}  // namespace

ResultLock::ResultLock(const fs::path& folder) : path_(folder / name) {
  do {  // until it is the file that has the name: whoever had the lock before may have removed it
    if (file_ >= 0) close(file_);
    file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file_ < 0)
      throw FileError(fmt::format("{}: cannot be made: {}", path_.string(), adapters::system_reason(errno)));
    if (flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(file_);
      refuse(path_);
    }
  } while (!is_in_place());
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const std::string text = fmt::format("process {} on {}\n", getpid(), host);
  if (ftruncate(file_, 0) != 0 || pwrite(file_, text.data(), text.size(), 0) < 0) {
    const std::string reason = adapters::system_reason(errno);
    close(file_);
    throw FileError(fmt::format("{}: cannot be written: {}", path_.string(), reason));
  }
}

ResultLock::~ResultLock() {
  if (is_in_place()) unlink(path_.c_str());
  close(file_);
}

bool ResultLock::is_in_place() const {
  struct stat mine, there;
  return fstat(file_, &mine) == 0 && stat(path_.c_str(), &there) == 0 && mine.st_ino == there.st_ino &&
         mine.st_dev == there.st_dev;
}

}  // namespace silt::coupler
