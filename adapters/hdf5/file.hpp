#pragma once
// Private to adapters/hdf5: handles that close themselves, and HDF5's errors as exceptions that name the
// file, what was attempted and why it failed.
#include <hdf5.h>
#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "adapters/hdf5/provenance.hpp"

namespace silt::adapters::hdf5 {

using Path = std::filesystem::path;

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws Error "FILE: WHAT: REASON", the reason from HDF5's innermost message, and clears HDF5's stack.
[[noreturn]] void fail(const Path& file, const std::string& what);

/// Throws Error "FILE: WHAT: REASON", the reason from an error number of the system.
[[noreturn]] void fail_in_system(const Path& file, const std::string& what, int error);

/// Handle owns an HDF5 id and knows the call that closes it.
class Handle {
 public:
  Handle() = default;
  Handle(hid_t id, herr_t (*close)(hid_t), const Path& file, const std::string& what)
      : id_(id), close_(close) {
    if (id < 0) fail(file, what);
  }
  Handle(Handle&& o) noexcept : id_(std::exchange(o.id_, -1)), close_(o.close_) {}
  Handle& operator=(Handle&& o) noexcept {
    std::swap(id_, o.id_);
    std::swap(close_, o.close_);
    return *this;
  }
  ~Handle() { close(); }
  operator hid_t() const { return id_; }
  /// Closes the id and says whether that went well (closing a file can be what finds the disk full).
  bool close() { return id_ < 0 || close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

struct OutputFile;

enum class Format {
  classic,  // any reader, no consistency flags: a file whose writer was killed opens as usual
  checked,  // HDF5 1.8 object headers: every piece of metadata carries a checksum
};

/// File is an open file with the operations this folder needs, each of which throws Error.
class File {
 public:
  static File create(const Path&, Format);
  static File open(const Path&, bool writable);
  /// Opens a file whose changes come all at once with commit() or close(), or not at all: if anything fails,
  /// if neither is called, or if the process is killed (journal.hpp).
  static File open_journaled(const Path&);

  const Path& path() const { return path_; }
  operator hid_t() const { return handle_; }
  void flush();
  /// Writes out what has changed in a journaled file, which stays open.
  void commit();
  /// Writes out everything; throws where that fails. The destructor closes silently.
  void close();
  ~File();
  File(File&&) = default;
  void check(herr_t status, const std::string& what) const;

  bool exists(const std::string& name) const;
  Handle group(const std::string& name, bool create);
  Handle dataset(const std::string& name) const;
  /// Opens a dataset that grows by rows at its end: of its chunks, of so many bytes, HDF5 keeps the last two
  /// at hand and not, as it would by itself, the last megabyte.
  Handle dataset_to_append(const std::string& name, std::size_t chunk_bytes) const;
  /// Creates a contiguous dataset whose space is taken now and not filled (a fresh file reads as zeros where
  /// nothing is written).
  Handle create_contiguous(const std::string& name, hid_t type, const std::vector<hsize_t>& shape);
  /// Returns the byte of the file at which the values of a contiguous dataset begin; 0 for one without any.
  std::uint64_t place_of(hid_t dataset) const;
  /// Creates an empty dataset that grows along its first axis.
  Handle create_growing(const std::string& name, hid_t type, std::vector<hsize_t> shape_of_row,
                        hsize_t chunk_rows);
  std::vector<hsize_t> shape(hid_t dataset) const;

  void attribute(hid_t owner, const std::string& name, const std::string& value);
  void attribute(hid_t owner, const std::string& name, const std::vector<std::string>& values);
  void attribute(hid_t owner, const std::string& name, std::int64_t value);
  void attribute(hid_t owner, const std::string& name, std::uint64_t value);
  void attribute(hid_t owner, const std::string& name, double value);
  /// Writes an attribute of any native type; an empty shape is a scalar.
  void attribute(hid_t owner, const std::string& name, hid_t type, const std::vector<hsize_t>& shape,
                 const void* data);
  bool has_attribute(hid_t owner, const std::string& name) const;
  std::string string_attribute(hid_t owner, const std::string& name) const;
  std::int64_t int_attribute(hid_t owner, const std::string& name) const;
  std::uint64_t uint_attribute(hid_t owner, const std::string& name) const;
  double double_attribute(hid_t owner, const std::string& name) const;

  void write_provenance(const Provenance&);

 private:
  enum class Writing { none, own, journaled };
  File(Path, Handle, Writing);
  /// Writes nothing any more; HDF5 does not know.
  void abandon() const;
  template <class T>
  T scalar_attribute(hid_t owner, const std::string& name, hid_t type) const;
  Path path_;
  Handle handle_;
  Writing writing_;
  std::shared_ptr<OutputFile> output_;  // where it is written
};

/// Writes all of it at a place of an open file. Returns whether that went well; errno says why not.
bool write_all(int file, std::uint64_t at, std::size_t size, const char* from);

/// Takes disk space for a file up to `size` bytes, making it longer if need be (HDF5 cuts a longer file when
/// it closes it), so that a full disk is found before HDF5 is in the middle of something. Throws Error; the
/// file is then as long as before. Where the file system cannot reserve, it only looks whether there is room.
void reserve(const Path&, std::uint64_t size);

/// metadata_room is the number of bytes that HDF5 itself may need each time datasets, attributes or chunks
/// are added.
inline constexpr std::uint64_t metadata_room = 1 << 17;

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

/// Writes a file's content to the disk itself. Throws Error.
void sync_to_disk(const Path&);

}  // namespace silt::adapters::hdf5
