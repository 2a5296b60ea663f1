#pragma once
// Files without HDF5: room on the disk, flushing, names that files get when they are whole, files of which
// each rank reads or writes its part; and the reasons of the system.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace silt::adapters {

/// Adds to the system's words for a file that is too large which limit that is.
std::string with_limit(std::string reason);

/// Returns the system's words for an error number.
std::string system_reason(int error);

}  // namespace silt::adapters

namespace silt::adapters::hdf5 {

using Path = std::filesystem::path;

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws Error "FILE: WHAT: REASON", the reason from an error number of the system.
[[noreturn]] void fail_in_system(const Path& file, const std::string& what, int error);

/// Read or write all of it at a place of an open file; behind the file's end there are zeros. They return
/// whether that went well; errno says why not.
bool read_all(int file, std::uint64_t at, std::size_t size, char* to);
bool write_all(int file, std::uint64_t at, std::size_t size, const char* from);

/// Takes disk space for a file up to `size` bytes, making it longer if need be (HDF5 cuts a longer file when
/// it closes it), so that a full disk is found before HDF5 is in the middle of something. Throws Error; the
/// file is then as long as before. Where the file system cannot reserve, it only looks whether there is room.
void reserve(const Path&, std::uint64_t size);

/// Writes a file's content to the disk itself. Throws Error.
void sync_to_disk(const Path&);

/// TemporaryFile is a file that rank 0 removes in the end, unless it was renamed.
class TemporaryFile {
 public:
  TemporaryFile(Path path, bool mine) : path_(std::move(path)), mine_(mine) {}
  TemporaryFile(const TemporaryFile&) = delete;
  ~TemporaryFile();
  const Path& path() const { return path_; }
  /// Gives the file its final name, durably.
  void rename_to(const Path&);

 private:
  Path path_;
  bool mine_;
};

/// RawFile is a file of which every rank reads or writes its part by itself. HDF5 has made the file on one
/// rank and set the places aside (File::create); it does not know of the others, so that an error of one rank
/// is that rank's own. Every call is local and throws Error.
class RawFile {
 public:
  enum Use { to_read, to_write };
  RawFile(const Path&, Use);
  ~RawFile();
  RawFile(const RawFile&) = delete;

  std::vector<std::byte> read(std::uint64_t at, std::size_t bytes) const;
  void write(std::uint64_t at, const std::vector<std::byte>& values);
  /// Brings what was written to the disk itself, and closes.
  void close();

 private:
  Path path_;
  int file_;
};

}  // namespace silt::adapters::hdf5
