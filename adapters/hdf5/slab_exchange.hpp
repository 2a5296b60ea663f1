#pragma once
// Private to adapters/hdf5: this rank's boxes of a dataset [q][z][y][x][c], [z][y][x][c] or [z][y][x].
//
// Blocks are scattered over the file in short rows. So the ranks first swap rows such that each holds a slab
// of whole rows of the lattice, one after the other, and then each writes its slab in one piece (reads it in
// at most three):
//
//   boxes  --pack-->  rows by z, y, x  --SliceExchange-->  lattice rows ny nz r / ranks .. ny nz (r + 1) /
//   ranks
#include <functional>
#include <optional>
#include <vector>

#include "adapters/hdf5/boxes.hpp"
#include "adapters/hdf5/shared_file.hpp"
#include "adapters/hdf5/slice_exchange.hpp"

namespace silt::adapters::hdf5 {

class SlabExchange {
 public:
  /// Plans the exchange; collective. `cells` are those of the whole lattice. Slabs are cut between groups of
  /// rows of a plane; zeros fill the last group of a plane. Throws on every rank if any has a box outside the
  /// lattice.
  SlabExchange(MPI_Comm, std::array<int, 3> cells, std::vector<CellBox> boxes, int group_rows = 1);

  const std::vector<CellBox>& boxes() const { return boxes_; }
  /// Returns the number of cells of this rank's boxes.
  std::size_t cells() const { return cells_; }

  /// Packs this rank's cells (local): calls fill(box, buffer) for every box that is not empty, a box's cells
  /// with x fastest, and returns all cells by z, y, x. `element` is the number of bytes a cell.
  std::vector<std::byte> pack(std::size_t element, const std::function<void(std::size_t, void*)>& fill) const;
  /// Reverses pack (local): hands each box its cells.
  void unpack(const std::vector<std::byte>& packed, std::size_t element,
              const std::function<void(std::size_t, const void*)>& take) const;

  /// Returns this rank's slab of the packed cells of all, whole groups of rows; zero where no rank holds a
  /// cell. Collective.
  std::vector<std::byte> slab(std::size_t element, std::vector<std::byte> packed) const {
    return slices_->to_slice(element, std::move(packed));
  }
  std::size_t group_cells() const { return std::size_t(lattice_[0]) * group_rows_; }
  /// Returns the communicator of the exchange.
  MPI_Comm comm() const { return slices_->comm(); }

  /// Writes the packed cells into a contiguous dataset whose values begin at the byte `place`; collective,
  /// and an error is every rank's.
  void write(SharedFile&, std::uint64_t place, std::size_t element, std::vector<std::byte> packed) const;
  /// Reads what unpack takes; collective.
  std::vector<std::byte> read(const File&, hid_t dataset, hid_t type, int leading, std::size_t element) const;

 private:
  struct Row {
    int z, y, x;
    std::size_t length, box, offset;  // offset: in cells, within the box
  };
  void list_rows();
  std::vector<SliceExchange::Run> runs() const;
  /// Calls act(memory, space, first) for the pieces of the slab: a part of a plane, whole planes, a part of a
  /// plane; `first` is the first cell in the slab.
  template <class Act>
  void for_pieces(const File&, hid_t dataset, int leading, Act&&) const;

  MPI_Comm comm_;
  std::array<int, 3> lattice_;
  int group_rows_, plane_rows_;  // of a plane with its last group filled up
  std::vector<CellBox> boxes_;
  std::vector<Row> rows_;  // by z, y, x
  std::size_t cells_ = 0;
  std::optional<SliceExchange> slices_;
};

}  // namespace silt::adapters::hdf5
