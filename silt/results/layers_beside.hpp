#pragma once
// Interpolates cell values to a plane across an axis: finds the layers of cells beside it and their weights.
#include <cmath>

#include "coupler/fluid_fields.hpp"

namespace silt {

/// Values are linear between cell centres along the axis, also between cells of different widths, and
/// extrapolated to sides that are not periodic. Lengths are in finest cells.
class LayersBeside {
 public:
  LayersBeside(const coupler::FluidFields& fields, int axis, double at)
      : fields_(fields), axis_(axis), at_(at), cells_(fields.domain().cells()[axis]) {}

  /// Calls visit(block, its local cells, weight) for this rank's cells with a weight on the plane.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (int b = 0; b < fields_.blocks(); ++b)
      for (int k = 0; k < fields_.block(b).size[axis_]; ++k) {
        lbm::CellBox layer{{}, fields_.block(b).size};
        layer.lower[axis_] = k, layer.size[axis_] = 1;
        const double away = from_layer(fields_.block(b).lower[axis_] + k);
        if (std::abs(away) < 3 * fields_.width()) for_layer(b, layer, away, visit);
      }
  }

 private:
  bool periodic() const { return fields_.domain().periodic(axis_); }
  /// Returns the distance of the plane above the middle of a layer, through the nearest image.
  double from_layer(int layer) const {
    const double away = at_ - fields_.width() * (layer + 0.5), period = double(cells_) * fields_.width();
    return periodic() ? away - period * std::round(away / period) : away;
  }
  /// Returns the width of the neighbour on a side of a cell; 0 if there is none.
  int width_beside(lbm::Int3 cell, int side) const {
    const lbm::Domain& domain = fields_.domain();
    cell[axis_] += side;
    cell = domain.wrapped(cell);
    if (!domain.inside(cell)) return 0;
    const auto kinds = domain.tree().kinds();
    return kinds.empty() ? 1 : 1 << kinds[domain.block_at(cell).index].level;
  }
  template <class Visit>
  void for_layer(int b, const lbm::CellBox& layer, double away, Visit& visit) const {
    const auto visit_part = [&](const lbm::CellBox& part) {
      const double share = share_of(fields_.block(b).lower + part.lower, away);
      if (share != 0) visit(b, part, share);
    };
    const int k = layer.lower[axis_], last = fields_.block(b).size[axis_] - 1;
    if (k > 0 && k < last) return visit_part(layer);  // all cells have neighbours of their width
    coupler::for_cells(layer.lower, layer.lower + layer.size, [&](lbm::Int3 cell) {
      visit_part({cell, {1, 1, 1}});
    });
  }
  double share_of(lbm::Int3 cell, double away) const {
    const int side = away < 0 ? -1 : 1, width = fields_.width();
    const int next = width_beside(cell, side), back = width_beside(cell, -side);
    const double beyond = std::abs(away);
    if (beyond == 0 || (periodic() && cells_ == 1)) return 1;
    if (next == 0) return back == 0 ? 1 : 1 + beyond / (0.5 * (width + back));
    const double way = 0.5 * (width + next);
    if (beyond <= way) return 1 - beyond / way;
    const double far_side = width * (cell[axis_] + 0.5) + side * (0.5 * width + next);
    const bool next_is_last = !periodic() && (far_side <= 0 || far_side >= double(cells_) * width);
    return next_is_last ? 1 - beyond / way : 0;
  }

  const coupler::FluidFields& fields_;
  int axis_;
  double at_;
  int cells_;
};

}  // namespace silt
