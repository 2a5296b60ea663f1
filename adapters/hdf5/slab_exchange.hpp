#pragma once
// Private to adapters/hdf5: redistribution of boxes of cells of an array [z][y][x], or of a list of the cells
// of all boxes, with one or more numbers per cell.
//
// The rows of a block are short and scattered over the file. So the ranks first exchange rows such that each
// has a slab of whole lattice rows, and then write or read it contiguously:
//
//   boxes  --pack-->  rows by z, y, x  --SliceExchange-->  lattice rows ny nz r / ranks to
//                                                          ny nz (r + 1) / ranks
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "adapters/hdf5/result_file.hpp"
#include "adapters/hdf5/slice_exchange.hpp"

namespace silt::adapters::hdf5 {

class SlabExchange {
 public:
  /// Collective. `cells`: of the lattice. Throws on every rank for a box outside the lattice.
  SlabExchange(MPI_Comm, std::array<int, 3> cells, std::vector<CellBox> boxes);
  /// Plans the exchange of a list: the boxes of all ranks in rank order.
  SlabExchange(MPI_Comm, std::vector<CellBox> boxes);

  const std::vector<CellBox>& boxes() const { return boxes_; }

  /// Packs this rank's cells (local): calls fill(box, buffer) for every nonempty box, x fastest, and returns
  /// all cells by z, y, x (for a list, box after box). `element`: bytes per cell.
  std::vector<std::byte> pack(std::size_t element, const std::function<void(std::size_t, void*)>& fill) const;
  /// The inverse of pack (local): calls take(box, cells).
  void unpack(const std::vector<std::byte>& packed, std::size_t element,
              const std::function<void(std::size_t, const void*)>& take) const;

  /// Returns the exchange of the packed cells. A slice is a slab of whole rows, zero for cells of no rank.
  const SliceExchange& slices() const { return *slices_; }

 private:
  struct Row {
    lbm::Int3 first;
    std::size_t length, box, offset;  // offset: in cells, within the box
  };
  std::vector<SliceExchange::Run> list_rows();

  std::array<int, 3> lattice_{};
  std::vector<CellBox> boxes_;
  std::vector<Row> rows_;  // by z, y, x; empty for a list
  std::size_t cells_ = 0;
  std::optional<SliceExchange> slices_;
};

/// The positions of this rank's tiles' entries in a list over all tiles, by z, y, x of the tile.
struct TileRuns {
  std::uint64_t total = 0;  // entries of all tiles
  std::vector<SliceExchange::Run> mine;
};

TileRuns runs_of_tiles(MPI_Comm, const ListedTiles&);  // collective

}  // namespace silt::adapters::hdf5
