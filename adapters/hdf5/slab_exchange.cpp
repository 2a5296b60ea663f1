#include "adapters/hdf5/slab_exchange.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <tuple>

#include "adapters/hdf5/together.hpp"

namespace silt::adapters::hdf5 {

SlabExchange::SlabExchange(MPI_Comm comm, std::array<int, 3> cells, std::vector<CellBox> boxes)
    : comm_(comm), lattice_(cells), boxes_(std::move(boxes)) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &ranks_);
  together(comm, [&] { list_rows(); });
  swap_pieces();
}

void SlabExchange::list_rows() {
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    const CellBox& box = boxes_[b];
    for (int d = 0; d < 3; ++d)
      if (box.lower[d] < 0 || box.upper[d] > lattice_[d] || box.lower[d] > box.upper[d])
        throw std::invalid_argument("box " + std::to_string(b) + " reaches outside the lattice of " +
                                    std::to_string(lattice_[0]) + " x " + std::to_string(lattice_[1]) +
                                    " x " + std::to_string(lattice_[2]) + " cells");
    if (box.cells() == 0) continue;
    const std::size_t length = box.upper[0] - box.lower[0];
    std::size_t offset = 0;
    for (int z = box.lower[2]; z < box.upper[2]; ++z)
      for (int y = box.lower[1]; y < box.upper[1]; ++y, offset += length)
        rows_.push_back({z, y, box.lower[0], length, b, offset});
    cells_ += box.cells();
  }
  std::sort(rows_.begin(), rows_.end(),
            [](const Row& a, const Row& b) { return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x); });
}

namespace {
std::vector<int> offsets_of(const std::vector<int>& counts) {
  std::vector<int> offsets(counts.size(), 0);
  std::partial_sum(counts.begin(), counts.end() - 1, offsets.begin() + 1);
  return offsets;
}
/// Bytes is a datatype of so many bytes that frees itself.
struct Bytes {
  MPI_Datatype type;
  explicit Bytes(std::size_t n) {
    MPI_Type_contiguous(static_cast<int>(n), MPI_BYTE, &type);
    MPI_Type_commit(&type);
  }
  ~Bytes() { MPI_Type_free(&type); }
};
}  // namespace

/// Tells every rank where in its slab the rows go that it will get.
void SlabExchange::swap_pieces() {
  sent_.assign(ranks_, 0);
  received_.assign(ranks_, 0);
  std::vector<int> sent_pieces(ranks_, 0), received_pieces(ranks_, 0);
  std::vector<Piece> mine;
  for (const Row& row : rows_) {
    const int to = static_cast<int>(((row.z + std::int64_t{1}) * ranks_ - 1) / lattice_[2]);
    const std::size_t plane = row.z - slab_begin(to);
    mine.push_back({(plane * lattice_[1] + row.y) * lattice_[0] + row.x, row.length});
    ++sent_pieces[to];
    sent_[to] += static_cast<int>(row.length);
  }
  MPI_Alltoall(sent_pieces.data(), 1, MPI_INT, received_pieces.data(), 1, MPI_INT, comm_);
  MPI_Alltoall(sent_.data(), 1, MPI_INT, received_.data(), 1, MPI_INT, comm_);
  pieces_.resize(std::accumulate(received_pieces.begin(), received_pieces.end(), std::size_t{0}));
  const Bytes piece(sizeof(Piece));
  MPI_Alltoallv(mine.data(), sent_pieces.data(), offsets_of(sent_pieces).data(), piece.type, pieces_.data(),
                received_pieces.data(), offsets_of(received_pieces).data(), piece.type, comm_);
}

std::size_t SlabExchange::slab_cells() const {
  return std::size_t(slab_begin(rank_ + 1) - slab_begin(rank_)) * lattice_[1] * lattice_[0];
}

std::vector<std::byte> SlabExchange::pack(std::size_t element,
                                          const std::function<void(std::size_t, void*)>& fill) const {
  std::vector<std::vector<std::byte>> of_box(boxes_.size());
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    of_box[b].resize(boxes_[b].cells() * element);
    if (!of_box[b].empty()) fill(b, of_box[b].data());
  }
  if (boxes_.size() == 1) return std::move(of_box[0]);
  std::vector<std::byte> packed(cells_ * element);
  std::byte* out = packed.data();
  for (const Row& row : rows_) {
    std::memcpy(out, of_box[row.box].data() + row.offset * element, row.length * element);
    out += row.length * element;
  }
  return packed;
}

void SlabExchange::unpack(const std::vector<std::byte>& packed, std::size_t element,
                          const std::function<void(std::size_t, const void*)>& take) const {
  std::vector<std::vector<std::byte>> of_box(boxes_.size());
  for (std::size_t b = 0; b < boxes_.size(); ++b) of_box[b].resize(boxes_[b].cells() * element);
  const std::byte* in = packed.data();
  for (const Row& row : rows_) {
    std::memcpy(of_box[row.box].data() + row.offset * element, in, row.length * element);
    in += row.length * element;
  }
  for (std::size_t b = 0; b < boxes_.size(); ++b)
    if (!of_box[b].empty()) take(b, of_box[b].data());
}

std::vector<std::byte> SlabExchange::swap(bool to_slabs, std::size_t element,
                                          const std::vector<std::byte>& values) const {
  const std::vector<int>&from = to_slabs ? sent_ : received_, &to = to_slabs ? received_ : sent_;
  std::vector<std::byte> swapped(std::accumulate(to.begin(), to.end(), std::size_t{0}) * element);
  const Bytes cell(element);
  MPI_Alltoallv(values.data(), from.data(), offsets_of(from).data(), cell.type, swapped.data(), to.data(),
                offsets_of(to).data(), cell.type, comm_);
  return swapped;
}

Handle SlabExchange::file_space(const File& file, hid_t dataset, int leading) const {
  Handle space(H5Dget_space(dataset), H5Sclose, file.path(), "shape of a dataset");
  std::vector<hsize_t> count = file.shape(dataset);
  std::vector<hsize_t> start(count.size(), 0);
  if (leading >= 0) {
    start[0] = leading;
    count[0] = 1;
  }
  const std::size_t z = leading >= 0 ? 1 : 0;
  start[z] = slab_begin(rank_);
  count[z] = slab_begin(rank_ + 1) - slab_begin(rank_);
  file.check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
             "cannot select a slab");
  return space;
}

void SlabExchange::write(const File& file, hid_t dataset, hid_t type, int leading, std::size_t element,
                         const std::vector<std::byte>& packed) const {
  const auto arrived = swap(true, element, packed);
  std::vector<std::byte> slab(slab_cells() * element);
  const std::byte* in = arrived.data();
  for (const Piece& p : pieces_) {
    std::memcpy(slab.data() + p.first * element, in, p.length * element);
    in += p.length * element;
  }
  if (slab.empty()) return;
  const Handle space = file_space(file, dataset, leading);
  const hsize_t numbers = H5Sget_select_npoints(space);
  const Handle memory(H5Screate_simple(1, &numbers, nullptr), H5Sclose, file.path(), "memory shape");
  file.check(H5Dwrite(dataset, type, memory, space, H5P_DEFAULT, slab.data()),
             "cannot write (is the disk full?)");
}

std::vector<std::byte> SlabExchange::read(const File& file, hid_t dataset, hid_t type, int leading,
                                          std::size_t element) const {
  std::vector<std::byte> slab(slab_cells() * element);
  together(comm_, [&] {
    if (slab.empty()) return;
    const Handle space = file_space(file, dataset, leading);
    const hsize_t numbers = H5Sget_select_npoints(space);
    const Handle memory(H5Screate_simple(1, &numbers, nullptr), H5Sclose, file.path(), "memory shape");
    file.check(H5Dread(dataset, type, memory, space, H5P_DEFAULT, slab.data()), "cannot read");
  });
  std::vector<std::byte> leaving;
  leaving.reserve(std::accumulate(received_.begin(), received_.end(), std::size_t{0}) * element);
  for (const Piece& p : pieces_) {
    const std::byte* from = slab.data() + p.first * element;
    leaving.insert(leaving.end(), from, from + p.length * element);
  }
  return swap(false, element, leaving);
}

}  // namespace silt::adapters::hdf5
