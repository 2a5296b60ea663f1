#include "adapters/hdf5/shared_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace silt::adapters::hdf5 {

SharedFile::SharedFile(const Path& path) : path_(path), file_(::open(path.c_str(), O_WRONLY | O_CLOEXEC)) {
  if (file_ < 0) fail_in_system(path_, "cannot open", errno);
}

SharedFile::~SharedFile() {
  if (file_ >= 0) ::close(file_);
}

void SharedFile::write(std::uint64_t at, const std::vector<std::byte>& values) {
  if (!write_all(file_, at, values.size(), reinterpret_cast<const char*>(values.data())))
    fail_in_system(path_, "cannot write (is the disk full?)", errno);
}

void SharedFile::close() {
  if (::fsync(file_) != 0) fail_in_system(path_, "cannot flush to the disk", errno);
  if (::close(std::exchange(file_, -1)) != 0)
    fail_in_system(path_, "cannot close the file (is the disk full?)", errno);
}

}  // namespace silt::adapters::hdf5
