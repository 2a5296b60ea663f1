#include <algorithm>
#include <optional>

#include "adapters/hdf5/body_tables.hpp"
#include "adapters/hdf5/slab_exchange.hpp"
#include "adapters/hdf5/verify_checkpoint.hpp"
#include "parallel/together.hpp"

namespace silt::adapters {

using hdf5::File;
using hdf5::Handle;
using hdf5::SlabExchange;

struct CheckpointReader::State {
  MPI_Comm comm;
  hdf5::Path path;
  std::optional<File> file;  // each rank reads what is small by itself

  Handle group(const std::string& name) const {
    return {H5Gopen2(*file, name.c_str(), H5P_DEFAULT), H5Gclose, path, "has no group " + name};
  }
  /// What `read` does on every rank alike; errors say which checkpoint to use.
  template <class Read>
  auto advised(Read&& read) const;
};

namespace {

/// Says what went wrong and what to do about it.
std::string with_advice(const hdf5::Path& path, const std::string& what) {
  if (const auto previous = previous_checkpoint(path))
    return "cannot use the checkpoint " + what + "; use the previous checkpoint, " + previous->string();
  return "cannot use the checkpoint " + what +
         "; there is no earlier checkpoint next to it, start the case again";
}

}  // namespace

template <class Read>
auto CheckpointReader::State::advised(Read&& read) const {
  try {
    return read();
  } catch (const hdf5::Error& error) {
    throw hdf5::Error(with_advice(path, error.what()));
  }
}

namespace {

template <class T>
bool is_stored_as(hid_t dataset);
bool same_type(hid_t dataset, hid_t type) {
  const hid_t stored = H5Dget_type(dataset);
  const bool same = H5Tequal(stored, type) > 0;
  H5Tclose(stored);
  return same;
}
template <>
bool is_stored_as<float>(hid_t d) {
  return same_type(d, H5T_IEEE_F32LE);
}
template <>
bool is_stored_as<double>(hid_t d) {
  return same_type(d, H5T_IEEE_F64LE);
}
template <>
bool is_stored_as<std::uint8_t>(hid_t d) {
  return same_type(d, H5T_STD_U8LE);
}

}  // namespace

CheckpointReader::CheckpointReader(MPI_Comm comm, const std::filesystem::path& path)
    : state_(std::make_unique<State>()) {
  state_->comm = comm;
  state_->path = path;
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
  return state_->file->has_attribute(state_->group("/state"), name);
}
std::int64_t CheckpointReader::integer(const std::string& name) const {
  return state_->advised([&] { return state_->file->int_attribute(state_->group("/state"), name); });
}
double CheckpointReader::number(const std::string& name) const {
  return state_->advised([&] { return state_->file->double_attribute(state_->group("/state"), name); });
}
std::string CheckpointReader::text(const std::string& name) const {
  return state_->advised([&] { return state_->file->string_attribute(state_->group("/state"), name); });
}
std::string CheckpointReader::provenance(const std::string& name) const {
  return state_->advised([&] { return state_->file->string_attribute(state_->group("/provenance"), name); });
}
std::string CheckpointReader::case_text() const {
  const Handle text = state_->file->dataset("/provenance/case_text");
  const Handle type(H5Dget_type(text), H5Tclose, state_->path, "type of the case text");
  std::string value(H5Tget_size(type), '\0');
  state_->file->check(H5Dread(text, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()),
                      "cannot read the case text");
  while (!value.empty() && value.back() == '\0') value.pop_back();
  return value;
}

bool CheckpointReader::has_cells(const std::string& name) const {
  return state_->file->exists("/cells/" + name);
}

std::array<int, 3> CheckpointReader::lattice(const std::string& name) const {
  const auto shape =
      state_->advised([&] { return state_->file->shape(state_->file->dataset("/cells/" + name)); });
  if (shape.size() != 3 && shape.size() != 4) refuse("/cells/" + name + " is no field of cells");
  const std::size_t z = shape.size() - 3;
  return {int(shape[z + 2]), int(shape[z + 1]), int(shape[z])};
}

int CheckpointReader::components(const std::string& name) const {
  const auto shape = state_->file->shape(state_->file->dataset("/cells/" + name));
  return shape.size() == 4 ? int(shape[0]) : 1;
}

template <class T>
void CheckpointReader::cells(const std::string& name, const std::vector<CellBox>& boxes,
                             const std::function<void(int, std::size_t, const T*)>& take) const {
  const std::string full = "/cells/" + name;
  const MPI_Comm comm = state_->comm;
  std::array<int, 3> cells{};
  int n = 0;
  parallel::together(comm, [&] {
    cells = lattice(name);
    n = components(name);
    if (!is_stored_as<T>(state_->file->dataset(full)))
      refuse(full + " was stored in another precision than asked for");
  });
  Handle dataset, type;
  parallel::together(comm, [&] {
    dataset = state_->file->dataset(full);
    type = Handle(H5Dget_type(dataset), H5Tclose, state_->path, "type of " + full);
  });
  const SlabExchange slabs(comm, cells, boxes);
  for (int q = 0; q < n; ++q) {
    const auto packed = slabs.read(*state_->file, dataset, type, n > 1 ? q : -1, sizeof(T));
    parallel::together(comm, [&] {
      slabs.unpack(packed, sizeof(T),
                   [&](std::size_t box, const void* in) { take(q, box, static_cast<const T*>(in)); });
    });
  }
}

template void CheckpointReader::cells(const std::string&, const std::vector<CellBox>&,
                                      const std::function<void(int, std::size_t, const float*)>&) const;
template void CheckpointReader::cells(const std::string&, const std::vector<CellBox>&,
                                      const std::function<void(int, std::size_t, const double*)>&) const;
template void CheckpointReader::cells(
    const std::string&, const std::vector<CellBox>&,
    const std::function<void(int, std::size_t, const std::uint8_t*)>&) const;

std::size_t CheckpointReader::body_count() const {
  const auto shape = state_->file->shape(state_->file->dataset("/bodies/id"));
  return shape.empty() ? 0 : shape[0];
}

CheckpointReader::Bodies CheckpointReader::bodies(std::span<const rigid::HolderColumn> holder) const {
  try {
    return hdf5::read_body_tables(state_->comm, *state_->file, holder);
  } catch (const std::runtime_error& error) {  // on every rank
    throw hdf5::Error(with_advice(state_->path, error.what()));
  }
}

}  // namespace silt::adapters
