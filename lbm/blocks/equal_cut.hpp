#pragma once
// Cuts of a box by its size alone, and the room that every cut must leave for leaves.
#include "lbm/blocks/cut_tree.hpp"

namespace silt::lbm {

/// The ways to cut a part in two, with these numbers of leaves below and above the plane. `edge` is the least
/// edge of a leaf in cells; an axis along which the part is thinner than two leaves is not cut.
struct CutRoom {
  int lower_leaves, upper_leaves, edge;

  /// The positions of a plane, in cells from the lower end of the part, that leave both parts room for their
  /// leaves; none if last < first.
  struct Range {
    int first, last;
    bool empty() const { return last < first; }
  };
  Range along(int axis, Int3 size) const;
};

/// Returns the cut of a part with the most even numbers of leaves, at most half of them below, for leaves of
/// this edge or the largest that fits. Throws std::invalid_argument where that is below 2 cells.
inline constexpr int usual_edge = 8;
CutRoom room_to_cut(Int3 size, int leaves, int edge = usual_edge);

/// Returns the relative cost of a cell of a face across an axis: 2 across x, since short rows are slow.
double cost_of_face(int axis);

/// Makes `leaves` leaves of about equal size; cuts across the longest edge, and across x last. Throws
/// std::invalid_argument if a leaf would have an edge below 2 cells.
CutTree equal_cut(Int3 cells, int leaves);

/// Makes a grid of leaves with about leaf_cells cells along each axis; rounds their number up.
CutTree grid_cut(Int3 cells, Int3 leaf_cells);

}  // namespace silt::lbm
