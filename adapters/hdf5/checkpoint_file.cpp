#include "adapters/hdf5/checkpoint_file.hpp"

#include <map>
#include <numeric>

#include "adapters/hdf5/checkpoint_parts.hpp"
#include "adapters/hdf5/slice_exchange.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters {

using hdf5::File;
using hdf5::Handle;
using hdf5::RawFile;
using hdf5::SlabExchange;
using hdf5::SliceExchange;

// ---- the checkpoints of a folder ----

namespace {
std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}
}  // namespace

std::optional<std::int64_t> checkpoint_step(const std::filesystem::path& path) {
  return step_of(path, "checkpoint", ".h5");
}

std::vector<StepFile> list_checkpoints(const std::filesystem::path& folder) {
  return step_files(folder, "checkpoint", ".h5");
}

std::optional<std::filesystem::path> previous_checkpoint(const std::filesystem::path& path) {
  const auto own = checkpoint_step(path);
  for (const auto& c : list_checkpoints(folder_of(path)))
    if (c.path.filename() != path.filename() && (!own || c.step < *own)) return c.path;
  return {};
}

void drop_old_checkpoints(const std::filesystem::path& path, int keep) {
  std::error_code ignored;
  const auto own = checkpoint_step(path);
  if (!own) return;
  int kept = 0;
  for (const auto& c : list_checkpoints(folder_of(path)))
    if (c.step <= *own && kept++ >= keep && keep > 0) std::filesystem::remove(c.path, ignored);
  for (const auto& entry : std::filesystem::directory_iterator(folder_of(path), ignored)) {
    auto part = entry.path();
    if (part.extension() == ".part" && checkpoint_step(part.replace_extension()))
      std::filesystem::remove(entry.path(), ignored);
  }
}

// ---- writing ----

struct CheckpointWriter::State {
  MPI_Comm comm;
  hdf5::Path path;
  hdf5::TemporaryFile temporary;
  std::map<std::string, std::uint64_t> checksums;  // of datasets, on rank 0

  const hdf5::Path& part() const { return temporary.path(); }
  /// Opens the file on rank 0, with space for these additional bytes.
  File open_to_add(std::uint64_t bytes) const {
    hdf5::reserve(part(), std::filesystem::file_size(part()) + bytes + hdf5::metadata_room);
    return File::open(part(), true);
  }
  /// Collective. Calls add(file, its group /state) on rank 0.
  template <class Add>
  void add_to_state(Add&& add) const {
    parallel::on_rank_0(comm, [&] {
      File file = open_to_add(0);
      add(file, file.group("/state"));
      file.close();
    });
  }
  template <class Pack>
  void add_components(const std::string& name, Storage, const hdf5::Shape&, int components,
                      const SliceExchange&, Pack&&);
};

/// Collective. Adds a dataset of this shape and writes component q, this rank's values pack(q), in turn.
template <class Pack>
void CheckpointWriter::State::add_components(const std::string& name, Storage storage,
                                             const hdf5::Shape& shape, int components,
                                             const SliceExchange& slices, Pack&& pack) {
  const std::size_t value = H5Tget_size(hdf5::type_of(storage));
  std::uint64_t values = 1, place = 0, checksum = 0;
  for (const hsize_t n : shape) values *= n;
  parallel::on_rank_0(comm, [&] {
    File file = open_to_add(values * value);
    place = file.place_of(file.create_dataset(name, hdf5::type_of(storage), shape));
    file.close();
  });
  parallel::broadcast(comm, place);
  std::optional<RawFile> file;
  parallel::together(comm, [&] { file.emplace(part(), RawFile::to_write); });
  for (int q = 0; q < components; ++q) {
    std::vector<std::byte> packed;
    parallel::together(comm, [&] { packed = pack(q); });
    const auto slice = slices.to_slice(value, std::move(packed));
    const std::uint64_t first = values / components * q + slices.slice_begin();
    parallel::together(comm, [&] {
      checksum += hdf5::run_checksum(value, slice.data(), slices.slice_size(), first);
      file->write(place + first * value, slice);
    });
  }
  parallel::together(comm, [&] { file->close(); });
  checksums[name] = parallel::sum_over_ranks(comm, checksum);
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

/// The shape [q][z][y][x], or [z][y][x] for one component.
hdf5::Shape shape_of(std::array<int, 3> lattice, int components) {
  hdf5::Shape shape{hsize_t(lattice[2]), hsize_t(lattice[1]), hsize_t(lattice[0])};
  if (components > 1) shape.insert(shape.begin(), components);
  return shape;
}

}  // namespace

void CheckpointWriter::cells(const std::string& name, Storage storage, std::array<int, 3> n, int components,
                             const std::vector<CellBox>& boxes,
                             const std::function<void(int, std::size_t, void*)>& fill) {
  const std::size_t value = H5Tget_size(hdf5::type_of(storage));
  const SlabExchange slabs(state_->comm, n, boxes);
  state_->add_components(
      "/cells/" + name, storage, shape_of(n, components), components, slabs.slices(),
      [&](int q) { return slabs.pack(value, [&](std::size_t box, void* out) { fill(q, box, out); }); });
}

void CheckpointWriter::list(const std::string& name, Storage storage, const ListedTiles& tiles,
                            int components, const std::function<void(int, void*)>& fill) {
  const hdf5::TileRuns runs = hdf5::runs_of_tiles(state_->comm, tiles);
  const SliceExchange slices(state_->comm, runs.total, runs.mine);
  const std::size_t entries = std::accumulate(tiles.counts.begin(), tiles.counts.end(), std::size_t{0});
  state_->add_components("/cells/" + name, storage, {hsize_t(components), runs.total}, components, slices,
                         [&](int q) {
                           std::vector<std::byte> packed(entries * H5Tget_size(hdf5::type_of(storage)));
                           fill(q, packed.data());
                           return packed;
                         });
}

void CheckpointWriter::bodies(const OwnedRows& owned, std::span<const AttachedColumn> holder) {
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

/// Adds to an error message which checkpoint to use instead.
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
  std::optional<File> file;  // every rank reads small data by itself

  /// Collective. Returns the position of a dataset of this storage, after check().
  template <class Check>
  hdf5::Place place_of(const CheckpointReader& reader, const std::string& name, Storage storage,
                       Check&& check) const {
    hdf5::Place place;
    parallel::together(comm, [&] {
      check();
      place = file->place(name);
      if (H5Tequal(file->type(file->dataset(name)), hdf5::type_of(storage)) <= 0)
        reader.refuse(name + " was stored in another precision than asked for");
    });
    return place;
  }
  /// Collective. Calls take(q, values of this rank) for each component in turn.
  template <class Take>
  void read_components(const hdf5::Place& place, int components, const SliceExchange& slices,
                       Take&& take) const {
    std::optional<RawFile> raw;
    parallel::together(comm, [&] { raw.emplace(path, RawFile::to_read); });
    for (int q = 0; q < components; ++q) {
      std::vector<std::byte> slice;
      const std::uint64_t first = place.values() / components * q + slices.slice_begin();
      parallel::together(comm, [&] {
        slice = raw->read(place.at + first * place.value_bytes, slices.slice_size() * place.value_bytes);
      });
      const auto packed = slices.from_slice(place.value_bytes, slice);
      parallel::together(comm, [&] { take(q, packed); });
    }
  }
  /// Returns the result of read(file, its group), the same on every rank; errors say which checkpoint to use.
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

void CheckpointReader::refuse_case(const std::string& what) const {
  throw hdf5::Error("the case cannot begin with the checkpoint " + state_->path.string() + ": " + what +
                    "; give the case what that run had, or let it begin with another run");
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
  return shape.size() == 4 || shape.size() == 2 ? int(shape[0]) : 1;
}

bool CheckpointReader::is_stored_as(const std::string& name, Storage storage) const {
  const auto type = state_->file->type(state_->file->dataset("/cells/" + name));
  return H5Tequal(type, hdf5::type_of(storage)) > 0;
}

void CheckpointReader::cells(const std::string& name, Storage storage, const std::vector<CellBox>& boxes,
                             const std::function<void(int, std::size_t, const void*)>& take) const {
  std::array<int, 3> cells{};
  int n = 0;
  const hdf5::Place place = state_->place_of(*this, "/cells/" + name, storage, [&] {
    cells = lattice(name);
    n = components(name);
  });
  const SlabExchange slabs(state_->comm, cells, boxes);
  state_->read_components(place, n, slabs.slices(), [&](int q, const std::vector<std::byte>& packed) {
    slabs.unpack(packed, place.value_bytes, [&](std::size_t box, const void* in) { take(q, box, in); });
  });
}

void CheckpointReader::list(const std::string& name, Storage storage, const ListedTiles& tiles,
                            int components, const std::function<void(int, const void*)>& take) const {
  const hdf5::TileRuns runs = hdf5::runs_of_tiles(state_->comm, tiles);
  const std::string full = "/cells/" + name;
  const hdf5::Place place = state_->place_of(*this, full, storage, [&] {
    if (state_->file->shape(state_->file->dataset(full)) != hdf5::Shape{hsize_t(components), runs.total})
      refuse(full + " has another shape than its levels say");
  });
  const SliceExchange slices(state_->comm, runs.total, runs.mine);
  state_->read_components(place, components, slices,
                          [&](int q, const std::vector<std::byte>& packed) { take(q, packed.data()); });
}

bool CheckpointReader::has_cells(const std::string& name) const {
  return state_->file->exists("/cells/" + name);
}

CheckpointReader::Bodies CheckpointReader::bodies(std::span<const AttachedColumn> holder) const {
  try {
    return hdf5::read_body_tables(state_->comm, *state_->file, holder);
  } catch (const std::runtime_error& error) {  // on every rank
    throw hdf5::Error(with_advice(state_->path, error.what()));
  }
}

}  // namespace silt::adapters
