#include "silt/results/lattice_of_levels.hpp"

#include <algorithm>

namespace silt {

using adapters::FieldQuantity;
using lbm::CellBox;
using lbm::Int3;

CellBox in_cells_of(int width, const CellBox& box, int other) {
  CellBox out;
  for (int d = 0; d < 3; ++d) {
    out.lower[d] = box.lower[d] * other / width;
    out.size[d] = ((box.lower[d] + box.size[d]) * other + width - 1) / width - out.lower[d];
  }
  return out;
}

namespace {

/// Returns the index in a box of the cell that contains cell x or is contained in it.
std::size_t index_in(const CellBox& box, Int3 x, int ratio) {
  Int3 at;
  for (int d = 0; d < 3; ++d) at[d] = x[d] / ratio - box.lower[d];
  return (std::size_t(at.z) * box.size.y + at.y) * box.size.x + at.x;
}

void repeat(const std::vector<double>& in, const CellBox& from, double* out, const CellBox& to, int ratio,
            int components) {
  coupler::for_cells(to.lower, to.lower + to.size, [&](Int3 x) {
    out = std::copy_n(&in[index_in(from, x, ratio) * components], components, out);
  });
}

void take_means(const std::vector<double>& in, const CellBox& from, double* out, const CellBox& to, int ratio,
                int components) {
  std::vector<int> count(to.cells());
  std::fill_n(out, to.cells() * components, 0.0);
  std::size_t i = 0;
  coupler::for_cells(from.lower, from.lower + from.size, [&](Int3 x) {
    const std::size_t at = index_in(to, x, ratio);
    ++count[at];
    for (int c = 0; c < components; ++c) out[at * components + c] += in[i++];
  });
  for (std::size_t at = 0; at < count.size(); ++at)
    for (int c = 0; c < components; ++c) out[at * components + c] /= count[at];
}

}  // namespace

LatticeOfLevels::LatticeOfLevels(const std::vector<LevelBoxes>& levels, int width, const CellBox& within)
    : width_(width) {
  for (std::size_t level = 0; level < levels.size(); ++level)
    for (std::size_t b = 0; b < levels[level].boxes.size(); ++b) {
      const CellBox& cells = levels[level].boxes[b];
      const CellBox box = overlap(in_cells_of(width, cells, levels[level].width), within);
      if (box.cells() == 0) continue;
      boxes_.push_back(box);
      sources_.push_back({level, b, levels[level].width, cells});
    }
}

FieldQuantity LatticeOfLevels::quantity(std::vector<FieldQuantity> of_levels) const {
  FieldQuantity q = of_levels.front();
  q.values = [this, of_levels](std::size_t k, int first, int last, double* out) {
    const auto& [level, box, width, cells] = sources_[k];
    const FieldQuantity& q = of_levels[level];
    if (width == width_ && boxes_[k].lower == cells.lower && boxes_[k].size == cells.size)
      return q.values(box, first, last, out);
    CellBox to = boxes_[k];
    to.lower.z += first, to.size.z = last - first;
    CellBox planes = cells;  // planes that overlap `to`
    const CellBox reach = in_cells_of(width, to, width_);
    planes.lower.z = reach.lower.z, planes.size.z = reach.size.z;
    const CellBox from = overlap(planes, cells);
    std::vector<double> values(from.cells() * q.components);
    const int begin = from.lower.z - cells.lower.z;
    q.values(box, begin, begin + from.size.z, values.data());
    if (width >= width_)
      repeat(values, from, out, to, width / width_, q.components);
    else
      take_means(values, from, out, to, width_ / width, q.components);
  };
  return q;
}

}  // namespace silt
