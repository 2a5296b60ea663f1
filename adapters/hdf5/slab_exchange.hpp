#pragma once
// Private to adapters/hdf5: this rank's boxes of a dataset [q][z][y][x][c], [z][y][x][c] or [z][y][x].
//
// Blocks are scattered over the file in short rows. MPI-IO can sort that out by itself (two-phase I/O), but
// spends several times the time of the disk on it. So the ranks first swap rows such that each holds a slab
// of whole rows of the lattice, one after the other, and then each writes (reads) its slab in at most three
// pieces:
//
//   boxes  --pack-->  rows by z, y, x  --SliceExchange-->  lattice rows ny nz r / ranks .. ny nz (r + 1) /
//   ranks
#include <functional>
#include <optional>
#include <vector>

#include "adapters/hdf5/boxes.hpp"
#include "adapters/hdf5/file.hpp"
#include "adapters/hdf5/slice_exchange.hpp"

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
  /// rank's own: wrap it in together(). A dataset that is compressed must be written `at_once`, by all ranks
  /// in one call.
  void write(const File&, hid_t dataset, hid_t type, int leading, std::size_t element,
             std::vector<std::byte> packed, bool at_once = false) const;
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
  void write_at_once(const File&, hid_t dataset, hid_t type, int leading, const std::byte* slab) const;
  template <class Act>
  void for_pieces(const File&, hid_t dataset, int leading, Act&&) const;

  MPI_Comm comm_;
  std::array<int, 3> lattice_;
  std::vector<CellBox> boxes_;
  std::vector<Row> rows_;  // by z, y, x
  std::size_t cells_ = 0;
  std::optional<SliceExchange> slices_;
};

}  // namespace silt::adapters::hdf5
