#pragma once
// Private to adapters/hdf5: tables of plain structs, one dataset ("column") for each member.
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

/// A column: dataset name, offset and type of the member in memory, numbers per row, unit, meaning.
struct Column {
  std::string name;
  std::size_t offset;
  enum Type { uint64, int64, int32, int8, uint8, float64 } type;
  int components = 1;
  std::string unit = "", meaning = "";

  std::size_t value_bytes() const { return type == int8 || type == uint8 ? 1 : type == int32 ? 4 : 8; }
  std::size_t bytes() const { return value_bytes() * components; }  // per row
  /// Returns the type, the same in memory and in the little-endian file.
  hid_t stored_type() const {
    const hid_t types[] = {H5T_STD_U64LE, H5T_STD_I64LE, H5T_STD_I32LE,
                           H5T_STD_I8LE,  H5T_STD_U8LE,  H5T_IEEE_F64LE};
    return types[type];
  }
};

template <class Row, class Part, class Member>
std::size_t offset_of(Member Part::*member) {
  const Row row{};
  return std::size_t(reinterpret_cast<const std::byte*>(&(row.*member)) -
                     reinterpret_cast<const std::byte*>(&row));
}

/// Returns the column of a member of Row or its bases: a number or an array of numbers.
template <class Row, class Part, class Member>
Column column_of(std::string name, Member Part::*member, std::string unit = "", std::string meaning = "") {
  constexpr auto first = [](const Member& x) {
    if constexpr (requires { x[0]; })
      return x[0];
    else
      return x;
  };
  using Number = decltype(first(std::declval<Member>()));
  constexpr bool is_signed = std::is_signed_v<Number>, is_real = std::is_floating_point_v<Number>;
  constexpr Column::Type type = is_real               ? Column::float64
                                : sizeof(Number) == 1 ? (is_signed ? Column::int8 : Column::uint8)
                                : sizeof(Number) == 4 ? Column::int32
                                : is_signed           ? Column::int64
                                                      : Column::uint64;
  return {name, offset_of<Row>(member), type, int(sizeof(Member) / sizeof(Number)), unit, meaning};
}

/// Appends the column's values of n rows; row(i) returns the i-th.
template <class Row, class MakeRow>
void gather_column(const Column& column, std::size_t n, MakeRow&& row, std::vector<std::byte>& values) {
  static_assert(std::is_trivially_copyable_v<Row>);
  const std::size_t width = column.bytes(), before = values.size();
  values.resize(before + n * width);
  for (std::size_t i = 0; i < n; ++i) {
    const Row r = row(i);
    std::memcpy(values.data() + before + i * width, reinterpret_cast<const std::byte*>(&r) + column.offset,
                width);
  }
}

/// The inverse of gather_column: copies the values into rows.
template <class Row>
void scatter_column(const Column& column, const std::vector<std::byte>& values, std::vector<Row>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    std::memcpy(reinterpret_cast<std::byte*>(&rows[i]) + column.offset, values.data() + i * column.bytes(),
                column.bytes());
}

/// Calls transfer(memory, space) for the rows [first, first + n) of a column's dataset, if there are any.
template <class Transfer>
void for_rows(const File& file, hid_t dataset, const Column& c, hsize_t first, hsize_t n,
              Transfer&& transfer) {
  if (n == 0) return;
  const hsize_t numbers = n * c.components;
  const Handle space(H5Dget_space(dataset), H5Sclose, file.path(), "shape of a dataset");
  const Handle memory(H5Screate_simple(1, &numbers, nullptr), H5Sclose, file.path(), "memory shape");
  Shape start(file.shape(dataset).size(), 0), count = table_shape(n, c.components);
  start[0] = first;
  file.check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
             "cannot select rows");
  transfer(memory, space);
}

inline void write_rows(const File& file, hid_t dataset, const Column& c, hsize_t first,
                       std::span<const std::byte> values) {
  for_rows(file, dataset, c, first, values.size() / c.bytes(), [&](hid_t memory, hid_t space) {
    file.check(H5Dwrite(dataset, c.stored_type(), memory, space, H5P_DEFAULT, values.data()),
               "cannot write " + c.name + " (is the disk full?)");
  });
}

/// Creates columns of `rows` rows that may grow to `room` rows. Their space is allocated now, so that growing
/// changes only the number of rows in each header.
inline void create_columns(File& file, const std::string& group, const std::vector<Column>& columns,
                           hsize_t rows, hsize_t room) {
  for (const Column& c : columns) {
    const Handle data =
        file.create_dataset(group + c.name, c.stored_type(), hdf5::table_shape(rows, c.components),
                            {hdf5::table_shape(room, c.components), true});
    if (!c.unit.empty()) file.attribute(data, "unit", c.unit);
    if (!c.meaning.empty()) file.attribute(data, "meaning", c.meaning);
  }
}

inline void resize(File& file, hid_t dataset, hsize_t rows) {
  auto shape = file.shape(dataset);
  if (shape[0] == rows) return;
  shape[0] = rows;
  file.check(H5Dset_extent(dataset, shape.data()), "cannot resize a dataset (is the disk full?)");
}

}  // namespace silt::adapters::hdf5
