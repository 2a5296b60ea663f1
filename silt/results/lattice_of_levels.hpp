#pragma once
// Fields of cells of several widths on a lattice of one width: narrow cells repeat the value of the wide cell
// they lie in, wide cells take the mean of the narrow cells in them.
#include <vector>

#include "adapters/hdf5/field_file.hpp"

namespace silt {

/// The boxes of this rank's cells of a level, in cells of the level.
struct LevelBoxes {
  int width = 1;  // of the cells, in finest cells
  std::vector<adapters::CellBox> boxes;
};

/// Returns the box of cells of one width that overlap a box of cells of another width.
adapters::CellBox in_cells_of(int width, const adapters::CellBox&, int other_width);

class LatticeOfLevels {
 public:
  /// Makes a lattice of cells of this width over the boxes inside `within`, which is in such cells.
  LatticeOfLevels(const std::vector<LevelBoxes>&, int width, const adapters::CellBox& within);

  /// Returns the boxes of the lattice, level by level.
  const std::vector<adapters::CellBox>& boxes() const { return boxes_; }
  /// Converts a quantity on the boxes of each level to the boxes of the lattice.
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
