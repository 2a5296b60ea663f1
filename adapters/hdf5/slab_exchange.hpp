#pragma once
// Private to adapters/hdf5: this rank's boxes of an array of cells [z][y][x], or of a list of the cells of
// all boxes, which may have several numbers a cell.
//
// Blocks are scattered over the file in short rows. So the ranks first swap rows such that each holds a slab
// of whole rows of the lattice, one after the other, and then each writes or reads its slab in one piece:
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
  /// Plans the exchange; collective. `cells` are those of the whole lattice. A box outside the lattice throws
  /// on every rank.
  SlabExchange(MPI_Comm, std::array<int, 3> cells, std::vector<CellBox> boxes);
  /// Plans the exchange of a list: the boxes of the ranks one after the other.
  SlabExchange(MPI_Comm, std::vector<CellBox> boxes);

  const std::vector<CellBox>& boxes() const { return boxes_; }

  /// Packs this rank's cells (local): calls fill(box, buffer) for every box that is not empty, a box's cells
  /// with x fastest, and returns all cells by z, y, x (of a list, box after box). `element`: bytes a cell.
  std::vector<std::byte> pack(std::size_t element, const std::function<void(std::size_t, void*)>& fill) const;
  /// Reverses pack (local): hands each box its cells.
  void unpack(const std::vector<std::byte>& packed, std::size_t element,
              const std::function<void(std::size_t, const void*)>& take) const;

  /// Returns the exchange of the packed cells. A slice is a slab, whole rows; zero where no rank holds a
  /// cell.
  const SliceExchange& slices() const { return *slices_; }

 private:
  struct Row {
    lbm::Int3 first;
    std::size_t length, box, offset;  // offset: in cells, within the box
  };
  std::vector<SliceExchange::Run> list_rows();

  std::array<int, 3> lattice_{};
  std::vector<CellBox> boxes_;
  std::vector<Row> rows_;  // by z, y, x; none of a list
  std::size_t cells_ = 0;
  std::optional<SliceExchange> slices_;
};

/// The places of the entries of this rank's tiles in a list of those of all tiles, by z, y, x of the tile.
struct TileRuns {
  std::uint64_t total = 0;  // entries of all tiles
  std::vector<SliceExchange::Run> mine;
};

/// Collective. The tiles of a lattice are shared by the ranks as boxes; `counts` are of those of this rank's.
TileRuns runs_of_tiles(MPI_Comm, std::array<int, 3> tiles, const CellBox& box,
                       std::span<const std::uint32_t> counts);

}  // namespace silt::adapters::hdf5
