#pragma once
// Files without HDF5: disk space, synchronisation, temporary names, files accessed in parts, system messages.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace silt::adapters {

/// Adds the limit in question to the system's message for a file that is too large.
std::string with_limit(std::string reason);

/// Returns the system's message for an error number.
std::string system_reason(int error);

}  // namespace silt::adapters

namespace silt::adapters::hdf5 {

using Path = std::filesystem::path;

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws Error "FILE: WHAT: REASON" with the reason of an error number.
[[noreturn]] void fail_in_system(const Path& file, const std::string& what, int error);

/// Read or write bytes at a position of an open file; reading past its end gives zeros. Return whether they
/// succeeded, else errno has the reason.
bool read_all(int file, std::uint64_t at, std::size_t size, char* to);
bool write_all(int file, std::uint64_t at, std::size_t size, const char* from);

/// Allocates disk space for a file up to `size` bytes and extends the file (HDF5 truncates it when it
/// closes), so that a full disk is detected before HDF5 is in the middle of an operation. Throws Error, with
/// the file's length unchanged. If the file system cannot allocate, only the free space is checked.
void reserve(const Path&, std::uint64_t size);

/// Synchronises a file with the disk. Throws Error.
void sync_to_disk(const Path&);

/// A file that rank 0 removes in the destructor unless it was renamed.
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

/// A file of which every rank reads or writes its own part. HDF5 has created it on one rank, with space for
/// all values (File::create). Calls are local and throw Error.
class RawFile {
 public:
  enum Use { to_read, to_write };
  RawFile(const Path&, Use);
  ~RawFile();
  RawFile(const RawFile&) = delete;

  std::vector<std::byte> read(std::uint64_t at, std::size_t bytes) const;
  void write(std::uint64_t at, const std::vector<std::byte>& values);
  /// Synchronises with the disk and closes.
  void close();

 private:
  Path path_;
  int file_;
};

}  // namespace silt::adapters::hdf5
