#include "adapters/hdf5/checkpoint_file.hpp"

#include <map>
#include <numeric>

#include "adapters/hdf5/checkpoint_parts.hpp"
#include "adapters/hdf5/slab_exchange.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters {

using hdf5::File;
using hdf5::Handle;
using hdf5::RawFile;
using hdf5::SlabExchange;

// ---- writing ----

struct CheckpointWriter::State {
  MPI_Comm comm;
  hdf5::Path path;
  hdf5::TemporaryFile temporary;
  std::map<std::string, std::uint64_t> checksums;  // of datasets, rank 0

  const hdf5::Path& part() const { return temporary.path(); }
  /// Opens the file on rank 0, with room for so many bytes of data more.
  File open_to_add(std::uint64_t bytes) const {
    hdf5::reserve(part(), std::filesystem::file_size(part()) + bytes + hdf5::metadata_room);
    return File::open(part(), true);
  }
  /// Collective. Does add(file, its group /state) on rank 0.
  template <class Add>
  void add_to_state(Add&& add) const {
    parallel::on_rank_0(comm, [&] {
      File file = open_to_add(0);
      add(file, file.group("/state"));
      file.close();
    });
  }
  template <class Pack, class Write>
  void add_components(const std::string& name, Storage, const hdf5::Shape&, int components, Pack&&, Write&&);
};

/// Adds a dataset of this shape and writes it a component after the other: pack(q, checksum) returns what
/// this rank has and adds to the checksum; write(file, place of the component, packed) is collective.
template <class Pack, class Write>
void CheckpointWriter::State::add_components(const std::string& name, Storage storage,
                                             const hdf5::Shape& shape, int components, Pack&& pack,
                                             Write&& write) {
  std::uint64_t bytes = H5Tget_size(hdf5::type_of(storage)), place = 0, mine = 0;
  for (const hsize_t n : shape) bytes *= n;
  parallel::on_rank_0(comm, [&] {
    File file = open_to_add(bytes);
    place = file.place_of(file.create_dataset(name, hdf5::type_of(storage), shape));
    file.close();
  });
  parallel::broadcast(comm, place);
  std::optional<RawFile> file;
  parallel::together(comm, [&] { file.emplace(part(), RawFile::to_write); });
  for (int q = 0; q < components; ++q) {
    std::vector<std::byte> packed;
    parallel::together(comm, [&] { packed = pack(q, mine); });
    write(*file, place + bytes / components * q, std::move(packed));
  }
  parallel::together(comm, [&] { file->close(); });
  checksums[name] = parallel::sum_over_ranks(comm, mine);
}

CheckpointWriter::CheckpointWriter(MPI_Comm comm, const std::filesystem::path& path,
                                   const Provenance& provenance) {
  const int rank = parallel::rank_of(comm);
  state_.reset(new State{comm, path, {path.string() + ".part", rank == 0}, {}});
  parallel::on_rank_0(comm, [&] {
    hdf5::reserve(state_->part(), hdf5::metadata_room + provenance.case_text.size());
    File file = File::create(state_->part(), hdf5::Format::checked);
    const Handle root = file.group("/");
    file.attribute(root, "format", std::string(hdf5::checkpoint_format));
    file.number(root, "format_version", checkpoint_format_version);
    file.create_group("/state");
    file.create_group("/cells");
    file.write_provenance(provenance);
    file.number(file.case_text_dataset(), "checksum", hdf5::block_checksum(provenance.case_text));
    file.close();
  });
}

CheckpointWriter::~CheckpointWriter() = default;

void CheckpointWriter::set(const std::string& name, std::int64_t value) {
  state_->add_to_state([&](File& file, hid_t group) { file.number(group, name, value); });
}
void CheckpointWriter::set(const std::string& name, double value) {
  state_->add_to_state([&](File& file, hid_t group) { file.number(group, name, value); });
}
void CheckpointWriter::set(const std::string& name, const std::string& value) {
  state_->add_to_state([&](File& file, hid_t group) { file.attribute(group, name, value); });
}

namespace {

/// The array [q][z][y][x] of `components` numbers a cell; of one, [z][y][x].
hdf5::Shape shape_of(std::array<int, 3> lattice, int components) {
  hdf5::Shape shape{hsize_t(lattice[2]), hsize_t(lattice[1]), hsize_t(lattice[0])};
  if (components > 1) shape.insert(shape.begin(), components);
  return shape;
}

/// Returns the checksum of one component of this rank's cells, given in file order box by box.
std::uint64_t box_checksum(const CellBox& box, std::array<int, 3> n, int q, std::size_t value,
                           const void* data) {
  const std::size_t length = box.upper[0] - box.lower[0];
  const auto* row = static_cast<const std::byte*>(data);
  std::uint64_t sum = 0;
  for (int z = box.lower[2]; z < box.upper[2]; ++z)
    for (int y = box.lower[1]; y < box.upper[1]; ++y, row += length * value) {
      const std::uint64_t index = ((std::uint64_t(q) * n[2] + z) * n[1] + y) * n[0] + box.lower[0];
      sum += hdf5::run_checksum(value, row, length, index);
    }
  return sum;
}

}  // namespace

void CheckpointWriter::cells(const std::string& name, Storage storage, std::array<int, 3> n, int components,
                             const std::vector<CellBox>& boxes,
                             const std::function<void(int, std::size_t, void*)>& fill) {
  const std::size_t value = H5Tget_size(hdf5::type_of(storage));
  const SlabExchange slabs(state_->comm, n, boxes);
  const auto pack = [&](int q, std::uint64_t& checksum) {
    return slabs.pack(value, [&](std::size_t box, void* out) {
      fill(q, box, out);
      checksum += box_checksum(boxes[box], n, q, value, out);
    });
  };
  const auto write = [&](RawFile& file, std::uint64_t place, std::vector<std::byte> packed) {
    slabs.write(file, place, value, std::move(packed));
  };
  state_->add_components("/cells/" + name, storage, shape_of(n, components), components, pack, write);
}

void CheckpointWriter::list(const std::string& name, Storage storage, std::array<int, 3> tiles,
                            int components, const CellBox& box, std::span<const std::uint32_t> counts,
                            const std::function<void(int, void*)>& fill) {
  const std::size_t value = H5Tget_size(hdf5::type_of(storage));
  const hdf5::TileRuns runs = hdf5::runs_of_tiles(state_->comm, tiles, box, counts);
  const hdf5::SliceExchange slices(state_->comm, runs.total, runs.mine);
  const auto pack = [&](int q, std::uint64_t& checksum) {
    std::vector<std::byte> packed(std::accumulate(counts.begin(), counts.end(), std::size_t{0}) * value);
    fill(q, packed.data());
    const std::byte* from = packed.data();
    for (const auto& [first, length] : runs.mine) {
      checksum += hdf5::run_checksum(value, from, length, q * runs.total + first);
      from += length * value;
    }
    return packed;
  };
  const auto write = [&](RawFile& file, std::uint64_t place, std::vector<std::byte> packed) {
    const auto slice = slices.to_slice(value, std::move(packed));
    parallel::together(state_->comm, [&] { file.write(place + slices.slice_begin() * value, slice); });
  };
  state_->add_components("/cells/" + name, storage, {hsize_t(components), runs.total}, components, pack,
                         write);
}

void CheckpointWriter::bodies(const OwnedRows& owned, std::span<const rigid::HolderColumn> holder) {
  const auto open = [&](std::uint64_t bytes) { return state_->open_to_add(bytes); };
  state_->checksums.merge(hdf5::write_body_tables(state_->comm, state_->part(), open, owned, holder));
}

void CheckpointWriter::commit(int keep, const std::vector<std::filesystem::path>& before) {
  parallel::on_rank_0(state_->comm, [&] {
    for (const auto& path : before)
      if (std::filesystem::exists(path)) hdf5::sync_to_disk(path);
    File file = state_->open_to_add(0);
    for (const auto& [name, checksum] : state_->checksums)
      file.number(file.dataset(name), "checksum", checksum);
    file.number(file.group("/"), "complete", std::int64_t{1});
    file.close();
    hdf5::sync_to_disk(state_->part());
  });
  hdf5::verify_checkpoint(state_->comm, state_->part());
  parallel::on_rank_0(state_->comm, [&] {
    state_->temporary.rename_to(state_->path);
    drop_old_checkpoints(state_->path, keep);
  });
}

// ---- reading ----

namespace {

/// Says what went wrong and what to do about it.
std::string with_advice(const hdf5::Path& path, const std::string& what) {
  if (const auto previous = previous_checkpoint(path))
    return "cannot use the checkpoint " + what + "; use the previous checkpoint, " + previous->string();
  return "cannot use the checkpoint " + what +
         "; there is no earlier checkpoint next to it, start the case again";
}

}  // namespace

struct CheckpointReader::State {
  MPI_Comm comm;
  hdf5::Path path;
  std::optional<File> file;  // each rank reads what is small by itself

  /// Opens the values of a dataset, which must be stored so, after look().
  template <class Look>
  hdf5::Place open_cells(const CheckpointReader& reader, const std::string& name, Storage storage,
                         std::optional<RawFile>& raw, Look&& look) const {
    const std::string full = "/cells/" + name;
    hdf5::Place place;
    parallel::together(comm, [&] {
      look();
      place = file->place(full);
      if (H5Tequal(file->type(file->dataset(full)), hdf5::type_of(storage)) <= 0)
        reader.refuse(full + " was stored in another precision than asked for");
      raw.emplace(path, RawFile::to_read);
    });
    return place;
  }
  /// What read(file, its group) gives, on every rank alike; errors say which checkpoint to use.
  template <class Read>
  auto advised(const char* group, Read&& read) const {
    try {
      return read(*file, file->group(group));
    } catch (const hdf5::Error& error) {
      throw hdf5::Error(with_advice(path, error.what()));
    }
  }
};

CheckpointReader::CheckpointReader(MPI_Comm comm, const std::filesystem::path& path)
    : state_(new State{comm, path, {}}) {
  try {
    hdf5::verify_checkpoint(comm, path);
    parallel::together(comm, [&] { state_->file.emplace(File::open(path, false)); });
  } catch (const parallel::CommonError& error) {  // on every rank
    const parallel::CommonError advised(error.rank, with_advice(path, error.what()));
    parallel::throw_together(comm, &advised);
  }
}

CheckpointReader::~CheckpointReader() = default;

void CheckpointReader::refuse(const std::string& what) const {
  throw hdf5::Error(with_advice(state_->path, state_->path.string() + ": " + what));
}

const std::filesystem::path& CheckpointReader::path() const {
  return state_->path;
}
MPI_Comm CheckpointReader::comm() const {
  return state_->comm;
}

bool CheckpointReader::has(const std::string& name) const {
  return state_->file->has_attribute(state_->file->group("/state"), name);
}
std::int64_t CheckpointReader::integer(const std::string& name) const {
  return state_->advised(
      "/state", [&](const File& file, hid_t group) { return file.number_in<std::int64_t>(group, name); });
}
double CheckpointReader::number(const std::string& name) const {
  return state_->advised("/state",
                         [&](const File& file, hid_t group) { return file.number_in<double>(group, name); });
}
std::string CheckpointReader::text(const std::string& name) const {
  return state_->advised("/state", [&](const File& file, hid_t group) { return file.text_in(group, name); });
}
std::string CheckpointReader::provenance(const std::string& name) const {
  return state_->advised("/provenance",
                         [&](const File& file, hid_t group) { return file.text_in(group, name); });
}
std::string CheckpointReader::case_text() const {
  std::string text = state_->file->case_text();
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::array<int, 3> CheckpointReader::lattice(const std::string& name) const {
  const auto shape = state_->advised(
      "/cells", [&](const File& file, hid_t) { return file.shape(file.dataset("/cells/" + name)); });
  if (shape.size() != 3 && shape.size() != 4) refuse("/cells/" + name + " is no field of cells");
  const std::size_t z = shape.size() - 3;
  return {int(shape[z + 2]), int(shape[z + 1]), int(shape[z])};
}

int CheckpointReader::components(const std::string& name) const {
  const auto shape = state_->file->shape(state_->file->dataset("/cells/" + name));
  return shape.size() == 4 ? int(shape[0]) : 1;
}

void CheckpointReader::cells(const std::string& name, Storage storage, const std::vector<CellBox>& boxes,
                             const std::function<void(int, std::size_t, const void*)>& take) const {
  const MPI_Comm comm = state_->comm;
  std::array<int, 3> cells{};
  int n = 0;
  std::optional<RawFile> raw;
  const hdf5::Place place = state_->open_cells(*this, name, storage, raw, [&] {
    cells = lattice(name);
    n = components(name);
  });
  const SlabExchange slabs(comm, cells, boxes);
  for (int q = 0; q < n; ++q) {
    const auto packed =
        slabs.read(*raw, place.at + place.values() / n * q * place.value_bytes, place.value_bytes);
    parallel::together(comm, [&] {
      slabs.unpack(packed, place.value_bytes, [&](std::size_t box, const void* in) { take(q, box, in); });
    });
  }
}

void CheckpointReader::list(const std::string& name, Storage storage, std::array<int, 3> tiles,
                            int components, const CellBox& box, std::span<const std::uint32_t> counts,
                            const std::function<void(int, const void*)>& take) const {
  const MPI_Comm comm = state_->comm;
  const hdf5::TileRuns runs = hdf5::runs_of_tiles(comm, tiles, box, counts);
  std::optional<RawFile> raw;
  const hdf5::Place place = state_->open_cells(*this, name, storage, raw, [&] {
    if (state_->file->shape(state_->file->dataset("/cells/" + name)) !=
        hdf5::Shape{hsize_t(components), runs.total})
      refuse("/cells/" + name + " has another shape than its levels say");
  });
  const hdf5::SliceExchange slices(comm, runs.total, runs.mine);
  for (int q = 0; q < components; ++q) {
    std::vector<std::byte> slice;
    parallel::together(comm, [&] {
      slice = raw->read(place.at + (q * runs.total + slices.slice_begin()) * place.value_bytes,
                        slices.slice_size() * place.value_bytes);
    });
    const auto packed = slices.from_slice(place.value_bytes, slice);
    parallel::together(comm, [&] { take(q, packed.data()); });
  }
}

bool CheckpointReader::has_cells(const std::string& name) const {
  return state_->file->exists("/cells/" + name);
}

CheckpointReader::Bodies CheckpointReader::bodies(std::span<const rigid::HolderColumn> holder) const {
  try {
    return hdf5::read_body_tables(state_->comm, *state_->file, holder);
  } catch (const std::runtime_error& error) {  // on every rank
    throw hdf5::Error(with_advice(state_->path, error.what()));
  }
}

}  // namespace silt::adapters
