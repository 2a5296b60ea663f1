#include "adapters/hdf5/slab_exchange.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <tuple>

#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters::hdf5 {

SlabExchange::SlabExchange(MPI_Comm comm, std::array<int, 3> cells, std::vector<CellBox> boxes)
    : lattice_(cells), boxes_(std::move(boxes)) {
  std::vector<SliceExchange::Run> mine;
  parallel::together(comm, [&] { mine = list_rows(); });
  const std::uint64_t row = lattice_[0];
  slices_.emplace(comm, row * lattice_[1] * lattice_[2], mine, row);
}

SlabExchange::SlabExchange(MPI_Comm comm, std::vector<CellBox> boxes) : boxes_(std::move(boxes)) {
  for (const CellBox& box : boxes_) cells_ += box.cells();
  const std::uint64_t first = parallel::sum_of_ranks_before(comm, std::uint64_t(cells_)),
                      all = parallel::sum_over_ranks(comm, std::uint64_t(cells_));
  std::vector<SliceExchange::Run> mine;
  if (cells_ > 0) mine.push_back({first, cells_});
  slices_.emplace(comm, all, mine);
}

/// Lists the rows of the boxes in file order; returns their positions in the lattice.
std::vector<SliceExchange::Run> SlabExchange::list_rows() {
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    const CellBox& box = boxes_[b];
    for (int d = 0; d < 3; ++d)
      if (box.lower[d] < 0 || box.size[d] < 0 || box.lower[d] + box.size[d] > lattice_[d])
        throw std::invalid_argument("box " + std::to_string(b) + " reaches outside the lattice of " +
                                    std::to_string(lattice_[0]) + " x " + std::to_string(lattice_[1]) +
                                    " x " + std::to_string(lattice_[2]) + " cells");
    if (box.cells() == 0) continue;
    const std::size_t length = box.size.x;
    std::size_t offset = 0;
    for_cells(box.lower, box.lower + lbm::Int3{1, box.size.y, box.size.z}, [&](lbm::Int3 first) {
      rows_.push_back({first, length, b, offset});
      offset += length;
    });
    cells_ += box.cells();
  }
  std::sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) {
    return std::tie(a.first.z, a.first.y, a.first.x) < std::tie(b.first.z, b.first.y, b.first.x);
  });
  std::vector<SliceExchange::Run> runs;
  for (const Row& row : rows_)
    append_run(runs, {(std::uint64_t(row.first.z) * lattice_[1] + row.first.y) * lattice_[0] + row.first.x,
                      row.length});
  return runs;
}

std::vector<std::byte> SlabExchange::pack(std::size_t element,
                                          const std::function<void(std::size_t, void*)>& fill) const {
  std::vector<std::byte> packed(cells_ * element);
  std::byte* out = packed.data();
  std::vector<std::vector<std::byte>> of_box(boxes_.size());
  const bool in_order = boxes_.size() == 1 || rows_.empty();
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    const std::size_t bytes = boxes_[b].cells() * element;
    if (bytes == 0) continue;
    if (!in_order) of_box[b].resize(bytes);
    fill(b, in_order ? out : of_box[b].data());
    if (in_order) out += bytes;
  }
  if (in_order) return packed;
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

TileRuns runs_of_tiles(MPI_Comm comm, const ListedTiles& tiles) {
  const SlabExchange slabs(comm, tiles.lattice, {tiles.box});
  const auto bytes = std::as_bytes(tiles.counts);
  const auto slab = slabs.slices().to_slice(sizeof(std::uint32_t), {bytes.begin(), bytes.end()});
  std::vector<std::uint32_t> counts_here(slab.size() / sizeof(std::uint32_t));
  std::memcpy(counts_here.data(), slab.data(), slab.size());
  const std::uint64_t sum = std::accumulate(counts_here.begin(), counts_here.end(), std::uint64_t{0});
  TileRuns runs{parallel::sum_over_ranks(comm, sum), {}};
  std::uint64_t first = parallel::sum_of_ranks_before(comm, sum);
  std::vector<std::byte> firsts(counts_here.size() * sizeof first);
  for (std::size_t tile = 0; tile < counts_here.size(); first += counts_here[tile++])
    std::memcpy(&firsts[tile * sizeof first], &first, sizeof first);
  firsts = slabs.slices().from_slice(sizeof first, firsts);
  for (std::size_t tile = 0; tile < tiles.counts.size(); ++tile) {
    std::memcpy(&first, &firsts[tile * sizeof first], sizeof first);
    if (tiles.counts[tile] > 0) append_run(runs.mine, {first, tiles.counts[tile]});
  }
  return runs;
}

}  // namespace silt::adapters::hdf5
