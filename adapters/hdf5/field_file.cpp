#include "adapters/hdf5/field_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <new>
#include <optional>

#include "adapters/hdf5/file.hpp"
#include "adapters/hdf5/slab_exchange.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters {
namespace {

using hdf5::File;
using hdf5::Handle;
using hdf5::Path;
using hdf5::SlabExchange;

std::string dataset_name(const FieldQuantity& q) {
  return "/VTKHDF/PointData/" + q.name;
}

std::size_t cell_bytes(const FieldQuantity& q) {
  return q.components * H5Tget_size(hdf5::type_of(q.storage));
}

/// How many rows of a plane share a packed chunk; its last one is stored as large as the others. All
/// quantities have the same.
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

/// Writes where the image lies and what it is of.
void write_head(File& file, const FieldSnapshot& snapshot, const Provenance& provenance) {
  const ImageGrid& grid = snapshot.grid;
  const Handle image = file.group("/VTKHDF"), root = file.group("/");
  const std::int64_t version[2] = {1, 0};
  std::int64_t extent[6] = {};
  std::array<double, 3> origin;
  for (int d = 0; d < 3; ++d) {
    extent[2 * d + 1] = grid.cells[d] - 1;
    origin[d] = grid.origin[d] + 0.5 * grid.spacing[d];
  }
  file.attribute(image, "Version", H5T_NATIVE_INT64, {2}, version);
  file.attribute(image, "Type", std::string("ImageData"));
  file.attribute(image, "WholeExtent", H5T_NATIVE_INT64, {6}, extent);
  file.numbers(image, "Origin", origin);
  file.numbers(image, "Spacing", grid.spacing);
  file.numbers(image, "Direction", std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
  file.number(root, "time", snapshot.time);
  file.number(root, "step", snapshot.step);
  file.attribute(root, "time_unit", grid.time_unit);
  file.attribute(root, "length_unit", grid.length_unit);
  file.write_provenance(provenance);
}

/// Creates the file with everything but the values. Returns where in it those of each quantity begin, unless
/// they are packed. Only rank 0 calls it.
std::vector<std::uint64_t> create_file(const Path& path, const FieldSnapshot& snapshot,
                                       const Provenance& provenance) {
  File file = File::create(path, hdf5::Format::classic);
  std::vector<std::uint64_t> places;
  file.create_group("/VTKHDF");
  file.create_group("/VTKHDF/PointData");
  const auto& [x, y, z] = snapshot.grid.cells;
  for (const FieldQuantity& q : snapshot.quantities) {
    hdf5::Shape shape{hsize_t(z), hsize_t(y), hsize_t(x)}, chunk;
    if (q.components > 1) shape.push_back(q.components);
    if (snapshot.compression > 0) chunk = shape, chunk[0] = 1, chunk[1] = rows_of_a_chunk(snapshot);
    const Handle data = file.create_dataset(dataset_name(q), hdf5::type_of(q.storage), shape,
                                            {chunk, false, snapshot.compression});
    file.attribute(data, "unit", q.unit);
    places.push_back(chunk.empty() ? file.place_of(data) : 0);
  }
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
std::vector<std::byte> values_here(const SlabExchange& slabs, const FieldQuantity& q) {
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
  std::optional<hdf5::RawFile> file;
  parallel::together(comm, [&] { file.emplace(path, hdf5::RawFile::to_write); });
  for (std::size_t k = 0; k < places.size(); ++k) {
    const FieldQuantity& q = snapshot.quantities[k];
    std::vector<std::byte> values;
    parallel::together(comm, [&] { values = values_here(slabs, q); });
    slabs.write(*file, places[k], cell_bytes(q), std::move(values));
  }
  parallel::together(comm, [&] { file->close(); });
}

// ---- packed values ----

/// Returns a chunk as HDF5's filters "shuffle" and "deflate" make it: first bytes of all values, then second
/// ones, and so on, packed.
std::vector<std::byte> packed_chunk(std::span<const std::byte> values, std::size_t value_bytes, int level) {
  const std::size_t n = values.size() / value_bytes;
  std::vector<std::byte> shuffled(values.size()), packed(compressBound(values.size()));
  for (std::size_t b = 0; b < value_bytes; ++b)
    for (std::size_t i = 0; i < n; ++i) shuffled[b * n + i] = values[i * value_bytes + b];
  uLongf size = packed.size();
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(shuffled.data()), shuffled.size(), level) != Z_OK)
    throw std::bad_alloc();  // there is no other reason
  packed.resize(size);
  return packed;
}

/// Each rank packs the chunks of its slab, and rank 0 writes them: HDF5's own way for several ranks leaves
/// all of them waiting where one fails.
void write_packed_values(MPI_Comm comm, const Path& path, const std::vector<CellBox>& boxes,
                         const FieldSnapshot& snapshot) {
  const hsize_t chunk_rows = rows_of_a_chunk(snapshot), rows = snapshot.grid.cells[1];
  const SlabExchange slabs(comm, snapshot.grid.cells, boxes, int(chunk_rows));
  std::optional<File> file;
  parallel::on_rank_0(comm, [&] { file.emplace(File::open(path, true)); });
  for (const FieldQuantity& q : snapshot.quantities) {
    std::vector<std::byte> slab;
    std::vector<std::vector<std::byte>> chunks;
    parallel::together(comm, [&] { slab = values_here(slabs, q); });
    slab = slabs.slab(cell_bytes(q), std::move(slab));
    const std::size_t chunk_bytes = chunk_rows * snapshot.grid.cells[0] * cell_bytes(q);
    Handle dataset;
    parallel::together(comm, [&] {
      for (std::size_t first = 0; first < slab.size(); first += chunk_bytes)
        chunks.push_back(packed_chunk(std::span(slab).subspan(first, chunk_bytes),
                                      cell_bytes(q) / q.components, snapshot.compression));
      std::vector<std::byte>().swap(slab);
      if (file) dataset = file->dataset(dataset_name(q));
    });
    hsize_t at[4] = {};  // of the chunk that comes next, plane by plane
    hdf5::hand_to_rank_0(
        slabs.comm(), chunks, compressBound(chunk_bytes), [&](std::span<const std::byte> chunk) {
          file->check(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, at, chunk.size(), chunk.data()),
                      "cannot write (is the disk full?)");
          at[1] += chunk_rows;
          if (at[1] >= rows) at[1] = 0, ++at[0];
        });
  }
  parallel::on_rank_0(comm, [&] {
    file->close();
    hdf5::sync_to_disk(path);
  });
}

// ---- the list of times ----

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
