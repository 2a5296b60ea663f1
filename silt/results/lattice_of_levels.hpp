#pragma once
// Fields of cells of several widths on a lattice of one width: a wide cell's value is repeated in the narrow
// ones that fill it, and narrow ones give a wide one the mean of those of them that there are.
#include <vector>

#include "adapters/hdf5/field_file.hpp"

namespace silt {

/// The boxes of cells of a level that this rank has, in cells of that level.
struct LevelBoxes {
  int width = 1;  // of its cells, in those of the finest lattice
  std::vector<adapters::CellBox> boxes;
};

/// Returns the box of cells of one width that have a part in a box of cells of another.
adapters::CellBox in_cells_of(int width, const adapters::CellBox&, int other_width);

class LatticeOfLevels {
 public:
  /// Makes a lattice of cells of this width from the parts of the boxes in `within`, which counts in such
  /// cells.
  LatticeOfLevels(const std::vector<LevelBoxes>&, int width, const adapters::CellBox& within);

  /// Returns the boxes of the lattice, level by level.
  const std::vector<adapters::CellBox>& boxes() const { return boxes_; }
  /// Returns a quantity on the boxes of the lattice from the same quantity on the boxes of each level.
  adapters::FieldQuantity quantity(std::vector<adapters::FieldQuantity> of_levels) const;

 private:
  struct Source {  // of a box
    std::size_t level, box;
    int width;
    adapters::CellBox cells;
  };
  int width_;
  std::vector<adapters::CellBox> boxes_;
  std::vector<Source> sources_;
};

}  // namespace silt
