#include "adapters/hdf5/body_series.hpp"

#include <algorithm>
#include <cstddef>

#include "adapters/hdf5/over_time.hpp"
#include "adapters/hdf5/slice_exchange.hpp"
#include "parallel/together.hpp"

namespace silt::adapters {

namespace {

using hdf5::Column;
using hdf5::File;
using hdf5::Handle;
using hdf5::TimeRow;

// Bounds of a file's rows: 16 times those of its first time, or twice those of the file before.
constexpr hsize_t least_rows = 1 << 12, most_rows = 1 << 20;

/// Returns the columns of BodyRow in /bodies.
std::vector<Column> body_columns(const BodySeriesInfo& info) {
  std::vector<Column> columns;
  const auto add = [&](const char* name, auto member, const std::string& unit = "",
                       const std::string& meaning = "") {
    columns.push_back(hdf5::column_of<BodyRow>(name, member, unit, meaning));
  };
  const auto add_wrench = [&](const std::string& prefix, Wrench BodyRow::*of, const std::string& meaning) {
    for (const auto& [name, part, unit] :
         {std::tuple{"force", &Wrench::force, info.force}, {"torque", &Wrench::torque, info.torque}}) {
      columns.push_back(hdf5::column_of<Wrench>(prefix + name, part, unit, meaning));
      columns.back().offset += hdf5::offset_of<BodyRow>(of);
    }
  };
  add("id", &BodyRow::id);
  add("kind", &BodyRow::kind);
  add("image", &BodyRow::image, "periods");
  add("position", &BodyRow::position, info.length);
  add("orientation", &BodyRow::orientation, "quaternion w, x, y, z");
  add("velocity", &BodyRow::velocity, info.length + "/" + info.time);
  add("angular_velocity", &BodyRow::angular_velocity, "rad/" + info.time);
  add_wrench("", &BodyRow::load,
             "what the fluid gave the body in the step, and what a program added; without gravity and "
             "without the fluid's hydrostatic pressure");
  add("mass", &BodyRow::mass, info.mass);
  if (info.columns.buoyancy)
    add("buoyancy", &BodyRow::buoyancy, info.force,
        "of the fluid's hydrostatic pressure: the weight of the fluid displaced, upwards");
  if (info.columns.scale)
    add("scale", &BodyRow::scale, "1", "lengths of the body over those of the surface of its kind");
  if (info.columns.springs) add_wrench("spring_", &BodyRow::springs, "of springs and dampers in the step");
  if (info.columns.contacts)
    add_wrench("contact_", &BodyRow::contacts,
               "of contacts and lubrication films in the step; nan of bodies that are not free");
  return columns;
}

std::vector<Column> time_columns(const std::string& unit) {
  return {hdf5::column_of<TimeRow>("offset", &TimeRow::offset),
          hdf5::column_of<TimeRow>("count", &TimeRow::count),
          hdf5::column_of<TimeRow>("step", &TimeRow::step),
          hdf5::column_of<TimeRow>("time", &TimeRow::time, unit)};
}

// ---- the kinds ----

/// The surfaces of all parts, one after the other.
struct Surfaces : TriangleMesh {
  std::vector<std::int32_t> part_kind;
  std::vector<std::int64_t> vertex_offset{0}, normal_offset{0}, triangle_offset{0};

  void add(std::size_t kind, const TriangleMesh& part) {
    const auto append = [](auto& all, const auto& more, std::vector<std::int64_t>& offset) {
      all.insert(all.end(), more.begin(), more.end());
      offset.push_back(std::int64_t(all.size()));
    };
    part_kind.push_back(std::int32_t(kind));
    append(vertices, part.vertices, vertex_offset);
    append(normals, part.normals, normal_offset);
    append(triangles, part.triangles, triangle_offset);
    triangle_normals.insert(triangle_normals.end(), part.triangle_normals.begin(),
                            part.triangle_normals.end());
  }
};

/// Lengths and directions have single precision, since they serve pictures only.
void write_kinds(File& file, const BodySeriesInfo& info) {
  const Handle group = file.create_group("/kinds"), bodies = file.group("/bodies");
  std::vector<std::string> names;
  std::vector<double> radii, densities;
  Surfaces all;
  for (const BodyKind& kind : info.kinds) {
    for (const TriangleMesh& part : kind.parts) all.add(names.size(), part);
    names.push_back(kind.name);
    radii.push_back(kind.bounding_radius);
    densities.push_back(kind.density);
  }
  if (!names.empty())
    for (const Handle* owner : {&group, &bodies}) file.attribute(*owner, "kind_names", names);
  const auto write = [&](const char* name, hid_t type, const auto& list, const std::string& unit,
                         const std::string& meaning) {
    const Handle data = file.write_list(std::string("/kinds/") + name, type, list);
    if (!unit.empty()) file.attribute(data, "unit", unit);
    file.attribute(data, "meaning", meaning);
  };
  write("bounding_radius", H5T_IEEE_F64LE, radii, info.length,
        "largest distance of a point of the body from its centre of mass");
  write("density", H5T_IEEE_F64LE, densities, info.density, "mass over volume");
  write("part_kind", H5T_STD_I32LE, all.part_kind, "", "kind that each convex part belongs to");
  write("vertex", H5T_IEEE_F32LE, all.vertices, info.length,
        "vertices of the parts' surfaces in the frame of the body, origin at its centre of mass");
  write("normal", H5T_IEEE_F32LE, all.normals, "1",
        "outward unit normals of the surfaces, in the frame of the body");
  write("triangle", H5T_STD_I32LE, all.triangles, "",
        "vertices of each triangle, counted from the part's first, counter-clockwise seen from outside");
  write("triangle_normal", H5T_STD_I32LE, all.triangle_normals, "",
        "normals at the corners of each triangle, counted from the part's first");
  write("vertex_offset", H5T_STD_I64LE, all.vertex_offset, "",
        "part p has the vertices vertex_offset[p] to vertex_offset[p + 1] - 1");
  write("normal_offset", H5T_STD_I64LE, all.normal_offset, "",
        "part p has the normals normal_offset[p] to normal_offset[p + 1] - 1");
  write("triangle_offset", H5T_STD_I64LE, all.triangle_offset, "",
        "part p has the triangles triangle_offset[p] to triangle_offset[p + 1] - 1");
}

// ---- the files ----

/// Creates a file with room for these rows and times; columns have the first time's length, but no values.
void create_file(const hdf5::Path& path, const BodySeriesInfo& info, const Provenance* provenance,
                 hsize_t rows, hsize_t row_room, hsize_t time_room) {
  hdf5::reserve(path, hdf5::metadata_room);
  File file = File::create(path, hdf5::Format::classic);
  const Handle root = file.group("/");
  file.attribute(root, "format", std::string("silt bodies"));
  file.number(root, "format_version", std::int64_t{4});
  file.attribute(root, "length_unit", info.length);
  file.attribute(root, "time_unit", info.time);
  file.numbers(root, "domain_lower", info.domain_lower);
  file.numbers(root, "domain_upper", info.domain_upper);
  file.create_group("/bodies");
  hdf5::create_columns(file, "/", time_columns(info.time), 1, time_room);
  hdf5::create_columns(file, "/bodies/", body_columns(info), rows, row_room);
  if (provenance) {
    write_kinds(file, info);
    file.write_provenance(*provenance);
  }
  file.close();
}

void require_columns(const File& file, BodyColumns with) {
  const auto there = [&](const char* name) { return file.exists(std::string("/bodies/") + name); };
  for (const auto& [name, wanted] : {std::pair{"mass", true},
                                     {"buoyancy", with.buoyancy},
                                     {"contact_force", with.contacts},
                                     {"spring_force", with.springs},
                                     {"scale", with.scale}})
    if (there(name) != wanted)
      file.refuse(std::string("its columns are not those of this run (") + name +
                  "); go on with output.bodies.contacts as the run began with, or move the files of the "
                  "series away: a new one is then begun");
}

}  // namespace

std::vector<std::filesystem::path> body_series_files(const std::filesystem::path& first) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::exists(first)) files.push_back(first);
  auto later = step_files(first.parent_path(), first.stem().string(), first.extension().string());
  for (auto file = later.rbegin(); file != later.rend(); ++file) files.push_back(file->path);
  return files;
}

/// The current file and its columns, which HDF5 keeps open between two appends.
struct BodySeries::Open {
  File file;
  std::vector<Column> of_bodies, of_times;
  std::vector<Handle> bodies, times;
  std::size_t n_times = 0, n_rows = 0;  // complete ones
  std::int64_t last_step = -1;
  hdf5::Path name;                            // of the file in the end
  std::unique_ptr<hdf5::TemporaryFile> part;  // until its first time is whole

  Open(const hdf5::Path& path, const BodySeriesInfo& info)
      : file(File::open(path, true)),
        of_bodies(body_columns(info)),
        of_times(time_columns(info.time)),
        name(path) {
    require_columns(file, info.columns);
    for (const Column& c : of_bodies) bodies.push_back(file.dataset_to_append("/bodies/" + c.name));
    for (const Column& c : of_times) times.push_back(file.dataset_to_append("/" + c.name));
  }
  /// A file that never got rows has no space for any.
  bool has_room(hsize_t more) const {
    return n_times < file.room(times[0]) &&
           (more == 0 || (n_rows > 0 && n_rows + more <= file.room(bodies[0])));
  }
  void cut_after(std::int64_t step);
  void append(double time, std::int64_t step, std::uint64_t rows);

  std::vector<TimeRow> whole_times() const;
};

/// Reads the complete times; an interrupted append leaves columns of different lengths.
std::vector<TimeRow> BodySeries::Open::whole_times() const {
  hsize_t n = ~hsize_t{0}, rows = ~hsize_t{0};
  for (const Handle& data : times) n = std::min(n, file.shape(data)[0]);
  for (const Handle& data : bodies) rows = std::min(rows, file.shape(data)[0]);
  std::vector<TimeRow> table(n);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const Column& c = of_times[k];
    std::vector<std::byte> values(n * c.bytes());
    if (H5Tequal(file.type(times[k]), c.stored_type()) <= 0)
      file.refuse(c.name + " has another type than this version writes");
    for_rows(file, times[k], c, 0, n, [&](hid_t memory, hid_t space) {
      file.check(H5Dread(times[k], c.stored_type(), memory, space, H5P_DEFAULT, values.data()),
                 "cannot read " + c.name + " (truncated?)");
    });
    hdf5::scatter_column(c, values, table);
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

void BodySeries::Open::cut_after(std::int64_t step) {
  std::vector<TimeRow> table = whole_times();
  while (!table.empty() && table.back().step > step) table.pop_back();
  if (table.empty()) return;
  n_times = table.size();
  n_rows = table.back().offset + table.back().count;
  last_step = table.back().step;
  for (const Handle& data : times) hdf5::resize(file, data, n_times);
  if (n_rows > 0)  // a column keeps its allocated space only while it has rows
    for (const Handle& data : bodies) hdf5::resize(file, data, n_rows);
  file.flush();
}

void BodySeries::Open::append(double time, std::int64_t step, std::uint64_t rows) {
  const TimeRow now{time, step, n_rows, rows};
  for (std::size_t k = 0; k < times.size(); ++k) {
    std::vector<std::byte> value;
    hdf5::gather_column<TimeRow>(
        of_times[k], 1, [&](auto) { return now; }, value);
    hdf5::resize(file, times[k], n_times + 1);
    write_rows(file, times[k], of_times[k], n_times, value);
  }
  file.flush();
  ++n_times;
  n_rows += rows;
  last_step = step;
}

BodySeries::BodySeries(MPI_Comm comm, const std::filesystem::path& path, BodySeriesInfo info,
                       Provenance provenance, std::optional<std::int64_t> after)
    : comm_(comm), path_(path), info_(std::move(info)), provenance_(std::move(provenance)) {
  parallel::on_rank_0(comm_, [&] {
    for (auto files = body_series_files(path_); !files.empty(); files.pop_back()) {
      if (after) {
        open_ = std::make_shared<Open>(files.back(), info_);
        open_->cut_after(*after);
        last_step_ = open_->last_step;
        if (open_->n_times > 0) break;
        open_.reset();
      }
      std::filesystem::remove(files.back());
    }
    write_over_time();
  });
}

/// Writes bodies.vtkhdf for the files that are there, of which the last is open.
void BodySeries::write_over_time() {
  std::vector<hdf5::BodyFile> files;
  times_ = 0;
  const auto add = [&](const Open& of) {
    files.push_back({of.name.filename().string(), of.whole_times()});
    times_ += files.back().times.size();
  };
  for (const auto& path : body_series_files(path_))
    if (!open_ || path.filename() != open_->name.filename()) add(Open(path, info_));
  if (open_) add(*open_);
  hdf5::write_bodies_over_time(std::filesystem::path(path_).replace_extension(".vtkhdf"), body_columns(info_),
                               files);
  times_shown_ = times_;
}

void BodySeries::show_all_times() {
  parallel::on_rank_0(comm_, [&] {
    if (open_ && times_shown_ < times_) write_over_time();
  });
}

/// Begins the next file, under a temporary name.
std::shared_ptr<BodySeries::Open> BodySeries::begin_file(const Open* last, std::int64_t step,
                                                         std::uint64_t rows) const {
  const hdf5::Path path =
      last ? step_path(path_.parent_path(), path_.stem().string(), step, path_.extension().string()) : path_;
  const hsize_t wanted = std::max<hsize_t>(16 * rows, last ? 2 * last->file.room(last->bodies[0]) : 0);
  const hsize_t row_room = std::max<hsize_t>(rows, std::clamp(wanted, least_rows, most_rows));
  const hsize_t time_room = std::max<hsize_t>(16, row_room / std::max<hsize_t>(rows, 1));
  auto part = std::make_unique<hdf5::TemporaryFile>(path.string() + ".part", true);
  create_file(part->path(), info_, last ? nullptr : &provenance_, rows, row_room, time_room);
  auto next = std::make_shared<Open>(part->path(), info_);
  next->name = path;
  next->part = std::move(part);
  return next;
}

void BodySeries::append(std::int64_t step, double time, std::size_t n,
                        const std::function<BodyRow(std::size_t)>& row) {
  constexpr std::size_t rows_a_piece = 1 << 16;
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
  std::shared_ptr<Open> file = std::move(open_);  // kept if all goes well
  parallel::on_rank_0(comm_, [&] {
    if (!file && last_step_ >= 0) {  // the last append has failed
      file = std::make_shared<Open>(body_series_files(path_).back(), info_);
      file->cut_after(last_step_);
    }
    if (!file || !file->has_room(order.total)) file = begin_file(file.get(), step, order.total);
  });
  const auto columns = body_columns(info_);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Column& c = columns[k];
    std::uint64_t first = 0;
    parallel::on_rank_0(comm_, [&] {
      first = file->n_rows;
      hdf5::resize(file->file, file->bodies[k], first + order.total);
    });
    std::vector<std::byte> values;
    parallel::together(comm_, [&] {
      hdf5::gather_column<BodyRow>(
          c, n, [&](std::size_t r) { return row(order.rows[r]); }, values);
    });
    const auto slice = slices.to_slice(c.bytes(), std::move(values));
    hdf5::gather_in_pieces(slices.comm(), slice, rows_a_piece * c.bytes(),
                           [&](std::span<const std::byte> piece) {
                             write_rows(file->file, file->bodies[k], c, first, piece);
                             first += piece.size() / c.bytes();
                           });
  }
  parallel::on_rank_0(comm_, [&] {
    file->append(time, step, order.total);
    if (const auto part = std::move(file->part)) {
      hdf5::sync_to_disk(part->path());
      part->rename_to(file->name);
    }
    open_ = file;
    last_step_ = step;
    ++times_;
    if (times_ - times_shown_ > times_ / 64) write_over_time();
  });
}

}  // namespace silt::adapters
