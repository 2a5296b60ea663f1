#include "adapters/hdf5/packed_chunks.hpp"

#include <zlib.h>

#include <new>

#include "parallel/together.hpp"
#include "parallel/transfers.hpp"

namespace silt::adapters::hdf5 {

namespace {

/// Returns a chunk as HDF5's filters "shuffle" and "deflate" make it: first bytes of all values, then second
/// ones, and so on, packed.
std::vector<std::byte> packed_chunk(const std::byte* values, std::size_t bytes, std::size_t value_bytes,
                                    int level) {
  const std::size_t n = bytes / value_bytes;
  std::vector<std::byte> shuffled(bytes), packed(compressBound(bytes));
  for (std::size_t b = 0; b < value_bytes; ++b)
    for (std::size_t i = 0; i < n; ++i) shuffled[b * n + i] = values[i * value_bytes + b];
  uLongf size = packed.size();
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(shuffled.data()), bytes, level) != Z_OK)
    throw std::bad_alloc();  // there is no other reason
  packed.resize(size);
  return packed;
}

/// Writes chunks one after the other, plane by plane.
class ChunkWriter {
 public:
  ChunkWriter(const File& file, const std::string& name, hsize_t chunk_rows)
      : file_(file), dataset_(file.dataset(name)), chunk_rows_(chunk_rows) {
    const auto shape = file.shape(dataset_);
    at_.resize(shape.size());
    rows_ = shape[1];
  }
  void write(const std::byte* chunk, std::size_t bytes) {
    file_.check(H5Dwrite_chunk(dataset_, H5P_DEFAULT, 0, at_.data(), bytes, chunk),
                "cannot write (is the disk full?)");
    at_[1] += chunk_rows_;
    if (at_[1] < rows_) return;
    at_[1] = 0;
    ++at_[0];
  }

 private:
  const File& file_;
  Handle dataset_;
  hsize_t chunk_rows_, rows_ = 0;
  std::vector<hsize_t> at_;
};

constexpr int chunks_tag = 1;  // SliceExchange has 0

void send_to_rank_0(parallel::Transfers& transfers, const std::vector<std::vector<std::byte>>& chunks) {
  for (const auto& chunk : chunks) {
    transfers.send(0, std::span(chunk));
    transfers.wait();
  }
  transfers.send(0, std::span<const std::byte>());
  transfers.wait();
}

/// Calls take(chunk, bytes) for the chunks that a rank sends. `room` has space for any of them.
template <class Take>
void receive_from(parallel::Transfers& transfers, int rank, std::vector<std::byte>& room, Take&& take) {
  for (std::size_t bytes = 1; bytes > 0;) {
    transfers.receive(rank, std::span(room));
    transfers.wait();
    bytes = transfers.bytes_received(0);
    if (bytes > 0) take(room.data(), bytes);
  }
}

}  // namespace

Handle create_packed(const File& file, const std::string& name, hid_t type, const std::vector<hsize_t>& shape,
                     Packing packing) {
  std::vector<hsize_t> chunk = shape;
  chunk[0] = 1, chunk[1] = packing.chunk_rows;
  const int rank = static_cast<int>(shape.size());
  const Handle space(H5Screate_simple(rank, shape.data(), nullptr), H5Sclose, file.path(),
                     "shape of " + name);
  const Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, file.path(), "properties of " + name);
  H5Pset_obj_track_times(list, false);
  H5Pset_chunk(list, rank, chunk.data());
  H5Pset_fill_time(list, H5D_FILL_TIME_NEVER);
  H5Pset_shuffle(list);
  H5Pset_deflate(list, static_cast<unsigned>(packing.level));
  return {H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, list, H5P_DEFAULT), H5Dclose, file.path(),
          "cannot create dataset " + name};
}

void write_packed(MPI_Comm comm, const SlabExchange& slabs, const File* file, const std::string& name,
                  Packing packing, std::size_t value_bytes, std::size_t element,
                  std::vector<std::byte> values) {
  const int ranks = parallel::ranks_of(comm);
  const std::size_t chunk_bytes = slabs.group_cells() * element;
  std::vector<std::byte> slab = slabs.slab(element, std::move(values)), room;
  std::vector<std::vector<std::byte>> chunks;
  std::optional<ChunkWriter> writer;
  parallel::Transfers transfers(slabs.comm(), chunks_tag);
  parallel::together(comm, [&] {
    for (std::size_t first = 0; first < slab.size(); first += chunk_bytes)
      chunks.push_back(packed_chunk(slab.data() + first, chunk_bytes, value_bytes, packing.level));
    std::vector<std::byte>().swap(slab);
    transfers.reserve(1);
    if (!file) return;
    room.resize(compressBound(chunk_bytes));
    writer.emplace(*file, name, packing.chunk_rows);
  });
  if (!file) send_to_rank_0(transfers, chunks);
  parallel::together(comm, [&] {
    std::exception_ptr failed;
    const auto write = [&](const std::byte* chunk, std::size_t bytes) {
      if (failed) return;  // the others are still sending
      try {
        writer->write(chunk, bytes);
      } catch (...) {
        failed = std::current_exception();
      }
    };
    if (!file) return;
    for (const auto& chunk : chunks) write(chunk.data(), chunk.size());
    for (int from = 1; from < ranks; ++from) receive_from(transfers, from, room, write);
    if (failed) std::rethrow_exception(failed);
  });
}

}  // namespace silt::adapters::hdf5
