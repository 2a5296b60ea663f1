#include "coupler/results/lattice_of_levels.hpp"

#include <algorithm>

namespace silt::coupler {

using adapters::FieldQuantity;

adapters::CellBox in_cells_of(int width, const adapters::CellBox& box, int other) {
  adapters::CellBox out;
  for (int d = 0; d < 3; ++d) {
    out.lower[d] = box.lower[d] * other / width;
    out.upper[d] = (box.upper[d] * other + width - 1) / width;
  }
  return out;
}

namespace {

adapters::CellBox overlap(adapters::CellBox a, const adapters::CellBox& b) {
  for (int d = 0; d < 3; ++d) {
    a.lower[d] = std::max(a.lower[d], b.lower[d]);
    a.upper[d] = std::max(a.lower[d], std::min(a.upper[d], b.upper[d]));
  }
  return a;
}

adapters::CellBox planes_of(adapters::CellBox box, int first, int last) {
  box.upper[2] = box.lower[2] + last, box.lower[2] += first;
  return box;
}

/// Calls visit(x, y, z) for each cell of a box, x fastest.
template <class Visit>
void for_each(const adapters::CellBox& box, Visit&& visit) {
  for (int z = box.lower[2]; z < box.upper[2]; ++z)
    for (int y = box.lower[1]; y < box.upper[1]; ++y)
      for (int x = box.lower[0]; x < box.upper[0]; ++x) visit(x, y, z);
}

std::size_t index_in(const adapters::CellBox& box, int x, int y, int z) {
  const std::size_t nx = box.upper[0] - box.lower[0], ny = box.upper[1] - box.lower[1];
  return ((z - box.lower[2]) * ny + (y - box.lower[1])) * nx + (x - box.lower[0]);
}

void repeat(const std::vector<double>& in, const adapters::CellBox& from, double* out,
            const adapters::CellBox& to, int ratio, int components) {
  for_each(to, [&](int x, int y, int z) {
    out = std::copy_n(&in[index_in(from, x / ratio, y / ratio, z / ratio) * components], components, out);
  });
}

void take_means(const std::vector<double>& in, const adapters::CellBox& from, double* out,
                const adapters::CellBox& to, int ratio, int components) {
  std::vector<int> count(to.cells());
  std::fill_n(out, to.cells() * components, 0.0);
  std::size_t i = 0;
  for_each(from, [&](int x, int y, int z) {
    const std::size_t at = index_in(to, x / ratio, y / ratio, z / ratio);
    ++count[at];
    for (int c = 0; c < components; ++c) out[at * components + c] += in[i++];
  });
  for (std::size_t at = 0; at < count.size(); ++at)
    for (int c = 0; c < components; ++c) out[at * components + c] /= count[at];
}

}  // namespace

LatticeOfLevels::LatticeOfLevels(const std::vector<LevelBoxes>& levels, int width,
                                 const adapters::CellBox& within)
    : width_(width) {
  for (std::size_t level = 0; level < levels.size(); ++level)
    for (std::size_t b = 0; b < levels[level].boxes.size(); ++b) {
      const adapters::CellBox& cells = levels[level].boxes[b];
      const adapters::CellBox box = overlap(in_cells_of(width, cells, levels[level].width), within);
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
    if (width == width_ && boxes_[k].lower == cells.lower && boxes_[k].upper == cells.upper)
      return q.values(box, first, last, out);
    const adapters::CellBox to = planes_of(boxes_[k], first, last);
    adapters::CellBox from = cells;  // the planes of it that are there
    const adapters::CellBox reach = in_cells_of(width, to, width_);
    from.lower[2] = std::max(from.lower[2], reach.lower[2]);
    from.upper[2] = std::min(from.upper[2], reach.upper[2]);
    std::vector<double> values(from.cells() * q.components);
    q.values(box, from.lower[2] - cells.lower[2], from.upper[2] - cells.lower[2], values.data());
    if (width >= width_)
      repeat(values, from, out, to, width / width_, q.components);
    else
      take_means(values, from, out, to, width_ / width, q.components);
  };
  return q;
}

}  // namespace silt::coupler
