#include "adapters/hdf5/body_series.hpp"

#include <algorithm>
#include <cstddef>

#include "adapters/hdf5/table.hpp"
#include "adapters/hdf5/together.hpp"

namespace silt::adapters {
namespace {

using hdf5::Column;
using hdf5::File;
using hdf5::Handle;

constexpr hsize_t rows_a_chunk = 1024, times_a_chunk = 256;

/// Units by their parts: length, time, mass.
std::vector<Column> body_columns(const std::string& l, const std::string& t, const std::string& m) {
  return {{"id", offsetof(BodyRow, id), Column::uint64},
          {"kind", offsetof(BodyRow, kind), Column::int32},
          {"image", offsetof(BodyRow, image), Column::int32, 3, "periods"},
          {"position", offsetof(BodyRow, position), Column::float64, 3, l},
          {"orientation", offsetof(BodyRow, orientation), Column::float64, 4, "quaternion w, x, y, z"},
          {"velocity", offsetof(BodyRow, velocity), Column::float64, 3, l + "/" + t},
          {"angular_velocity", offsetof(BodyRow, angular_velocity), Column::float64, 3, "rad/" + t},
          {"force", offsetof(BodyRow, force), Column::float64, 3, m + " " + l + "/" + t + "^2"},
          {"torque", offsetof(BodyRow, torque), Column::float64, 3, m + " " + l + "^2/" + t + "^2"}};
}
std::vector<Column> body_columns() {
  return body_columns("", "", "");
}

struct TimeRow {
  double time;
  std::int64_t step;
  std::uint64_t offset, count;
};
std::vector<Column> time_columns(const std::string& unit) {
  return {{"offset", offsetof(TimeRow, offset), Column::uint64},
          {"count", offsetof(TimeRow, count), Column::uint64},
          {"step", offsetof(TimeRow, step), Column::int64},
          {"time", offsetof(TimeRow, time), Column::float64, 1, unit}};
}

/// Bytes that appending so many rows can add to the file: the chunks it begins.
std::uint64_t room_to_append(std::size_t rows) {
  const std::uint64_t chunks = rows / rows_a_chunk + 1;
  return chunks * rows_a_chunk * sizeof(BodyRow) + times_a_chunk * sizeof(TimeRow) + hdf5::metadata_room;
}

std::vector<hsize_t> row_shape(const Column& c) {
  return c.components > 1 ? std::vector<hsize_t>{static_cast<hsize_t>(c.components)} : std::vector<hsize_t>{};
}

void create_columns(File& file, const std::string& group, const std::vector<Column>& columns, hsize_t chunk) {
  for (const Column& c : columns) {
    const Handle data = file.create_growing(group + c.name, c.memory_type(), row_shape(c), chunk);
    if (!c.unit.empty()) file.attribute(data, "unit", c.unit);
  }
}

void resize(File& file, hid_t dataset, hsize_t rows) {
  auto shape = file.shape(dataset);
  if (shape[0] == rows) return;
  shape[0] = rows;
  file.check(H5Dset_extent(dataset, shape.data()), "cannot resize a dataset (is the disk full?)");
}

/// Rows [first, first + n) of a dataset.
Handle rows_of(const File& file, hid_t dataset, hsize_t first, hsize_t n) {
  Handle space(H5Dget_space(dataset), H5Sclose, file.path(), "shape of a dataset");
  std::vector<hsize_t> start(file.shape(dataset).size(), 0), count = file.shape(dataset);
  start[0] = first;
  count[0] = n;
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  return space;
}

void append_columns(File& file, const std::string& group, const std::vector<Column>& columns,
                    const void* rows, std::size_t row_bytes, hsize_t first, hsize_t n) {
  for (const Column& c : columns) {
    const Handle data = file.dataset(group + c.name);
    resize(file, data, first + n);
    if (n == 0) continue;
    const auto values = hdf5::gather_column(c, rows, row_bytes, n);
    const Handle space = rows_of(file, data, first, n);
    const hsize_t numbers = n * c.components;
    const Handle memory(H5Screate_simple(1, &numbers, nullptr), H5Sclose, file.path(), "memory shape");
    file.check(H5Dwrite(data, c.memory_type(), memory, space, H5P_DEFAULT, values.data()),
               "cannot append (is the disk full?)");
  }
}

void create_series(const hdf5::Path& path, const BodySeriesInfo& info, const Provenance& provenance) {
  hdf5::TemporaryFile part(path.string() + ".part", true);
  hdf5::reserve(part.path(), provenance.case_text.size() + mesh_bytes(info.kinds) + hdf5::metadata_room);
  File file = File::create(part.path(), hdf5::Format::classic);
  const Handle root = file.group("/", false);
  file.attribute(root, "format", std::string("silt bodies"));
  file.attribute(root, "format_version", std::int64_t{2});
  file.attribute(root, "length_unit", info.length);
  file.attribute(root, "time_unit", info.time);
  file.attribute(root, "domain_lower", H5T_NATIVE_DOUBLE, {3}, info.domain_lower.data());
  file.attribute(root, "domain_upper", H5T_NATIVE_DOUBLE, {3}, info.domain_upper.data());
  file.group("/bodies", true);
  create_columns(file, "/", time_columns(info.time), times_a_chunk);
  create_columns(file, "/bodies/", body_columns(info.length, info.time, info.mass), rows_a_chunk);
  for (const char* load : {"force", "torque"})
    file.attribute(
        file.dataset(std::string("/bodies/") + load), "meaning",
        std::string("what the fluid gave the body in the step, and what a program added; without gravity "
                    "and without the fluid's hydrostatic pressure"));
  write_kinds(file, info.kinds, info.length, info.mass + "/" + info.length + "^3");
  file.write_provenance(provenance);
  file.close();
  part.rename_to(path);
}

/// The whole times of a file whose last append may have been cut off: rows of every column are there.
std::vector<TimeRow> whole_times(const File& file) {
  hsize_t times = ~hsize_t{0}, rows = ~hsize_t{0};
  for (const Column& c : time_columns("")) times = std::min(times, file.shape(file.dataset(c.name))[0]);
  for (const Column& c : body_columns())
    rows = std::min(rows, file.shape(file.dataset(std::string("/bodies/") + c.name))[0]);
  std::vector<TimeRow> table(times);
  for (const Column& c : time_columns("")) {
    if (times == 0) break;
    const Handle data = file.dataset(c.name);
    std::vector<std::byte> values(times * c.bytes());
    const Handle space = rows_of(file, data, 0, times);
    const Handle memory(H5Screate_simple(1, &times, nullptr), H5Sclose, file.path(), "memory shape");
    file.check(H5Dread(data, c.memory_type(), memory, space, H5P_DEFAULT, values.data()),
               "cannot read the times");
    hdf5::scatter_column(c, values, table.data(), sizeof(TimeRow));
  }
  std::size_t whole = 0;
  std::uint64_t next = 0;
  while (whole < table.size() && table[whole].offset == next &&
         table[whole].offset + table[whole].count <= rows &&
         (whole == 0 || table[whole].step > table[whole - 1].step))
    next += table[whole++].count;
  table.resize(whole);
  return table;
}

}  // namespace

BodySeries BodySeries::create(MPI_Comm comm, const std::filesystem::path& path, const BodySeriesInfo& info,
                              const Provenance& provenance) {
  on_rank_0(comm, [&] { create_series(path, info, provenance); });
  return BodySeries(comm, path);
}

BodySeries BodySeries::open_for_append(MPI_Comm comm, const std::filesystem::path& path, std::int64_t step) {
  BodySeries series(comm, path);
  on_rank_0(comm, [&] {
    File file = File::open(path, true);
    auto table = whole_times(file);
    while (!table.empty() && table.back().step > step) table.pop_back();
    series.times_ = table.size();
    if (!table.empty()) {
      series.rows_ = table.back().offset + table.back().count;
      series.last_step_ = table.back().step;
    }
    for (const Column& c : time_columns("")) resize(file, file.dataset(c.name), series.times_);
    for (const Column& c : body_columns())
      resize(file, file.dataset(std::string("/bodies/") + c.name), series.rows_);
    file.close();
  });
  return series;
}

void BodySeries::append(std::int64_t step, double time, std::span<const BodyRow> mine) {
  std::vector<BodyRow> rows = hdf5::gather_rows(comm_, mine);
  on_rank_0(comm_, [&] {
    if (step <= last_step_)
      throw hdf5::Error(path_.string() + ": step " + std::to_string(step) + " does not come after step " +
                        std::to_string(last_step_));
    std::sort(rows.begin(), rows.end(), [](const BodyRow& a, const BodyRow& b) { return a.id < b.id; });
    const auto twice = std::adjacent_find(rows.begin(), rows.end(),
                                          [](const BodyRow& a, const BodyRow& b) { return a.id == b.id; });
    if (twice != rows.end())
      throw hdf5::Error(path_.string() + ": body " + std::to_string(twice->id) + " has two owners in step " +
                        std::to_string(step));
    hdf5::reserve(path_, std::filesystem::file_size(path_) + room_to_append(rows.size()));
    File file = File::open(path_, true);
    // Rows first and on their way to the file, then the time that makes them count.
    append_columns(file, "/bodies/", body_columns(), rows.data(), sizeof(BodyRow), rows_, rows.size());
    file.flush();
    const TimeRow now{time, step, rows_, rows.size()};
    append_columns(file, "/", time_columns(""), &now, sizeof now, times_, 1);
    file.close();
    ++times_;
    rows_ += rows.size();
    last_step_ = step;
  });
}

}  // namespace silt::adapters
