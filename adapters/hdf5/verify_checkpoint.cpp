#include "adapters/hdf5/verify_checkpoint.hpp"

#include <algorithm>
#include <optional>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters::hdf5 {

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

/// Throws for a link that HDF5 would follow to another place or file: that may be anything, a pipe too. A
/// checkpoint has none.
void verify_links(const File& file) {
  const auto look = [](hid_t, const char* name, const H5L_info_t* link, void* found) -> herr_t {
    if (link->type == H5L_TYPE_HARD) return 0;
    *static_cast<std::string*>(found) = name;
    return 1;
  };
  std::string found;
  file.check(H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, look, &found), "the file's structure is altered");
  if (!found.empty())
    throw Error(file.path().string() + ": /" + found +
                " is a link to another place or file; a checkpoint holds all of its data itself");
}

/// What verify_metadata has come to.
struct Visit {
  std::string elsewhere;  // a dataset whose values are in other files

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
  static bool is_stored_here(hid_t dataset) {
    const hid_t list = H5Dget_create_plist(dataset);
    const bool here = H5Pget_layout(list) != H5D_VIRTUAL && H5Pget_external_count(list) <= 0;
    H5Pclose(list);
    return here;
  }
  static herr_t object(hid_t root, const char* name, const H5O_info_t* info, void* visit) {
    const hid_t o = H5Oopen(root, name, H5P_DEFAULT);
    if (o < 0) return -1;
    herr_t status = H5Aiterate2(o, H5_INDEX_NAME, H5_ITER_INC, nullptr, attribute, nullptr);
    if (info->type == H5O_TYPE_DATASET && !is_stored_here(o)) {
      static_cast<Visit*>(visit)->elsewhere = name;
      status = 1;
    }
    H5Oclose(o);
    return status;
  }
};

/// Reads every header and every attribute of the file: HDF5 compares their checksums, and nothing can fail
/// later.
void verify_metadata(const File& file) {
  Visit visit;
  file.check(H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, Visit::object, &visit),
             "the file's structure is altered");
  if (!visit.elsewhere.empty())
    throw Error(file.path().string() + ": /" + visit.elsewhere +
                " has its values in another file; a checkpoint holds all of its data itself");
}

/// The case text is small: one rank reads it whole.
void verify_case_text(const File& file) {
  const std::string name = "/provenance/case_text";
  const Handle d = file.dataset(name);
  const Handle type(H5Dget_type(d), H5Tclose, file.path(), "type of " + name);
  std::vector<std::byte> data(H5Tget_size(type));
  if (H5Dget_storage_size(d) != data.size())
    throw Error(file.path().string() + ": " + name + " has another size than this version writes");
  file.check(H5Dread(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()), "cannot read " + name);
  if (block_checksum(data.data(), data.size()) != file.uint_attribute(d, "checksum"))
    throw Error(file.path().string() + ": the content of " + name + " does not match its checksum (altered)");
}

/// A dataset as leading x planes x values: [q][z][y][x] and [z][y][x] of cells, [row][component] of tables.
struct Planes {
  hsize_t leading = 1, planes = 0, values = 1;  // values: of a plane
  std::vector<hsize_t> shape;

  /// Throws Error for a dataset of another form, or one that declares more bytes than its file has.
  Planes(const File& file, const std::string& name, std::vector<hsize_t> of, std::size_t value_bytes)
      : shape(std::move(of)) {
    const auto bad = [&](const char* what) { throw Error(file.path().string() + ": " + name + what); };
    if (shape.empty() || shape.size() > 4 || (value_bytes != 1 && value_bytes != 4 && value_bytes != 8))
      bad(" has another form than this version writes");
    hsize_t room = std::filesystem::file_size(file.path()) / value_bytes;
    for (const hsize_t n : shape) room = n > 0 ? room / n : room;
    if (room == 0) bad(" declares more values than the file has room for");
    const std::size_t axis = shape.size() == 4 ? 1 : 0;
    if (axis == 1) leading = shape[0];
    planes = shape[axis];
    for (std::size_t k = axis + 1; k < shape.size(); ++k) values *= shape[k];
  }
  /// Selects n planes.
  Handle select(const File& file, hid_t dataset, hsize_t q, hsize_t first, hsize_t n) const {
    Handle space(H5Dget_space(dataset), H5Sclose, file.path(), "shape of a dataset");
    std::vector<hsize_t> start(shape.size(), 0), count = shape;
    const std::size_t axis = shape.size() == 4 ? 1 : 0;
    if (axis == 1) start[0] = q, count[0] = 1;
    start[axis] = first;
    count[axis] = n;
    file.check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
               "cannot select planes");
    return space;
  }
};

/// Adds up checksums of pieces, of which each rank takes every `ranks`-th, whatever dataset they belong to.
class PieceSums {
 public:
  PieceSums(const File& file, int rank, int ranks) : file_(file), rank_(rank), ranks_(ranks) {}

  /// Returns this rank's share of a dataset's checksum.
  std::uint64_t of(const std::string& name) {
    constexpr std::size_t piece_bytes = std::size_t{8} << 20;
    const Handle d = file_.dataset(name);
    const Handle type(H5Dget_type(d), H5Tclose, file_.path(), "type of " + name);
    const std::size_t value = H5Tget_size(type);
    const Planes all(file_, name, file_.shape(d), value);
    const hsize_t step = std::max<hsize_t>(1, piece_bytes / std::max<hsize_t>(all.values * value, 1));
    std::uint64_t sum = 0;
    for (hsize_t q = 0; q < all.leading; ++q)
      for (hsize_t first = 0; first < all.planes; first += step) {
        if (piece_++ % ranks_ != static_cast<std::uint64_t>(rank_)) continue;
        const hsize_t n = std::min(step, all.planes - first), values = n * all.values;
        const Handle space = all.select(file_, d, q, first, n);
        const Handle memory(H5Screate_simple(1, &values, nullptr), H5Sclose, file_.path(), "memory shape");
        data_.resize(values * value);
        file_.check(H5Dread(d, type, memory, space, H5P_DEFAULT, data_.data()),
                    "cannot read " + name + " (truncated?)");
        sum += run_checksum(value, data_.data(), values, (q * all.planes + first) * all.values);
      }
    return sum;
  }

 private:
  const File& file_;
  int rank_, ranks_;
  std::uint64_t piece_ = 0;
  std::vector<std::byte> data_;
};

}  // namespace

void verify_checkpoint(MPI_Comm comm, const Path& path) {
  const int rank = parallel::rank_of(comm), ranks = parallel::ranks_of(comm);
  std::optional<File> file;
  parallel::on_rank_0(comm, [&] {
    if (!std::filesystem::exists(path)) throw Error(path.string() + ": there is no such file");
    file.emplace(File::open(path, false));
    verify_head(*file);
    verify_links(*file);
    verify_metadata(*file);
    verify_case_text(*file);
  });
  parallel::together(comm, [&] {
    if (!file) file.emplace(File::open(path, false));
  });
  std::vector<std::string> names;
  std::vector<std::uint64_t> sums;
  parallel::together(comm, [&] {
    for (const char* group : {"/cells", "/bodies", "/impulses"})
      for (const std::string& name : dataset_names(*file, group))
        names.push_back(std::string(group) + '/' + name);
    PieceSums pieces(*file, rank, ranks);
    for (const std::string& name : names) sums.push_back(pieces.of(name));
  });
  parallel::sum_over_ranks(comm, std::span(sums));
  parallel::on_rank_0(comm, [&] {
    for (std::size_t k = 0; k < names.size(); ++k) {
      const Handle dataset = file->dataset(names[k]);
      if (!file->has_attribute(dataset, "checksum") || sums[k] != file->uint_attribute(dataset, "checksum"))
        throw Error(path.string() + ": the content of " + names[k] +
                    " does not match its checksum (altered)");
    }
  });
}

}  // namespace silt::adapters::hdf5
