#include "adapters/hdf5/table.hpp"

#include <cstring>

namespace silt::adapters::hdf5 {

std::size_t Column::bytes() const {
  const std::size_t one = type == int8 || type == uint8 ? 1 : type == int32 ? 4 : 8;
  return one * components;
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

std::vector<std::byte> gather_column(const Column& column, const void* rows, std::size_t row_bytes,
                                     std::size_t n) {
  const std::size_t width = column.bytes();
  std::vector<std::byte> packed(n * width);
  const auto* from = static_cast<const std::byte*>(rows) + column.offset;
  for (std::size_t i = 0; i < n; ++i) std::memcpy(packed.data() + i * width, from + i * row_bytes, width);
  return packed;
}

void scatter_column(const Column& column, const std::vector<std::byte>& packed, void* rows,
                    std::size_t row_bytes) {
  const std::size_t width = column.bytes();
  auto* to = static_cast<std::byte*>(rows) + column.offset;
  for (std::size_t i = 0; i * width < packed.size(); ++i)
    std::memcpy(to + i * row_bytes, packed.data() + i * width, width);
}

}  // namespace silt::adapters::hdf5
