#include <map>
#include <optional>

#include "adapters/hdf5/body_tables.hpp"
#include "adapters/hdf5/slab_exchange.hpp"
#include "adapters/hdf5/verify_checkpoint.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters {

using hdf5::File;
using hdf5::Handle;
using hdf5::SlabExchange;

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
};

CheckpointWriter::CheckpointWriter(MPI_Comm comm, const std::filesystem::path& path,
                                   const Provenance& provenance) {
  const int rank = parallel::rank_of(comm);
  state_.reset(new State{comm, path, {path.string() + ".part", rank == 0}, {}});
  parallel::on_rank_0(comm, [&] {
    hdf5::reserve(state_->part(), hdf5::metadata_room + provenance.case_text.size());
    File file = File::create(state_->part(), hdf5::Format::checked);
    const Handle root = file.group("/", false);
    file.attribute(root, "format", std::string(hdf5::checkpoint_format));
    file.attribute(root, "format_version", checkpoint_format_version);
    file.group("/state", true);
    file.group("/cells", true);
    file.write_provenance(provenance);
    const Handle text = file.dataset("/provenance/case_text");
    const std::string& stored = provenance.case_text;
    file.attribute(
        text, "checksum",
        stored.empty() ? hdf5::block_checksum("\0", 1) : hdf5::block_checksum(stored.data(), stored.size()));
    file.close();
  });
}

CheckpointWriter::~CheckpointWriter() = default;

template <class T>
void CheckpointWriter::set_any(const std::string& name, const T& value) {
  parallel::on_rank_0(state_->comm, [&] {
    File file = state_->open_to_add(0);
    file.attribute(file.group("/state", false), name, value);
    file.close();
  });
}
void CheckpointWriter::set(const std::string& name, std::int64_t value) {
  set_any(name, value);
}
void CheckpointWriter::set(const std::string& name, double value) {
  set_any(name, value);
}
void CheckpointWriter::set(const std::string& name, const std::string& value) {
  set_any(name, value);
}

namespace {
template <class T>
hid_t cell_type();
template <>
hid_t cell_type<float>() {
  return H5T_IEEE_F32LE;
}
template <>
hid_t cell_type<double>() {
  return H5T_IEEE_F64LE;
}
template <>
hid_t cell_type<std::uint8_t>() {
  return H5T_STD_U8LE;
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

template <class T>
void CheckpointWriter::cells(const std::string& name, std::array<int, 3> n, int components,
                             const std::vector<CellBox>& boxes,
                             const std::function<void(int, std::size_t, T*)>& fill) {
  const MPI_Comm comm = state_->comm;
  const std::string full = "/cells/" + name;
  const std::uint64_t bytes = std::uint64_t(n[0]) * n[1] * n[2] * sizeof(T);  // of a component
  std::uint64_t place = 0;
  parallel::on_rank_0(comm, [&] {
    std::vector<hsize_t> shape{hsize_t(n[2]), hsize_t(n[1]), hsize_t(n[0])};
    if (components > 1) shape.insert(shape.begin(), components);
    File file = state_->open_to_add(components * bytes);
    place = file.place_of(file.create_contiguous(full, cell_type<T>(), shape));
    file.close();
  });
  parallel::broadcast(comm, place);
  const SlabExchange slabs(comm, n, boxes);
  std::optional<hdf5::SharedFile> file;
  parallel::together(comm, [&] { file.emplace(state_->part()); });
  std::uint64_t mine = 0;
  for (int q = 0; q < components; ++q) {
    std::vector<std::byte> packed;
    parallel::together(comm, [&] {
      packed = slabs.pack(sizeof(T), [&](std::size_t box, void* out) {
        fill(q, box, static_cast<T*>(out));
        mine += box_checksum(boxes[box], n, q, sizeof(T), out);
      });
    });
    slabs.write(*file, place + q * bytes, sizeof(T), std::move(packed));
  }
  parallel::together(comm, [&] { file->close(); });
  state_->checksums[full] = parallel::sum_over_ranks(comm, mine);
}

template void CheckpointWriter::cells(const std::string&, std::array<int, 3>, int,
                                      const std::vector<CellBox>&,
                                      const std::function<void(int, std::size_t, float*)>&);
template void CheckpointWriter::cells(const std::string&, std::array<int, 3>, int,
                                      const std::vector<CellBox>&,
                                      const std::function<void(int, std::size_t, double*)>&);
template void CheckpointWriter::cells(const std::string&, std::array<int, 3>, int,
                                      const std::vector<CellBox>&,
                                      const std::function<void(int, std::size_t, std::uint8_t*)>&);

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
      file.attribute(file.dataset(name), "checksum", checksum);
    file.attribute(file.group("/", false), "complete", std::int64_t{1});
    file.close();
    hdf5::sync_to_disk(state_->part());
  });
  hdf5::verify_checkpoint(state_->comm, state_->part());
  parallel::on_rank_0(state_->comm, [&] {
    state_->temporary.rename_to(state_->path);
    drop_old_checkpoints(state_->path, keep);
  });
}

}  // namespace silt::adapters
