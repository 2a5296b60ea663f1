#include "adapters/hdf5/checkpoint_parts.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters::hdf5 {

namespace {

/// splitmix64's finaliser (Steele, Lea, Flood 2014), in which every bit affects every other.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

template <class Bits>
std::uint64_t checksum_of(const void* values, std::size_t n, std::uint64_t index) {
  std::uint64_t sum = 0;
  const auto* bytes = static_cast<const unsigned char*>(values);
  for (std::size_t i = 0; i < n; ++i) {
    Bits bits;
    std::memcpy(&bits, bytes + i * sizeof(Bits), sizeof(Bits));
    const std::uint64_t term = mixed(std::uint64_t{bits} + 0x9e3779b97f4a7c15u * (index + i + 1));
    sum += bits ? term : 0;
  }
  return sum;
}

}  // namespace

std::uint64_t run_checksum(std::size_t value_bytes, const void* values, std::size_t n, std::uint64_t index) {
  const auto checksum = value_bytes == 1   ? checksum_of<std::uint8_t>
                        : value_bytes == 4 ? checksum_of<std::uint32_t>
                                           : checksum_of<std::uint64_t>;
  return checksum(values, n, index);
}

std::uint64_t block_checksum(const std::string& content) {
  return content.empty() ? XXH3_64bits("\0", 1) : XXH3_64bits(content.data(), content.size());
}

namespace {

/// Returns the names of the datasets in a group, sorted; none if there is no such group.
std::vector<std::string> dataset_names(const File& file, const std::string& group) {
  std::vector<std::string> names;
  if (!file.exists(group)) return names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    static_cast<std::vector<std::string>*>(out)->push_back(name);
    return 0;
  };
  file.check(H5Literate(file.group(group), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names),
             "cannot list " + group);
  return names;
}

void verify_head(const File& file) {
  const Handle root = file.group("/");
  if (!file.has_attribute(root, "format") || file.text_in(root, "format") != checkpoint_format)
    file.refuse("is not a checkpoint of silt");
  const auto version = file.number_in<std::int64_t>(root, "format_version");
  if (version != checkpoint_format_version)
    file.refuse(
        "has checkpoint format " + std::to_string(version) + ", this version of silt reads format " +
        std::to_string(checkpoint_format_version) +
        "; go on with the version that wrote it (h5dump -g /provenance names it), or start a new run");
  if (!file.has_attribute(root, "complete")) file.refuse("was not written to its end");
}

/// Throws for soft and external links, which HDF5 would follow to any place, such as a pipe.
void verify_links(const File& file) {
  const auto find_external = [](hid_t, const char* name, const H5L_info_t* link, void* found) -> herr_t {
    if (link->type == H5L_TYPE_HARD) return 0;
    *static_cast<std::string*>(found) = name;
    return 1;
  };
  std::string found;
  file.check(H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, find_external, &found),
             "the file's structure is altered");
  if (!found.empty())
    file.refuse("/" + found +
                " is a link to another place or file; a checkpoint holds all of its data itself");
}

/// State of verify_metadata during its traversal.
struct Visit {
  std::string elsewhere;  // a dataset with values in external files

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

/// Reads every header and attribute, so that HDF5 compares all checksums now and no later read fails.
void verify_metadata(const File& file) {
  Visit visit;
  file.check(H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, Visit::object, &visit),
             "the file's structure is altered");
  if (!visit.elsewhere.empty())
    file.refuse("/" + visit.elsewhere +
                " has its values in another file; a checkpoint holds all of its data itself");
}

/// Returns this rank's part of the datasets' checksums: every `ranks`-th piece.
std::vector<std::uint64_t> shares_of_checksums(const File& file, const std::vector<std::string>& names,
                                               int rank, int ranks) {
  constexpr std::size_t piece_bytes = std::size_t{8} << 20;
  const RawFile raw(file.path(), RawFile::to_read);
  std::vector<std::uint64_t> sums;
  std::uint64_t piece = 0;
  for (const std::string& name : names) {
    const Place place = file.place(name);
    const std::uint64_t values = place.values(), step = piece_bytes / place.value_bytes;
    std::uint64_t& sum = sums.emplace_back(0);
    for (std::uint64_t first = 0; first < values; first += step) {
      if (piece++ % ranks != std::uint64_t(rank)) continue;
      const std::uint64_t n = std::min(step, values - first);
      const auto data = raw.read(place.at + first * place.value_bytes, n * place.value_bytes);
      sum += run_checksum(place.value_bytes, data.data(), n, first);
    }
  }
  return sums;
}

void require_checksum(const File& file, const std::string& name, std::uint64_t sum) {
  const Handle dataset = file.dataset(name);
  if (!file.has_attribute(dataset, "checksum") || sum != file.number_in<std::uint64_t>(dataset, "checksum"))
    file.refuse("the content of " + name + " does not match its checksum (altered)");
}

}  // namespace

void verify_checkpoint(MPI_Comm comm, const Path& path) {
  std::optional<File> file;
  parallel::on_rank_0(comm, [&] {
    if (!std::filesystem::exists(path)) throw Error(path.string() + ": there is no such file");
    file.emplace(File::open(path, false));
    verify_head(*file);
    verify_links(*file);
    verify_metadata(*file);
    require_checksum(*file, "/provenance/case_text", block_checksum(file->case_text()));
  });
  std::vector<std::string> names;
  std::vector<std::uint64_t> sums;
  parallel::together(comm, [&] {
    if (!file) file.emplace(File::open(path, false));
    for (const char* group : {"/cells", "/bodies", "/impulses"})
      for (const std::string& name : dataset_names(*file, group))
        names.push_back(std::string(group) + '/' + name);
    sums = shares_of_checksums(*file, names, parallel::rank_of(comm), parallel::ranks_of(comm));
  });
  parallel::sum_over_ranks(comm, std::span(sums));
  parallel::on_rank_0(comm, [&] {
    for (std::size_t k = 0; k < names.size(); ++k) require_checksum(*file, names[k], sums[k]);
  });
}

}  // namespace silt::adapters::hdf5
