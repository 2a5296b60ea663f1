#pragma once
// Private to adapters/hdf5: a file into which every rank writes its part of the values by itself. HDF5 has
// made the file on one rank and set the places aside (File::create_contiguous); it does not know of the
// others, so that an error of one rank is that rank's own.
#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

class SharedFile {
 public:
  /// Opens a file that is there; local, as all calls are. Throws Error, naming file and reason.
  explicit SharedFile(const Path&);
  ~SharedFile();
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  void write(std::uint64_t at, const std::vector<std::byte>& values);
  /// Brings what was written to the disk itself, and closes.
  void close();

 private:
  Path path_;
  int file_ = -1;
};

}  // namespace silt::adapters::hdf5
