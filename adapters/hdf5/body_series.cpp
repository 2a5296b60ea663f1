#include "adapters/hdf5/body_series.hpp"

#include <algorithm>
#include <cstddef>

#include "adapters/hdf5/order_by_id.hpp"
#include "adapters/hdf5/table.hpp"
#include "parallel/together.hpp"

namespace silt::adapters {
namespace {

using hdf5::Column;
using hdf5::File;
using hdf5::Handle;

constexpr hsize_t rows_a_chunk = 1024, times_a_chunk = 256;

/// Returns the columns of BodyRow with units made of those of length, time and mass.
std::vector<Column> body_columns(BodyColumns with, const std::string& l, const std::string& t,
                                 const std::string& m) {
  const std::string force = m + " " + l + "/" + t + "^2", torque = m + " " + l + "^2/" + t + "^2";
  std::vector<Column> columns = {
      {"id", offsetof(BodyRow, id), Column::uint64},
      {"kind", offsetof(BodyRow, kind), Column::int32},
      {"image", offsetof(BodyRow, image), Column::int32, 3, "periods"},
      {"position", offsetof(BodyRow, position), Column::float64, 3, l},
      {"orientation", offsetof(BodyRow, orientation), Column::float64, 4, "quaternion w, x, y, z"},
      {"velocity", offsetof(BodyRow, velocity), Column::float64, 3, l + "/" + t},
      {"angular_velocity", offsetof(BodyRow, angular_velocity), Column::float64, 3, "rad/" + t},
      {"force", offsetof(BodyRow, force), Column::float64, 3, force},
      {"torque", offsetof(BodyRow, torque), Column::float64, 3, torque},
      {"mass", offsetof(BodyRow, mass), Column::float64, 1, m}};
  if (with.buoyancy) columns.push_back({"buoyancy", offsetof(BodyRow, buoyancy), Column::float64, 3, force});
  if (with.contacts) {
    columns.push_back({"contact_force", offsetof(BodyRow, contact_force), Column::float64, 3, force});
    columns.push_back({"contact_torque", offsetof(BodyRow, contact_torque), Column::float64, 3, torque});
  }
  return columns;
}
std::vector<Column> body_columns(BodyColumns with) {
  return body_columns(with, "", "", "");
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

/// Returns how many bytes appending so many rows can add to the file: those of the chunks it begins.
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

void write_meanings(File& file, BodyColumns with) {
  const auto say = [&](std::initializer_list<const char*> columns, const std::string& meaning) {
    for (const char* c : columns)
      file.attribute(file.dataset(std::string("/bodies/") + c), "meaning", meaning);
  };
  say({"force", "torque"},
      "what the fluid gave the body in the step, and what a program added; without gravity and without the "
      "fluid's hydrostatic pressure");
  if (with.buoyancy)
    say({"buoyancy"}, "of the fluid's hydrostatic pressure: the weight of the fluid displaced, upwards");
  if (with.contacts)
    say({"contact_force", "contact_torque"},
        "of contacts and lubrication films in the step; nan of bodies that are not free");
}

void create_series(const hdf5::Path& path, const BodySeriesInfo& info, const Provenance& provenance) {
  hdf5::TemporaryFile part(path.string() + ".part", true);
  hdf5::reserve(part.path(), provenance.case_text.size() + mesh_bytes(info.kinds) + hdf5::metadata_room);
  File file = File::create(part.path(), hdf5::Format::classic);
  const Handle root = file.group("/", false);
  file.attribute(root, "format", std::string("silt bodies"));
  file.attribute(root, "format_version", std::int64_t{3});
  file.attribute(root, "length_unit", info.length);
  file.attribute(root, "time_unit", info.time);
  file.attribute(root, "domain_lower", H5T_NATIVE_DOUBLE, {3}, info.domain_lower.data());
  file.attribute(root, "domain_upper", H5T_NATIVE_DOUBLE, {3}, info.domain_upper.data());
  file.group("/bodies", true);
  create_columns(file, "/", time_columns(info.time), times_a_chunk);
  create_columns(file, "/bodies/", body_columns(info.columns, info.length, info.time, info.mass),
                 rows_a_chunk);
  write_meanings(file, info.columns);
  write_kinds(file, info.kinds, info.length, info.mass + "/" + info.length + "^3");
  file.write_provenance(provenance);
  file.close();
  part.rename_to(path);
}

/// Returns the whole times of a file whose last append may have been cut off: those with rows in every
/// column.
std::vector<TimeRow> whole_times(const File& file, BodyColumns with) {
  hsize_t times = ~hsize_t{0}, rows = ~hsize_t{0};
  for (const Column& c : time_columns("")) times = std::min(times, file.shape(file.dataset(c.name))[0]);
  for (const Column& c : body_columns(with))
    rows = std::min(rows, file.shape(file.dataset(std::string("/bodies/") + c.name))[0]);
  std::vector<TimeRow> table(times);
  for (const Column& c : time_columns("")) {
    if (times == 0) break;
    const Handle data = file.dataset(c.name);
    hdf5::scatter_column(c, hdf5::read_rows(file, data, c, 0, times), table.data(), sizeof(TimeRow));
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

void require_columns(const File& file, const hdf5::Path& path, BodyColumns with) {
  const std::pair<const char*, bool> sometimes[] = {{"buoyancy", with.buoyancy},
                                                    {"contact_force", with.contacts}};
  const auto there = [&](const char* name) { return file.exists(std::string("/bodies/") + name); };
  for (const auto& [name, wanted] : sometimes)
    if (there(name) != wanted || !there("mass"))
      throw hdf5::Error(path.string() + ": its columns are not those of this run (" +
                        (there("mass") ? name : "mass") + "); go on with output.bodies.contacts as the run " +
                        "began with, or move the file away: a new one is then begun");
}

}  // namespace

/// The file and its columns, which HDF5 keeps at hand from one append to the next.
struct BodySeries::Open {
  File file;
  std::vector<Handle> bodies, times;

  Open(const hdf5::Path& path, BodyColumns with) : file(File::open_journaled(path)) {
    for (const Column& c : body_columns(with))
      bodies.push_back(file.dataset_to_append(std::string("/bodies/") + c.name, rows_a_chunk * c.bytes()));
    for (const Column& c : time_columns(""))
      times.push_back(file.dataset_to_append(std::string("/") + c.name, times_a_chunk * c.bytes()));
  }
  void append_time(const TimeRow& now, hsize_t at) {
    const auto columns = time_columns("");
    for (std::size_t k = 0; k < columns.size(); ++k) {
      resize(file, times[k], at + 1);
      hdf5::write_rows(file, times[k], columns[k], at, 1,
                       hdf5::gather_column<TimeRow>(columns[k], 1, [&](auto) { return now; }));
    }
  }
};

BodySeries BodySeries::create(MPI_Comm comm, const std::filesystem::path& path, const BodySeriesInfo& info,
                              const Provenance& provenance) {
  parallel::on_rank_0(comm, [&] { create_series(path, info, provenance); });
  return BodySeries(comm, path, info.columns);
}

BodySeries BodySeries::open_for_append(MPI_Comm comm, const std::filesystem::path& path, std::int64_t step,
                                       BodyColumns with) {
  BodySeries series(comm, path, with);
  parallel::on_rank_0(comm, [&] {
    File file = File::open_journaled(path);
    require_columns(file, path, with);
    auto table = whole_times(file, with);
    while (!table.empty() && table.back().step > step) table.pop_back();
    series.times_ = table.size();
    if (!table.empty()) {
      series.rows_ = table.back().offset + table.back().count;
      series.last_step_ = table.back().step;
    }
    for (const Column& c : time_columns("")) resize(file, file.dataset(c.name), series.times_);
    for (const Column& c : body_columns(with))
      resize(file, file.dataset(std::string("/bodies/") + c.name), series.rows_);
    file.close();
  });
  return series;
}

void BodySeries::append(std::int64_t step, double time, std::size_t n,
                        const std::function<BodyRow(std::size_t)>& row) {
  std::vector<std::uint64_t> ids;
  parallel::together(comm_, [&] {
    if (parallel::rank_of(comm_) == 0 && step <= last_step_)
      throw hdf5::Error(path_.string() + ": step " + std::to_string(step) + " does not come after step " +
                        std::to_string(last_step_));
    for (std::size_t i = 0; i < n; ++i) ids.push_back(row(i).id);
  });
  const hdf5::IdOrder order = hdf5::order_by_id(comm_, ids);
  if (order.twice)
    throw hdf5::Error(path_.string() + ": body " + std::to_string(*order.twice) + " has two owners in step " +
                      std::to_string(step));
  const hdf5::SliceExchange slices(comm_, order.total, order.places);
  std::shared_ptr<Open> open = std::move(open_);  // kept if all goes well
  parallel::on_rank_0(comm_, [&] {
    if (!open) open.reset(new Open(path_, with_));
    hdf5::reserve(path_, std::filesystem::file_size(path_) + room_to_append(order.total));
  });
  const auto columns = body_columns(with_);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Column& c = columns[k];
    parallel::on_rank_0(comm_, [&] { resize(open->file, open->bodies[k], rows_ + order.total); });
    std::vector<std::byte> mine;
    parallel::together(comm_, [&] {
      mine = hdf5::gather_column<BodyRow>(c, n, [&](std::size_t r) { return row(order.rows[r]); });
    });
    slices.hand_to_rank_0(c.bytes(), slices.to_slice(c.bytes(), std::move(mine)),
                          [&](std::uint64_t first, std::uint64_t count, const auto& values) {
                            hdf5::write_rows(open->file, open->bodies[k], c, rows_ + first, count, values);
                          });
  }
  parallel::on_rank_0(comm_, [&] {
    open->append_time({time, step, rows_, order.total}, times_);
    open->file.commit();
    open_ = open;
    ++times_;
    rows_ += order.total;
    last_step_ = step;
  });
}

}  // namespace silt::adapters
