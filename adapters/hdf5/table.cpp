#include "adapters/hdf5/table.hpp"

namespace silt::adapters::hdf5 {

std::size_t Column::value_bytes() const {
  return type == int8 || type == uint8 ? 1 : type == int32 ? 4 : 8;
}

hid_t Column::memory_type() const {
  switch (type) {
    case uint64:
      return H5T_STD_U64LE;
    case int64:
      return H5T_STD_I64LE;
    case int32:
      return H5T_STD_I32LE;
    case int8:
      return H5T_STD_I8LE;
    case uint8:
      return H5T_STD_U8LE;
    case float64:
      return H5T_IEEE_F64LE;
  }
  throw std::logic_error("a column type without an HDF5 type");
}

void scatter_column(const Column& column, const std::vector<std::byte>& packed, void* rows,
                    std::size_t row_bytes) {
  const std::size_t width = column.bytes();
  auto* to = static_cast<std::byte*>(rows) + column.offset;
  for (std::size_t i = 0; i * width < packed.size(); ++i)
    std::memcpy(to + i * row_bytes, packed.data() + i * width, width);
}

namespace {

/// Selects the rows [first, first + n) of a dataset.
Handle rows_of(const File& file, hid_t dataset, hsize_t first, hsize_t n) {
  Handle space(H5Dget_space(dataset), H5Sclose, file.path(), "shape of a dataset");
  std::vector<hsize_t> count = file.shape(dataset);
  std::vector<hsize_t> start(count.size(), 0);
  start[0] = first;
  count[0] = n;
  file.check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
             "cannot select rows");
  return space;
}

Handle memory_of(const File& file, const Column& c, hsize_t n) {
  const hsize_t numbers = n * c.components;
  return {H5Screate_simple(1, &numbers, nullptr), H5Sclose, file.path(), "memory shape"};
}

}  // namespace

void write_rows(const File& file, hid_t dataset, const Column& c, hsize_t first, hsize_t n,
                const std::vector<std::byte>& values) {
  if (n == 0) return;
  const Handle space = rows_of(file, dataset, first, n), memory = memory_of(file, c, n);
  file.check(H5Dwrite(dataset, c.memory_type(), memory, space, H5P_DEFAULT, values.data()),
             std::string("cannot write ") + c.name + " (is the disk full?)");
}

std::vector<std::byte> read_rows(const File& file, hid_t dataset, const Column& c, hsize_t first, hsize_t n) {
  std::vector<std::byte> values(n * c.bytes());
  if (n == 0) return values;
  const Handle stored(H5Dget_type(dataset), H5Tclose, file.path(), std::string("type of ") + c.name);
  if (H5Tequal(stored, c.memory_type()) <= 0)
    throw Error(file.path().string() + ": " + c.name + " has another type than this version writes");
  const Handle space = rows_of(file, dataset, first, n), memory = memory_of(file, c, n);
  file.check(H5Dread(dataset, c.memory_type(), memory, space, H5P_DEFAULT, values.data()),
             std::string("cannot read ") + c.name + " (truncated?)");
  return values;
}

}  // namespace silt::adapters::hdf5
