#pragma once
// Private to adapters/hdf5: RAII handles, and HDF5's errors as exceptions with file, operation and reason.
#include <hdf5.h>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "adapters/hdf5/disk.hpp"
#include "adapters/hdf5/result_file.hpp"

namespace silt::adapters::hdf5 {

/// The system's file under an open HDF5 file, by an HDF5 file driver (H5FDpublic.h; output_file.cpp). HDF5 is
/// never told of write errors: it would leave an id that it closes again, and crashes, in MPI_Finalize.
/// Instead, calls that flush or close check `error`.
struct OutputFile {
  int file = -1;
  int error = 0;  // errno of the first failure, after which nothing is written

  ~OutputFile();
  /// Closes the file. Returns 0 or errno.
  int close();

  /// Returns the OutputFile of an open HDF5 file; it stays open while the pointer exists.
  static std::shared_ptr<OutputFile> of(hid_t file);
  /// Returns the driver, for H5Pset_driver.
  static hid_t driver();
};

/// Throws Error "FILE: WHAT: REASON" with the reason from HDF5's innermost message, and clears HDF5's stack.
[[noreturn]] void fail(const Path& file, const std::string& what);

/// Owns an HDF5 id and closes it.
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
  /// Closes the id. Returns whether it succeeded (a full disk may show only now).
  bool close() { return id_ < 0 || close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

enum class Format {
  classic,  // for any reader, without consistency flags: a file whose writer was killed opens as usual
  checked,  // object headers of HDF5 1.8: all metadata has checksums
};

using Shape = std::vector<hsize_t>;

/// Returns the shape of a table; with one column it has one axis.
inline Shape table_shape(hsize_t rows, hsize_t columns) {
  return columns > 1 ? Shape{rows, columns} : Shape{rows};
}

/// The layout of a dataset: contiguous, allocated at once and not filled (a new file reads as zeros), or
/// chunked. A dataset that grows along its first axis has a single chunk, also allocated at once.
struct Layout {
  Shape chunk = {};
  bool grows = false;
};

/// Rows of a virtual dataset and their source: a dataset in another file, whose path is relative to the
/// folder of this file, or in this file (".").
struct VirtualRows {
  hsize_t first, n;
  std::string file, dataset;
  Shape shape;  // of that dataset, with as many numbers
};

/// The position in its file of the values of a contiguous dataset.
struct Place {
  std::uint64_t at = 0;  // in bytes
  std::size_t value_bytes = 1;
  Shape shape;

  std::uint64_t values() const {
    std::uint64_t n = 1;
    for (const hsize_t along : shape) n *= along;
    return n;
  }
};

/// Returns the HDF5 type of a number in memory.
template <class T>
hid_t native_type() {
  if constexpr (std::is_floating_point_v<T>)
    return H5T_NATIVE_DOUBLE;
  else if constexpr (sizeof(T) == sizeof(std::int32_t))
    return std::is_signed_v<T> ? H5T_NATIVE_INT32 : H5T_NATIVE_UINT32;
  else
    return std::is_signed_v<T> ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT64;
}

/// Returns the HDF5 type of stored numbers, the same in file and memory.
hid_t type_of(Storage);

/// An open file. Every operation throws Error.
class File {
 public:
  static File create(const Path&, Format);
  static File open(const Path&, bool writable);

  const Path& path() const { return path_; }
  operator hid_t() const { return handle_; }
  void flush();
  /// Writes everything out and throws if that fails. The destructor closes silently.
  void close();
  void check(herr_t status, const std::string& what) const;
  [[noreturn]] void refuse(const std::string& what) const;

  bool exists(const std::string& name) const;
  Handle group(const std::string& name) const;
  Handle create_group(const std::string& name);
  Handle dataset(const std::string& name) const;
  /// Opens a dataset that grows; HDF5 caches nothing of it and writes rows directly.
  Handle dataset_to_append(const std::string& name) const;
  Handle create_dataset(const std::string& name, hid_t type, const Shape&, const Layout& = {});
  /// Creates and writes a contiguous dataset from a list of numbers or of arrays of numbers.
  template <class Row>
  Handle write_list(const std::string& name, hid_t type, const std::vector<Row>& rows) {
    if constexpr (std::is_arithmetic_v<Row>)
      return write_list(name, type, {rows.size()}, native_type<Row>(), rows.data());
    else
      return write_list(name, type, {rows.size(), std::tuple_size_v<Row>},
                        native_type<typename Row::value_type>(), rows.data());
  }
  /// Creates a dataset whose rows are those of others. Rows of a dataset that is not there read as zeros.
  Handle create_virtual(const std::string& name, hid_t type, const Shape&, const std::vector<VirtualRows>&);
  /// Gives an object a second name.
  void link(const std::string& name, const std::string& second);
  Shape shape(hid_t dataset) const;
  /// Returns the number of rows to which a dataset can grow.
  hsize_t room(hid_t dataset) const;
  Handle type(hid_t dataset) const;
  /// Returns the position of a contiguous dataset's values; 0 if it has none.
  std::uint64_t place_of(hid_t dataset) const;
  /// Returns the position of a dataset's values. Refuses a dataset of another layout than this version
  /// writes, or one that declares more bytes than the file has.
  Place place(const std::string& name) const;
  /// Also refuses a dataset of another type or shape.
  Place place(const std::string& name, hid_t type, const Shape&) const;

  void attribute(hid_t owner, const std::string& name, const std::string& value);
  void attribute(hid_t owner, const std::string& name, const std::vector<std::string>& values);
  /// Writes an attribute of any native type; an empty shape means a scalar.
  void attribute(hid_t owner, const std::string& name, hid_t type, const Shape&, const void* data);
  template <class T>
  void number(hid_t owner, const std::string& name, T value) {
    attribute(owner, name, native_type<T>(), {}, &value);
  }
  template <std::size_t n>
  void numbers(hid_t owner, const std::string& name, const std::array<double, n>& values) {
    attribute(owner, name, H5T_NATIVE_DOUBLE, {n}, values.data());
  }
  /// Overwrites a stored number.
  void overwrite(hid_t owner, const std::string& name, std::int64_t value);
  bool has_attribute(hid_t owner, const std::string& name) const;
  std::string text_in(hid_t owner, const std::string& name) const;
  template <class T>
  T number_in(hid_t owner, const std::string& name) const {
    T value{};
    read_number(owner, name, native_type<T>(), &value);
    return value;
  }

  void write_provenance(const Provenance&);
  /// Returns the stored text of the case, and its dataset.
  std::string case_text() const;
  Handle case_text_dataset() const { return dataset("/provenance/case_text"); }

 private:
  File(Path, Handle, bool writable);
  Handle write_list(const std::string& name, hid_t type, const Shape&, hid_t memory_type, const void* data);
  void read_number(hid_t owner, const std::string& name, hid_t type, void* value) const;
  Path path_;
  Handle handle_;
  std::shared_ptr<OutputFile> output_;  // of a writable file
};

/// Bytes that HDF5 may need whenever datasets, attributes or chunks are added.
inline constexpr std::uint64_t metadata_room = 1 << 17;

}  // namespace silt::adapters::hdf5
