#pragma once
// Trees of cuts that look at nothing but the size of the box, and the room that any cut has to leave.
#include "lbm/blocks/cut_tree.hpp"

namespace silt::lbm {

/// A part of so many cells may be cut into two with so many leaves each, across any of some axes. `edge` is
/// the least edge of a leaf; along an axis where the part is thinner than that it is not cut.
struct CutRoom {
  int lower_leaves, upper_leaves, edge;

  /// The positions, first to last from the lower end of the part, at which a plane leaves both parts the room
  /// for their leaves: none if last < first.
  struct Range {
    int first, last;
    bool empty() const { return last < first; }
  };
  Range along(int axis, Int3 size) const;
};

/// Half of the leaves below and half above, or as near to that as there is room: for leaves of that edge, or
/// of the largest that fits. std::invalid_argument for fewer than 2 cells.
inline constexpr int usual_edge = 8;
CutRoom room_to_cut(Int3 size, int leaves, int edge = usual_edge);

/// Returns what a cut across an axis costs, per cell of its face: across x double, as short rows are slow.
double cost_of_face(int axis);

/// Makes so many leaves of about the same size, cut across the longest edge, and x last.
/// std::invalid_argument where leaves would have fewer than 2 cells an edge.
CutTree equal_cut(Int3 cells, int leaves);

/// Makes a grid of leaves of about so many cells along each axis; their number is rounded up.
CutTree grid_cut(Int3 cells, Int3 leaf_cells);

}  // namespace silt::lbm
