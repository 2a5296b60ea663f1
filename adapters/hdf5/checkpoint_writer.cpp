#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "adapters/hdf5/slab_exchange.hpp"
#include "adapters/hdf5/together.hpp"
#include "adapters/hdf5/verify_checkpoint.hpp"

namespace silt::adapters {

using hdf5::Column;
using hdf5::File;
using hdf5::Handle;
using hdf5::ImpulseRow;
using hdf5::SlabExchange;

struct CheckpointWriter::State {
  MPI_Comm comm;
  hdf5::Path path;
  hdf5::TemporaryFile temporary;
  std::map<std::string, std::uint64_t> checksums;  // of the cell datasets, rank 0

  const hdf5::Path& part() const { return temporary.path(); }
  /// The file, with room for so many more bytes of data. On rank 0 only.
  File open_to_add(std::uint64_t bytes) const {
    hdf5::reserve(part(), std::filesystem::file_size(part()) + bytes + hdf5::metadata_room);
    return File::open(part(), true);
  }
};

CheckpointWriter::CheckpointWriter(MPI_Comm comm, const std::filesystem::path& path,
                                   const Provenance& provenance) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  state_.reset(new State{comm, path, {path.string() + ".part", rank == 0}, {}});
  on_rank_0(comm, [&] {
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
  on_rank_0(state_->comm, [&] {
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

/// The checksum of one component of this rank's cells, given in file order box by box.
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
  on_rank_0(comm, [&] {
    std::vector<hsize_t> shape{hsize_t(n[2]), hsize_t(n[1]), hsize_t(n[0])};
    if (components > 1) shape.insert(shape.begin(), components);
    File file = state_->open_to_add(std::uint64_t(components) * n[0] * n[1] * n[2] * sizeof(T));
    file.create_contiguous(full, cell_type<T>(), shape);
    file.close();
  });
  const SlabExchange slabs(comm, n, boxes);
  std::optional<File> file;
  Handle dataset;
  together(comm, [&] { file.emplace(File::open_parallel(comm, state_->part(), true)); });
  together(comm, [&] { dataset = file->dataset(full); });
  std::uint64_t mine = 0, sum = 0;
  for (int q = 0; q < components; ++q) {
    std::vector<std::byte> packed;
    together(comm, [&] {
      packed = slabs.pack(sizeof(T), [&](std::size_t box, void* out) {
        fill(q, box, static_cast<T*>(out));
        mine += box_checksum(boxes[box], n, q, sizeof(T), out);
      });
    });
    together(comm, [&] {
      slabs.write(*file, dataset, cell_type<T>(), components > 1 ? q : -1, sizeof(T), packed);
    });
  }
  dataset.close();
  together(comm, [&] { file->close(); });
  MPI_Reduce(&mine, &sum, 1, MPI_UINT64_T, MPI_SUM, 0, comm);
  state_->checksums[full] = sum;
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

namespace {

template <class T>
std::vector<T> in_order(const std::vector<T>& rows, const std::vector<std::size_t>& order) {
  std::vector<T> sorted;
  sorted.reserve(rows.size());
  for (const std::size_t i : order) sorted.push_back(rows[i]);
  return sorted;
}

void write_columns(File& file, const std::string& group, const std::vector<Column>& columns, const void* rows,
                   std::size_t row_bytes, std::size_t n) {
  file.group(group, true);
  for (const Column& c : columns) {
    const auto values = hdf5::gather_column(c, rows, row_bytes, n);
    std::vector<hsize_t> shape{n};
    if (c.components > 1) shape.push_back(c.components);
    hdf5::write_checked(file, group + "/" + c.name, c.memory_type(), shape, values.data(), values.size());
  }
}

/// Puts impulses (body after body, in rank order) into the order of the bodies.
std::vector<ImpulseRow> reordered(const std::vector<ImpulseRow>& rows,
                                  const std::vector<std::uint64_t>& counts,
                                  const std::vector<std::size_t>& order) {
  std::vector<std::size_t> first(counts.size() + 1, 0);
  std::partial_sum(counts.begin(), counts.end(), first.begin() + 1);
  std::vector<ImpulseRow> sorted;
  sorted.reserve(rows.size());
  for (const std::size_t i : order)
    sorted.insert(sorted.end(), rows.begin() + first[i], rows.begin() + first[i + 1]);
  return sorted;
}

}  // namespace

void CheckpointWriter::bodies(std::span<const rigid::BodyRecord> records,
                              std::span<const std::vector<rigid::StoredImpulse>> impulses,
                              std::span<const HolderColumn> holder) {
  std::vector<std::uint64_t> my_counts;
  std::vector<ImpulseRow> my_rows;
  together(state_->comm, [&] {
    if (records.size() != impulses.size())
      throw std::invalid_argument("a checkpoint needs one list of impulses a body record");
    for (const auto& list : impulses) {
      my_counts.push_back(list.size());
      for (const rigid::StoredImpulse& s : list)
        my_rows.push_back({s.partner,
                           {s.image.x, s.image.y, s.image.z},
                           s.feature,
                           {s.impulse[0], s.impulse[1], s.impulse[2]}});
    }
  });
  const auto all = hdf5::gather_rows(state_->comm, records);
  const auto counts = hdf5::gather_rows(state_->comm, std::span<const std::uint64_t>(my_counts));
  const auto rows = hdf5::gather_rows(state_->comm, std::span<const ImpulseRow>(my_rows));
  on_rank_0(state_->comm, [&] {
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return all[a].id < all[b].id; });
    for (std::size_t i = 1; i < order.size(); ++i)
      if (all[order[i]].id == all[order[i - 1]].id)
        throw hdf5::Error(state_->path.string() + ": body " + std::to_string(all[order[i]].id) +
                          " has two owners");
    const auto sorted = in_order(all, order);
    const auto sorted_counts = in_order(counts, order);
    const auto sorted_rows = reordered(rows, counts, order);
    File file = state_->open_to_add(sorted.size() * sizeof(rigid::BodyRecord) +
                                    sorted_rows.size() * sizeof(ImpulseRow));
    write_columns(file, "/bodies", hdf5::record_columns(holder), sorted.data(), sizeof(rigid::BodyRecord),
                  sorted.size());
    hdf5::write_checked(file, "/bodies/impulse_count", H5T_STD_U64LE, {sorted_counts.size()},
                        sorted_counts.data(), sorted_counts.size() * sizeof(std::uint64_t));
    write_columns(file, "/impulses", hdf5::impulse_columns(), sorted_rows.data(), sizeof(ImpulseRow),
                  sorted_rows.size());
    file.close();
  });
}

void CheckpointWriter::commit(int keep) {
  on_rank_0(state_->comm, [&] {
    File file = state_->open_to_add(0);
    for (const auto& [name, checksum] : state_->checksums)
      file.attribute(file.dataset(name), "checksum", checksum);
    file.attribute(file.group("/", false), "complete", std::int64_t{1});
    file.close();
    hdf5::sync_to_disk(state_->part());
  });
  hdf5::verify_checkpoint(state_->comm, state_->part());
  on_rank_0(state_->comm, [&] {
    state_->temporary.rename_to(state_->path);
    drop_old_checkpoints(state_->path, keep);
  });
}

}  // namespace silt::adapters
