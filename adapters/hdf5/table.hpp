#pragma once
// Private to adapters/hdf5: rows of a plain struct as one dataset a member ("columns").
#include <cstring>
#include <type_traits>
#include <vector>

#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

/// Column describes a member of a row: dataset name, offset and type in memory, numbers a row, unit.
struct Column {
  const char* name;
  std::size_t offset;
  enum Type { uint64, int64, int32, int8, uint8, float64 } type;
  int components = 1;
  std::string unit = "";

  std::size_t value_bytes() const;
  std::size_t bytes() const { return value_bytes() * components; }  // a row's
  hid_t memory_type() const;  // little-endian in the file alike: bits are kept
};

/// Returns the column's values of n rows, one after the other; row(i) makes the i-th.
template <class Row, class MakeRow>
std::vector<std::byte> gather_column(const Column& column, std::size_t n, MakeRow&& row) {
  static_assert(std::is_trivially_copyable_v<Row>);
  const std::size_t width = column.bytes();
  std::vector<std::byte> packed(n * width);
  for (std::size_t i = 0; i < n; ++i) {
    const Row r = row(i);
    std::memcpy(packed.data() + i * width, reinterpret_cast<const std::byte*>(&r) + column.offset, width);
  }
  return packed;
}

/// Reverses gather_column: puts the values into rows.
void scatter_column(const Column&, const std::vector<std::byte>&, void* rows, std::size_t row_bytes);

/// Writes the rows [first, first + n) of a column into its dataset; throws Error.
void write_rows(const File&, hid_t dataset, const Column&, hsize_t first, hsize_t n,
                const std::vector<std::byte>& values);
/// Reads them; throws Error, also where the dataset is of another type.
std::vector<std::byte> read_rows(const File&, hid_t dataset, const Column&, hsize_t first, hsize_t n);

}  // namespace silt::adapters::hdf5
