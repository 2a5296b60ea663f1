#include "adapters/hdf5/field_file.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <fstream>
#include <optional>
#include <span>

#include "adapters/hdf5/file.hpp"
#include "adapters/hdf5/over_time.hpp"
#include "adapters/hdf5/slice_exchange.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters {
namespace {

using hdf5::File;
using hdf5::Handle;
using hdf5::Path;
using hdf5::SlabExchange;

constexpr std::uint64_t box_bytes = 6 * sizeof(std::int32_t);

/// The datasets of one group: quantities of the cells of these boxes in an array of this shape.
struct Group {
  std::string name;
  const std::vector<CellBox>& boxes;
  const std::vector<FieldQuantity>& quantities;
  hdf5::Shape shape;
  int width = 0;  // of the cells, for AMR levels
  std::uint64_t boxes_of_all = 0;

  std::string dataset(const FieldQuantity& q) const { return name + q.name; }
  hdf5::Shape shape_of(const FieldQuantity& q) const {
    hdf5::Shape all = shape;
    if (q.components > 1) all.push_back(q.components);
    return all;
  }
  std::uint64_t cells() const {
    std::uint64_t n = 1;
    for (const hsize_t length : shape) n *= length;
    return n;
  }
};

std::size_t cell_bytes(const FieldQuantity& q) {
  return q.components * H5Tget_size(hdf5::type_of(q.storage));
}

Group image_group(const FieldSnapshot& snapshot, const std::vector<CellBox>& boxes) {
  const auto& [x, y, z] = snapshot.grid.cells;
  return {"/VTKHDF/PointData/", boxes, snapshot.quantities, {hsize_t(z), hsize_t(y), hsize_t(x)}};
}

/// Collective. Returns the levels with cells on any rank in VTK's order, the coarsest first.
std::vector<Group> level_groups(MPI_Comm comm, const std::vector<FieldLevel>& levels) {
  std::vector<Group> groups;
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
    struct {
      std::uint64_t cells = 0, boxes;
    } sums{0, level->boxes.size()};
    for (const CellBox& box : level->boxes) sums.cells += box.cells();
    sums = parallel::sum_over_ranks(comm, sums);
    if (sums.cells == 0) continue;
    groups.push_back({"/VTKHDF/Level" + std::to_string(groups.size()) + "/CellData/",
                      level->boxes,
                      level->quantities,
                      {sums.cells},
                      level->width,
                      sums.boxes});
  }
  return groups;
}

std::array<double, 3> first_centre(const ImageGrid& grid) {
  std::array<double, 3> origin;
  for (int d = 0; d < 3; ++d) origin[d] = grid.origin[d] + 0.5 * grid.spacing[d];
  return origin;
}

void write_image_grid(File& file, hid_t vtk, const ImageGrid& grid) {
  std::int64_t extent[6] = {};
  for (int d = 0; d < 3; ++d) extent[2 * d + 1] = grid.cells[d] - 1;
  file.attribute(vtk, "WholeExtent", H5T_NATIVE_INT64, {6}, extent);
  file.numbers(vtk, "Origin", first_centre(grid));
  file.numbers(vtk, "Spacing", grid.spacing);
  file.numbers(vtk, "Direction", std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
}

void write_units(File& file, const ImageGrid& grid) {
  const Handle root = file.group("/");
  file.attribute(root, "time_unit", grid.time_unit);
  file.attribute(root, "length_unit", grid.length_unit);
}

void write_head(File& file, const FieldSnapshot& snapshot, const std::vector<Group>& groups,
                const Provenance& provenance) {
  const ImageGrid& grid = snapshot.grid;
  const Handle vtk = file.group("/VTKHDF"), root = file.group("/");
  const std::int64_t version[2] = {1, 0};
  file.attribute(vtk, "Version", H5T_NATIVE_INT64, {2}, version);
  if (groups[0].width > 0) {
    file.attribute(vtk, "Type", std::string("OverlappingAMR"));
    file.attribute(vtk, "GridDescription", std::string("XYZ"));
    file.numbers(vtk, "Origin", grid.origin);
  } else {
    file.attribute(vtk, "Type", std::string("ImageData"));
    write_image_grid(file, vtk, grid);
  }
  file.number(root, "time", snapshot.time);
  file.number(root, "step", snapshot.step);
  write_units(file, grid);
  file.write_provenance(provenance);
}

/// Makes the groups of a level except the datasets of CellData; returns the position of the list of boxes.
std::uint64_t create_level(File& file, const FieldSnapshot& snapshot, const Group& level) {
  const std::string name = level.name.substr(0, level.name.rfind("CellData"));
  std::array<double, 3> spacing = snapshot.grid.spacing;
  for (double& width : spacing) width *= level.width;
  const Handle group = file.create_group(name);
  file.numbers(group, "Spacing", spacing);
  file.number(group, "level", std::int64_t(std::countr_zero(unsigned(level.width))));
  for (const char* data : {"CellData", "PointData", "FieldData"}) file.create_group(name + data);
  return file.place_of(file.create_dataset(name + "AMRBox", H5T_NATIVE_INT32, {level.boxes_of_all, 6}));
}

/// Creates the file with everything but the values. Returns the positions of the quantities' values, for a
/// level preceded by that of its list of boxes. Called on rank 0 only.
std::vector<std::uint64_t> create_file(const Path& path, const FieldSnapshot& snapshot,
                                       const std::vector<Group>& groups, const Provenance& provenance) {
  File file = File::create(path, hdf5::Format::classic);
  std::vector<std::uint64_t> places;
  file.create_group("/VTKHDF");
  for (const Group& group : groups) {
    if (group.width > 0)
      places.push_back(create_level(file, snapshot, group));
    else
      file.create_group(group.name);
    for (const FieldQuantity& q : group.quantities) {
      const Handle data = file.create_dataset(group.dataset(q), hdf5::type_of(q.storage), group.shape_of(q));
      file.attribute(data, "unit", q.unit);
      places.push_back(file.place_of(data));
    }
  }
  write_head(file, snapshot, groups, provenance);
  file.close();
  return places;
}

std::uint64_t expected_size(const std::vector<Group>& groups, const Provenance& provenance) {
  std::uint64_t bytes = provenance.case_text.size() + 4096;
  for (const Group& group : groups) {
    bytes += group.boxes_of_all * box_bytes;
    for (const FieldQuantity& q : group.quantities) bytes += group.cells() * cell_bytes(q);
  }
  return bytes;
}

SlabExchange exchange_of(MPI_Comm comm, const Group& group) {
  if (group.width > 0) return SlabExchange(comm, group.boxes);
  const auto& n = group.shape;
  return SlabExchange(comm, {int(n[2]), int(n[1]), int(n[0])}, group.boxes);
}

/// Converts some planes at a time, so that they stay in cache.
std::vector<std::byte> values_here(const SlabExchange& slabs, const FieldQuantity& q) {
  constexpr std::size_t wide_values = 1 << 12;  // at a time, unless a plane has more
  std::vector<double> wide;
  return slabs.pack(cell_bytes(q), [&](std::size_t k, void* out) {
    const CellBox& box = slabs.boxes()[k];
    const int planes = box.size.z;
    if (q.storage == Storage::double_) return q.values(k, 0, planes, static_cast<double*>(out));
    const std::size_t plane = box.cells() / planes * q.components;
    const int at_once = int(std::max<std::size_t>(1, wide_values / plane));
    wide.resize(plane * std::min(at_once, planes));
    const auto narrowed = [&](auto* narrow) {
      for (int first = 0; first < planes; first += at_once) {
        const int last = std::min(first + at_once, planes);
        q.values(k, first, last, wide.data());
        narrow = std::copy_n(wide.data(), plane * (last - first), narrow);
      }
    };
    q.storage == Storage::byte ? narrowed(static_cast<std::uint8_t*>(out))
                               : narrowed(static_cast<float*>(out));
  });
}

/// Writes the boxes of all ranks in rank order, in VTK's format: first and last cell, axis by axis.
void write_boxes(MPI_Comm comm, hdf5::RawFile& file, const std::vector<CellBox>& boxes, std::uint64_t place) {
  const std::uint64_t first = parallel::sum_of_ranks_before(comm, std::uint64_t(boxes.size()));
  parallel::together(comm, [&] {
    std::vector<std::int32_t> numbers;
    for (const CellBox& box : boxes)
      for (int d = 0; d < 3; ++d)
        numbers.insert(numbers.end(), {box.lower[d], box.lower[d] + box.size[d] - 1});
    const auto bytes = std::as_bytes(std::span(numbers));
    file.write(place + first * box_bytes, {bytes.begin(), bytes.end()});
  });
}

void write_values(MPI_Comm comm, const Path& path, const std::vector<Group>& groups,
                  const std::vector<std::uint64_t>& places) {
  std::optional<hdf5::RawFile> file;
  parallel::together(comm, [&] { file.emplace(path, hdf5::RawFile::to_write); });
  auto place = places.begin();
  for (const Group& group : groups) {
    if (group.width > 0) write_boxes(comm, *file, group.boxes, *place++);
    const SlabExchange slabs = exchange_of(comm, group);
    for (const FieldQuantity& q : group.quantities) {
      std::vector<std::byte> values;
      parallel::together(comm, [&] { values = values_here(slabs, q); });
      const auto slab = slabs.slices().to_slice(cell_bytes(q), std::move(values));
      const std::uint64_t begin = *place++ + slabs.slices().slice_begin() * cell_bytes(q);
      parallel::together(comm, [&] { file->write(begin, slab); });
    }
  }
  parallel::together(comm, [&] { file->close(); });
}

// ---- the list of times ----

/// Returns what the files of a series have in common: fields for fields_000100.hdf.
std::string series_name(const Path& path) {
  std::string stem = path.stem().string();
  const auto end = stem.find_last_not_of("0123456789");
  if (end != std::string::npos && end + 1 < stem.size() && (stem[end] == '_' || stem[end] == '-'))
    stem.resize(end);
  return stem;
}

/// Adds a file to the list, replacing entries at its time and later.
void update_series(const Path& field_path, double time) {
  using Json = nlohmann::ordered_json;
  const Path path = field_path.parent_path() /
                    (series_name(field_path) + field_path.extension().string() + ".series"),
             part = path.string() + ".part";
  Json series = {{"file-series-version", "1.0"}, {"files", Json::array()}};
  std::ifstream in(path);
  const Json before = Json::parse(in, nullptr, false);  // discarded if there is none
  if (before.is_object())
    for (const Json& entry : before.value("files", Json::array()))
      if (entry.value("time", time) < time) series["files"].push_back(entry);
  series["files"].push_back({{"name", field_path.filename().string()}, {"time", time}});
  std::ofstream out(part);
  out << series.dump(2) << '\n';
  out.close();
  if (!out) hdf5::fail_in_system(path, "cannot write the list of times (is the disk full?)", errno);
  std::filesystem::rename(part, path);
}

/// Adds a file of a single level to the file over time.
void update_over_time(const Path& path, const Group& group, const FieldSnapshot& snapshot) {
  const ImageGrid& grid = snapshot.grid;
  const FieldPlan& plan = snapshot.plan;
  hdf5::ImageTimes images{
      {}, first_centre(grid), plan.every, plan.last_step, plan.time_step, [&](File& file, hid_t vtk) {
        write_image_grid(file, vtk, grid);
        write_units(file, grid);
      }};
  for (const FieldQuantity& q : group.quantities)
    images.arrays.push_back({q.name, q.unit, hdf5::type_of(q.storage), group.shape_of(q)});
  hdf5::add_image(path.parent_path(), series_name(path), snapshot.step, images);
}

void write_groups(MPI_Comm comm, const Path& path, const std::vector<Group>& groups,
                  const FieldSnapshot& snapshot, const Provenance& provenance) {
  const int rank = parallel::rank_of(comm);
  hdf5::TemporaryFile part(path.string() + ".part", rank == 0);
  std::size_t datasets = 0;
  for (const Group& group : groups) datasets += group.quantities.size() + (group.width > 0);
  std::vector<std::uint64_t> places(datasets);
  parallel::on_rank_0(comm, [&] {
    hdf5::reserve(part.path(), expected_size(groups, provenance));
    places = create_file(part.path(), snapshot, groups, provenance);
    hdf5::reserve(part.path(), std::filesystem::file_size(part.path()));
  });
  parallel::broadcast(comm, std::span(places));
  write_values(comm, part.path(), groups, places);
  parallel::on_rank_0(comm, [&] {
    part.rename_to(path);
    update_series(path, snapshot.time);
    if (snapshot.plan.every > 0 && groups[0].width == 0) update_over_time(path, groups[0], snapshot);
  });
}

}  // namespace

void write_fields(MPI_Comm comm, const Path& path, const std::vector<CellBox>& boxes,
                  const FieldSnapshot& snapshot, const Provenance& provenance) {
  write_groups(comm, path, {image_group(snapshot, boxes)}, snapshot, provenance);
}

void write_fields(MPI_Comm comm, const Path& path, const std::vector<FieldLevel>& levels,
                  const FieldSnapshot& snapshot, const Provenance& provenance) {
  write_groups(comm, path, level_groups(comm, levels), snapshot, provenance);
}

}  // namespace silt::adapters
