#include "adapters/hdf5/field_file.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <optional>

#include "adapters/hdf5/packed_chunks.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters {
namespace {

using hdf5::File;
using hdf5::Handle;
using hdf5::Path;
using hdf5::SlabExchange;

/// The type of a field's numbers, in the file and in memory alike.
hid_t type_of(const FieldQuantity& q) {
  switch (q.storage) {
    case Storage::single:
      return H5T_IEEE_F32LE;
    case Storage::double_:
      return H5T_IEEE_F64LE;
    case Storage::byte:
      return H5T_STD_U8LE;
  }
  __builtin_unreachable();
}

std::string dataset_name(const FieldQuantity& q) {
  return "/VTKHDF/PointData/" + q.name;
}

std::size_t cell_bytes(const FieldQuantity& q) {
  return q.components * H5Tget_size(type_of(q));
}

/// How many rows of a plane share a chunk; its last one is stored as large as the others. All quantities have
/// the same.
int rows_of_a_chunk(const FieldSnapshot& snapshot) {
  constexpr std::size_t chunk_bytes = 1 << 20;  // at most
  std::size_t row_bytes = 1;
  for (const FieldQuantity& q : snapshot.quantities)
    row_bytes = std::max(row_bytes, snapshot.grid.cells[0] * cell_bytes(q));
  const int rows = snapshot.grid.cells[1];
  const int most = int(std::clamp<std::size_t>(chunk_bytes / row_bytes, 1, rows)),
            chunks = (rows + most - 1) / most;
  return (rows + chunks - 1) / chunks;
}

hdf5::Packing packing_of(const FieldSnapshot& snapshot) {
  return {hsize_t(rows_of_a_chunk(snapshot)), snapshot.compression};
}

/// Writes where the image lies and what it is of.
void write_head(File& file, const FieldSnapshot& snapshot, const Provenance& provenance) {
  const ImageGrid& grid = snapshot.grid;
  const Handle image = file.group("/VTKHDF", false);
  const std::int64_t version[2] = {1, 0};
  std::int64_t extent[6];
  double origin[3];
  const double direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int d = 0; d < 3; ++d) {
    extent[2 * d] = 0;
    extent[2 * d + 1] = grid.cells[d] - 1;
    origin[d] = grid.origin[d] + 0.5 * grid.spacing[d];
  }
  file.attribute(image, "Version", H5T_NATIVE_INT64, {2}, version);
  file.attribute(image, "Type", std::string("ImageData"));
  file.attribute(image, "WholeExtent", H5T_NATIVE_INT64, {6}, extent);
  file.attribute(image, "Origin", H5T_NATIVE_DOUBLE, {3}, origin);
  file.attribute(image, "Spacing", H5T_NATIVE_DOUBLE, {3}, grid.spacing.data());
  file.attribute(image, "Direction", H5T_NATIVE_DOUBLE, {9}, direction);
  const Handle root = file.group("/", false);
  file.attribute(root, "time", snapshot.time);
  file.attribute(root, "step", snapshot.step);
  file.attribute(root, "time_unit", grid.time_unit);
  file.attribute(root, "length_unit", grid.length_unit);
  file.write_provenance(provenance);
}

/// Creates the dataset of a quantity. Returns where in the file its values begin, unless they are packed.
std::uint64_t create_dataset(File& file, const FieldSnapshot& snapshot, const FieldQuantity& q) {
  std::vector<hsize_t> shape;
  for (int d = 2; d >= 0; --d) shape.push_back(snapshot.grid.cells[d]);
  if (q.components > 1) shape.push_back(q.components);
  const Handle data = snapshot.compression > 0 ? hdf5::create_packed(file, dataset_name(q), type_of(q), shape,
                                                                     packing_of(snapshot))
                                               : file.create_contiguous(dataset_name(q), type_of(q), shape);
  file.attribute(data, "unit", q.unit);
  return snapshot.compression > 0 ? 0 : file.place_of(data);
}

/// Creates the file with everything but the values. Only rank 0 calls it.
std::vector<std::uint64_t> create_file(const Path& path, const FieldSnapshot& snapshot,
                                       const Provenance& provenance) {
  File file = File::create(path, hdf5::Format::classic);
  std::vector<std::uint64_t> places;
  file.group("/VTKHDF", true);
  file.group("/VTKHDF/PointData", true);
  for (const FieldQuantity& q : snapshot.quantities) places.push_back(create_dataset(file, snapshot, q));
  write_head(file, snapshot, provenance);
  file.close();
  return places;
}

std::uint64_t expected_size(const FieldSnapshot& snapshot, const Provenance& provenance) {
  const auto& [x, y, z] = snapshot.grid.cells;
  const std::uint64_t cells = std::uint64_t(x) * y * z;
  std::uint64_t bytes = provenance.case_text.size() + 4096;
  for (const FieldQuantity& q : snapshot.quantities) {
    bytes += cells * cell_bytes(q);
    if (snapshot.compression == 0) continue;  // else packing may gain nothing
    const int of_a_chunk = rows_of_a_chunk(snapshot), chunks = (y + of_a_chunk - 1) / of_a_chunk;
    bytes += std::uint64_t(z) * (chunks * of_a_chunk - y) * x * cell_bytes(q) + hdf5::metadata_room;
  }
  return bytes;
}

/// Some planes at a time: what is narrowed is still in cache.
std::vector<std::byte> packed_values(const SlabExchange& slabs, const FieldQuantity& q) {
  constexpr std::size_t wide_values = 1 << 12;  // at a time, if a plane has no more
  std::vector<double> wide;
  return slabs.pack(cell_bytes(q), [&](std::size_t k, void* out) {
    const CellBox& box = slabs.boxes()[k];
    const int planes = box.upper[2] - box.lower[2];
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

void write_values(MPI_Comm comm, const Path& path, const std::vector<CellBox>& boxes,
                  const FieldSnapshot& snapshot, std::vector<std::uint64_t> places) {
  parallel::broadcast(comm, std::span(places));
  const SlabExchange slabs(comm, snapshot.grid.cells, boxes);
  std::optional<hdf5::SharedFile> file;
  parallel::together(comm, [&] { file.emplace(path); });
  for (std::size_t k = 0; k < places.size(); ++k) {
    const FieldQuantity& q = snapshot.quantities[k];
    std::vector<std::byte> values;
    parallel::together(comm, [&] { values = packed_values(slabs, q); });
    slabs.write(*file, places[k], cell_bytes(q), std::move(values));
  }
  parallel::together(comm, [&] { file->close(); });
}

void write_packed_values(MPI_Comm comm, const Path& path, const std::vector<CellBox>& boxes,
                         const FieldSnapshot& snapshot) {
  const SlabExchange slabs(comm, snapshot.grid.cells, boxes, rows_of_a_chunk(snapshot));
  std::optional<File> file;
  parallel::on_rank_0(comm, [&] { file.emplace(File::open(path, true)); });
  for (const FieldQuantity& q : snapshot.quantities) {
    std::vector<std::byte> values;
    parallel::together(comm, [&] { values = packed_values(slabs, q); });
    hdf5::write_packed(comm, slabs, file ? &*file : nullptr, dataset_name(q), packing_of(snapshot),
                       cell_bytes(q) / q.components, cell_bytes(q), std::move(values));
  }
  parallel::on_rank_0(comm, [&] {
    file->close();
    hdf5::sync_to_disk(path);
  });
}

/// Returns the path of the list of times: fields.hdf.series for fields_000100.hdf.
Path series_path(const Path& path) {
  std::string stem = path.stem().string();
  const auto end = stem.find_last_not_of("0123456789");
  if (end != std::string::npos && end + 1 < stem.size() && (stem[end] == '_' || stem[end] == '-'))
    stem.resize(end);
  return path.parent_path() / (stem + path.extension().string() + ".series");
}

/// Returns the time in a line, if update_series wrote that line.
bool entry_time(const std::string& line, double& time) {
  const std::string mark = "\"time\": ";
  const auto at = line.rfind(mark);
  if (at == std::string::npos) return false;
  const char* from = line.c_str() + at + mark.size();
  return std::from_chars(from, line.c_str() + line.size(), time).ec == std::errc{};
}

void update_series(const Path& field_path, double time) {
  const Path path = series_path(field_path);
  std::vector<std::string> entries;
  if (std::ifstream in(path); in)
    for (std::string line; std::getline(in, line);) {
      double old = 0;
      if (!entry_time(line, old) || !(old < time)) continue;
      while (!line.empty() && line.back() == ',') line.pop_back();
      entries.push_back(line);
    }
  char number[32];
  const auto end = std::to_chars(number, number + sizeof number, time).ptr;
  entries.push_back("    {\"name\": \"" + field_path.filename().string() +
                    "\", \"time\": " + std::string(number, end) + "}");
  const Path part = path.string() + ".part";
  std::ofstream out(part);
  out << "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n";
  for (std::size_t i = 0; i < entries.size(); ++i)
    out << entries[i] << (i + 1 < entries.size() ? ",\n" : "\n");
  out << "  ]\n}\n";
  out.close();
  if (!out) hdf5::fail_in_system(path, "cannot write the list of times (is the disk full?)", errno);
  std::filesystem::rename(part, path);
}

}  // namespace

std::filesystem::path field_path(const std::filesystem::path& folder, const std::string& name,
                                 std::int64_t step) {
  std::string number = std::to_string(step);
  if (number.size() < 12) number.insert(0, 12 - number.size(), '0');
  return folder / (name + "_" + number + ".hdf");
}

void write_fields(MPI_Comm comm, const std::filesystem::path& path, const std::vector<CellBox>& boxes,
                  const FieldSnapshot& snapshot, const Provenance& provenance) {
  const int rank = parallel::rank_of(comm);
  hdf5::TemporaryFile part(path.string() + ".part", rank == 0);
  std::vector<std::uint64_t> places(snapshot.quantities.size());
  parallel::on_rank_0(comm, [&] {
    hdf5::reserve(part.path(), expected_size(snapshot, provenance));
    places = create_file(part.path(), snapshot, provenance);
    hdf5::reserve(part.path(), snapshot.compression > 0 ? expected_size(snapshot, provenance)
                                                        : std::filesystem::file_size(part.path()));
  });
  if (snapshot.compression > 0)
    write_packed_values(comm, part.path(), boxes, snapshot);
  else
    write_values(comm, part.path(), boxes, snapshot, std::move(places));
  parallel::on_rank_0(comm, [&] {
    part.rename_to(path);
    update_series(path, snapshot.time);
  });
}

}  // namespace silt::adapters
