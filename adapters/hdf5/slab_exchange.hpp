#pragma once
// Private to adapters/hdf5: this rank's boxes of a dataset [q][z][y][x][c], [z][y][x][c] or [z][y][x].
//
// Blocks are scattered over the file in short rows. MPI-IO can sort that out by itself (two-phase I/O), but
// spends several times the time of the disk on it. So the ranks first swap rows such that each holds a slab
// of whole planes, and then each writes (reads) its slab in one piece:
//
//   boxes  --pack-->  rows by z, y, x  --MPI_Alltoallv-->  planes nz r / ranks .. nz (r + 1) / ranks
#include <functional>
#include <vector>

#include "adapters/hdf5/boxes.hpp"
#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

class SlabExchange {
 public:
  /// Plans the exchange; collective. `cells` are those of the whole lattice. Throws on every rank if any has
  /// a box outside it.
  SlabExchange(MPI_Comm, std::array<int, 3> cells, std::vector<CellBox> boxes);

  const std::vector<CellBox>& boxes() const { return boxes_; }
  /// Returns the number of cells of this rank's boxes.
  std::size_t cells() const { return cells_; }

  /// Packs this rank's cells (local): calls fill(box, buffer) for every box that is not empty, a box's cells
  /// with x fastest, and returns all cells by z, y, x. `element` is the number of bytes a cell.
  std::vector<std::byte> pack(std::size_t element, const std::function<void(std::size_t, void*)>& fill) const;
  /// Reverses pack (local): hands each box its cells.
  void unpack(const std::vector<std::byte>& packed, std::size_t element,
              const std::function<void(std::size_t, const void*)>& take) const;

  /// Writes the packed cells; collective. `leading` (a population's number) selects one slab of a dataset
  /// with such a first axis, -1: none. Cells that no rank holds become zero. The error of a full disk is this
  /// rank's own: wrap it in together().
  void write(const File&, hid_t dataset, hid_t type, int leading, std::size_t element,
             const std::vector<std::byte>& packed) const;
  /// Reads what unpack takes; collective.
  std::vector<std::byte> read(const File&, hid_t dataset, hid_t type, int leading, std::size_t element) const;

 private:
  struct Row {
    int z, y, x;
    std::size_t length, box, offset;  // offset: in cells, within the box
  };
  struct Piece {                // of a row, in the slab
    std::size_t first, length;  // cells
  };
  void list_rows();
  void swap_pieces();
  int slab_begin(int rank) const { return static_cast<int>(std::int64_t{lattice_[2]} * rank / ranks_); }
  std::size_t slab_cells() const;
  /// Moves a value a cell: from boxes to slabs, or back.
  std::vector<std::byte> swap(bool to_slabs, std::size_t element, const std::vector<std::byte>&) const;
  Handle file_space(const File&, hid_t dataset, int leading) const;

  MPI_Comm comm_;
  int rank_ = 0, ranks_ = 1;
  std::array<int, 3> lattice_;
  std::vector<CellBox> boxes_;
  std::vector<Row> rows_;  // by z, y, x: so they are also by the rank whose slab they go to
  std::size_t cells_ = 0;
  std::vector<int> sent_, received_;  // cells to and from each rank
  std::vector<Piece> pieces_;         // of the slab, rank by rank in the order they arrive
};

}  // namespace silt::adapters::hdf5
