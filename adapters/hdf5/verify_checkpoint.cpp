#include "adapters/hdf5/verify_checkpoint.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "adapters/hdf5/together.hpp"

namespace silt::adapters::hdf5 {

std::vector<Column> record_columns(std::span<const HolderColumn> holder) {
  using R = rigid::BodyRecord;
  std::vector<Column> columns{{"id", offsetof(R, id), Column::uint64},
                              {"shape", offsetof(R, shape), Column::int32},
                              {"material", offsetof(R, material), Column::int32},
                              {"kind", offsetof(R, kind), Column::int32},
                              {"motion", offsetof(R, motion), Column::uint8},
                              {"mass", offsetof(R, mass), Column::float64},
                              {"weight_in_fluid", offsetof(R, weight_in_fluid), Column::float64},
                              {"inertia_B", offsetof(R, inertia_B), Column::float64, 9},
                              {"position", offsetof(R, position), Column::float64, 3},
                              {"orientation", offsetof(R, orientation), Column::float64, 4},
                              {"image", offsetof(R, image), Column::int32, 3},
                              {"velocity", offsetof(R, velocity), Column::float64, 3},
                              {"angular_velocity", offsetof(R, angular_velocity), Column::float64, 3},
                              {"angular_momentum", offsetof(R, angular_momentum), Column::float64, 3}};
  for (const HolderColumn& c : holder)
    columns.push_back({c.name, offsetof(R, holder_state) + c.offset,
                       c.type == HolderColumn::int64 ? Column::int64 : Column::float64, c.components});
  return columns;
}

const std::vector<Column>& impulse_columns() {
  static const std::vector<Column> columns{{"partner", offsetof(ImpulseRow, partner), Column::uint64},
                                           {"image", offsetof(ImpulseRow, image), Column::int8, 3},
                                           {"feature", offsetof(ImpulseRow, feature), Column::uint64},
                                           {"impulse", offsetof(ImpulseRow, impulse), Column::float64, 3}};
  return columns;
}

std::vector<std::string> dataset_names(const File& file, const std::string& group) {
  std::vector<std::string> names;
  if (!file.exists(group)) return names;
  const Handle g(H5Gopen2(file, group.c_str(), H5P_DEFAULT), H5Gclose, file.path(), "has no group " + group);
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    static_cast<std::vector<std::string>*>(out)->push_back(name);
    return 0;
  };
  file.check(H5Literate(g, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names), "cannot list " + group);
  return names;
}

void write_checked(File& file, const std::string& name, hid_t type, const std::vector<hsize_t>& shape,
                   const void* data, std::size_t bytes) {
  const Handle d = file.create_contiguous(name, type, shape);
  if (bytes > 0) file.check(H5Dwrite(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "cannot write " + name);
  file.attribute(d, "checksum", block_checksum(data, bytes));
}

std::vector<std::byte> read_checked(const File& file, const std::string& name, hid_t type,
                                    std::size_t bytes_a_row) {
  const Handle d = file.dataset(name);
  const auto shape = file.shape(d);
  std::vector<std::byte> data((shape.empty() ? 1 : shape[0]) * bytes_a_row);
  const Handle stored(H5Dget_type(d), H5Tclose, file.path(), "type of " + name);
  if (H5Dget_storage_size(d) != data.size() || H5Tequal(stored, type) <= 0)
    throw Error(file.path().string() + ": " + name + " has another type or size than this version writes");
  if (!data.empty())
    file.check(H5Dread(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()), "cannot read " + name);
  if (block_checksum(data.data(), data.size()) != file.uint_attribute(d, "checksum"))
    throw Error(file.path().string() + ": the content of " + name + " does not match its checksum (altered)");
  return data;
}

namespace {

void verify_head(const File& file) {
  const Handle root(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, file.path(), "has no root");
  if (!file.has_attribute(root, "format") || file.string_attribute(root, "format") != checkpoint_format)
    throw Error(file.path().string() + ": is not a checkpoint of silt");
  const auto version = file.int_attribute(root, "format_version");
  if (version != checkpoint_format_version)
    throw Error(
        file.path().string() + ": has checkpoint format " + std::to_string(version) +
        ", this version of silt reads format " + std::to_string(checkpoint_format_version) +
        "; go on with the version that wrote it (h5dump -g /provenance names it), or start a new run");
  if (!file.has_attribute(root, "complete"))
    throw Error(file.path().string() + ": was not written to its end");
}

/// Reads every header and every attribute of the file: HDF5 compares their checksums, and nothing can fail
/// later.
void verify_metadata(const File& file) {
  struct Visit {
    static herr_t attribute(hid_t object, const char* name, const H5A_info_t*, void*) {
      const hid_t a = H5Aopen(object, name, H5P_DEFAULT);
      if (a < 0) return -1;
      const hid_t type = H5Aget_type(a);
      std::vector<char> value(H5Aget_storage_size(a) + 1);
      const herr_t status = H5Aread(a, type, value.data());
      H5Tclose(type);
      H5Aclose(a);
      return status;
    }
    static herr_t object(hid_t root, const char* name, const H5O_info_t*, void*) {
      const hid_t o = H5Oopen(root, name, H5P_DEFAULT);
      if (o < 0) return -1;
      const herr_t status = H5Aiterate2(o, H5_INDEX_NAME, H5_ITER_INC, nullptr, attribute, nullptr);
      H5Oclose(o);
      return status;
    }
  };
  file.check(H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, Visit::object, nullptr),
             "the file's structure is altered");
}

/// Whatever its type and the number of values a row.
void verify_column(const File& file, const std::string& name) {
  const Handle d = file.dataset(name);
  const Handle type(H5Dget_type(d), H5Tclose, file.path(), "type of " + name);
  const auto shape = file.shape(d);
  std::size_t bytes = H5Tget_size(type);
  for (std::size_t k = 1; k < shape.size(); ++k) bytes *= shape[k];
  read_checked(file, name, type, bytes);
}

void verify_tables(const File& file) {
  for (const auto& [group, columns] :
       {std::pair{std::string("/bodies"), record_columns()}, {std::string("/impulses"), impulse_columns()}}) {
    if (!file.exists(group)) continue;
    for (const Column& c : columns) read_checked(file, group + '/' + c.name, c.memory_type(), c.bytes());
    for (const std::string& name : dataset_names(file, group)) verify_column(file, group + '/' + name);
  }
  const Handle text = file.dataset("/provenance/case_text");
  const Handle type(H5Dget_type(text), H5Tclose, file.path(), "type of the case text");
  read_checked(file, "/provenance/case_text", type, H5Tget_size(type));
}

/// This rank's share of a cell dataset's checksum: every `ranks`-th piece of consecutive planes.
std::uint64_t partial_checksum(const File& file, const std::string& name, int rank, int ranks) {
  constexpr std::size_t piece_bytes = std::size_t{32} << 20;
  const Handle d = file.dataset(name);
  const Handle type(H5Dget_type(d), H5Tclose, file.path(), "type of " + name);
  const std::size_t value = H5Tget_size(type);
  auto shape = file.shape(d);
  if (shape.size() == 3) shape.insert(shape.begin(), 1);
  const std::size_t plane = shape[2] * shape[3], planes = shape[1];
  const std::size_t step =
      std::clamp<std::size_t>(piece_bytes / std::max<std::size_t>(plane * value, 1), 1, planes);
  std::vector<std::byte> data;
  std::uint64_t sum = 0, piece = 0;
  for (std::size_t q = 0; q < shape[0]; ++q)
    for (std::size_t z = 0; z < planes; z += step, ++piece) {
      if (piece % ranks != static_cast<std::uint64_t>(rank)) continue;
      const hsize_t n = std::min(step, planes - z), values = n * plane;
      const Handle space(H5Dget_space(d), H5Sclose, file.path(), "shape of " + name);
      std::vector<hsize_t> start{q, z, 0, 0}, count{1, n, shape[2], shape[3]};
      const std::size_t skip = 4 - H5Sget_simple_extent_ndims(space);
      H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data() + skip, nullptr, count.data() + skip, nullptr);
      const Handle memory(H5Screate_simple(1, &values, nullptr), H5Sclose, file.path(), "memory shape");
      data.resize(values * value);
      file.check(H5Dread(d, type, memory, space, H5P_DEFAULT, data.data()),
                 "cannot read " + name + " (truncated?)");
      sum += run_checksum(value, data.data(), values, (q * planes + z) * plane);
    }
  return sum;
}

}  // namespace

void verify_checkpoint(MPI_Comm comm, const Path& path) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  std::optional<File> file;
  on_rank_0(comm, [&] {
    if (!std::filesystem::exists(path)) throw Error(path.string() + ": there is no such file");
    file.emplace(File::open(path, false));
    verify_head(*file);
    verify_metadata(*file);
    verify_tables(*file);
  });
  together(comm, [&] {
    if (!file) file.emplace(File::open(path, false));
  });
  std::vector<std::string> names;
  together(comm, [&] { names = dataset_names(*file, "/cells"); });
  for (const std::string& name : names) {
    std::uint64_t mine = 0, sum = 0;
    together(comm, [&] { mine = partial_checksum(*file, "/cells/" + name, rank, ranks); });
    MPI_Reduce(&mine, &sum, 1, MPI_UINT64_T, MPI_SUM, 0, comm);
    on_rank_0(comm, [&] {
      if (sum != file->uint_attribute(file->dataset("/cells/" + name), "checksum"))
        throw Error(path.string() + ": the content of /cells/" + name +
                    " does not match its checksum (altered)");
    });
  }
}

}  // namespace silt::adapters::hdf5
