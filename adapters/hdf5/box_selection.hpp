#pragma once
// Private to adapters/hdf5: this rank's boxes of a dataset [q][z][y][x][c], [z][y][x][c] or [z][y][x], moved by one
// collective call.
#include <functional>
#include <span>
#include <vector>

#include "adapters/hdf5/boxes.hpp"
#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

/// The order in which one collective call visits the cells of several boxes (rows by z, y, x: HDF5's order for a
/// union), against the order a caller has them in (box after box).
class BoxSelection {
 public:
  /// cells: of the whole lattice. Throws std::invalid_argument for a box outside it.
  BoxSelection(std::array<int, 3> cells, std::vector<CellBox> boxes);

  std::size_t cells() const { return cells_; }
  const std::vector<CellBox>& boxes() const { return boxes_; }

  /// Calls fill(box, buffer) for every box and returns all cells in file order; element: bytes a cell.
  std::vector<std::byte> pack(std::size_t element, const std::function<void(std::size_t, void*)>& fill) const;
  /// The reverse: hands each box its cells.
  void unpack(const std::vector<std::byte>& packed, std::size_t element,
              const std::function<void(std::size_t, const void*)>& take) const;

  /// Collective; `leading` (a population's number) selects one slab of a dataset with such a first axis, -1: none.
  void write(const File&, hid_t dataset, hid_t type, int leading, const void* packed) const;
  void read(const File&, hid_t dataset, hid_t type, int leading, void* packed) const;

 private:
  struct Row {
    int z, y, x;
    std::size_t length, box, offset;  // offset: in cells, within the box
  };
  Handle file_space(const File&, hid_t dataset, int leading) const;
  std::vector<CellBox> boxes_;
  std::vector<Row> rows_;
  std::size_t cells_ = 0;
};

}  // namespace silt::adapters::hdf5
