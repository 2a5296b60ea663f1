#include "adapters/hdf5/disk.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace silt::adapters {

std::string with_limit(std::string reason) {
  if (reason == std::strerror(EFBIG)) reason += " (a limit on the size of files: see ulimit -f)";
  return reason;
}

std::string system_reason(int error) {
  return with_limit(std::strerror(error));
}

}  // namespace silt::adapters

namespace silt::adapters::hdf5 {
namespace {

/// Opens the file (or creates it, by the flags), calls act and closes; throws unless act returns 0.
template <class Act>
void with_descriptor(const Path& path, int flags, const std::string& what, Act&& act) {
  const int file = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  if (file < 0) fail_in_system(path, "cannot open or create", errno);
  const bool good = act(file) == 0;
  const int error = errno;
  ::close(file);
  if (!good) fail_in_system(path, "cannot " + what, error);
}

/// Returns 0 if these bytes are free on the file's disk, else -1 with errno as for a full disk.
int room_for(int file, std::uint64_t bytes) {
  struct statvfs disk;
  if (::fstatvfs(file, &disk) != 0 || std::int64_t(bytes) <= 0) return 0;
  if (disk.f_bavail * disk.f_frsize >= bytes) return 0;
  errno = ENOSPC;
  return -1;
}

}  // namespace

void fail_in_system(const Path& file, const std::string& what, int error) {
  throw Error(file.string() + ": " + what + ": " + system_reason(error));
}

bool read_all(int file, std::uint64_t at, std::size_t size, char* to) {
  while (size > 0) {
    const ssize_t n = ::pread(file, to, size, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    if (n == 0) {
      std::memset(to, 0, size);
      return true;
    }
    to += n, at += n, size -= n;
  }
  return true;
}

bool write_all(int file, std::uint64_t at, std::size_t size, const char* from) {
  while (size > 0) {
    const ssize_t n = ::pwrite(file, from, size, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = ENOSPC;
    if (n <= 0) return false;
    from += n, at += n, size -= n;
  }
  return true;
}

void reserve(const Path& path, std::uint64_t size) {
  const std::string what = "reserve " + std::to_string(size) + " bytes (is the disk full?)";
  with_descriptor(path, O_WRONLY | O_CREAT, what, [&](int file) {
    struct stat before;
    if (::fstat(file, &before) != 0) return -1;
    if (::fallocate(file, 0, 0, static_cast<off_t>(size)) == 0) return 0;
    const int error = errno;
    if (error == EOPNOTSUPP || error == ENOSYS)
      return room_for(file, size - 512 * std::uint64_t(before.st_blocks));
    if (::ftruncate(file, before.st_size) != 0) return -1;
    errno = error;
    return -1;
  });
}

void sync_to_disk(const Path& path) {
  with_descriptor(path, O_RDONLY, "flush to the disk", ::fsync);
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  if (!mine_) return;
  std::filesystem::resize_file(path_, 0, ignored);  // frees the space even while another process has it open
  std::filesystem::remove(path_, ignored);
}

void TemporaryFile::rename_to(const Path& to) {
  std::error_code error;
  std::filesystem::rename(path_, to, error);
  if (error) throw Error(to.string() + ": cannot rename " + path_.string() + " to it: " + error.message());
  mine_ = false;
  const Path folder = to.has_parent_path() ? to.parent_path() : Path(".");
  with_descriptor(folder, O_RDONLY | O_DIRECTORY, "flush the folder to the disk", ::fsync);
}

RawFile::RawFile(const Path& path, Use use)
    : path_(path), file_(::open(path.c_str(), (use == to_read ? O_RDONLY : O_WRONLY) | O_CLOEXEC)) {
  if (file_ < 0) fail_in_system(path_, "cannot open", errno);
}

RawFile::~RawFile() {
  if (file_ >= 0) ::close(file_);
}

std::vector<std::byte> RawFile::read(std::uint64_t at, std::size_t bytes) const {
  std::vector<std::byte> values(bytes);
  if (!read_all(file_, at, bytes, reinterpret_cast<char*>(values.data())))
    fail_in_system(path_, "cannot read", errno);
  return values;
}

void RawFile::write(std::uint64_t at, const std::vector<std::byte>& values) {
  if (!write_all(file_, at, values.size(), reinterpret_cast<const char*>(values.data())))
    fail_in_system(path_, "cannot write (is the disk full?)", errno);
}

void RawFile::close() {
  if (::fsync(file_) != 0) fail_in_system(path_, "cannot flush to the disk", errno);
  if (::close(std::exchange(file_, -1)) != 0)
    fail_in_system(path_, "cannot close the file (is the disk full?)", errno);
}

}  // namespace silt::adapters::hdf5
