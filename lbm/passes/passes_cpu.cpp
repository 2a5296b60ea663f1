// The passes on the CPU; those over all cells of a block and over borders use its vector kernels.
#define SILT_BUILD cpu
#define SILT_SCALAR
#define SILT_AT_ONCE
#include <vector>

#include "lbm/blocks/lane_totals.hpp"
#include "lbm/passes/level_border_patches.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::lbm::SILT_BUILD {

template <class T>
void stream_collide(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range,
                    const FastWatch& watch) {
  static std::vector<FastCell> found;  // of these rows
  found.clear();
  lbm::stream_collide(block, parity, rates, range, {watch.first_plane, found});
  for (const FastCell& fast : found)
    if (const unsigned k = (*watch.list.count)++; k < FastList::room)
      watch.list.cells[k] = {watch.block, fast};
}

template <class T>
void take_excess(Block<T>& block, Parity parity) {
  SILT_CHOSEN(excess_kernel<T>)()(block, parity);
}

template <class T>
void total_rows(const Block<T>& block, Parity parity, std::span<const LocalRows> rows,
                const std::array<double, 3>& force, CellTotals* totals) {
  for (const LocalRows& of : rows) {
    const T* g[D3Q19::directions];
    for (int i = 0; i < D3Q19::directions; ++i)
      g[i] = block.data() + block.arriving(i, parity) + block.cell(of.first);
    *totals = moments_kernels<T>().total(g, {of.cells, of.rows, block.row_stride()}, force);
    TemperatureRange<T> range(block, parity);
    if (block.temperature())
      for_cells(of.first, of.first + Int3{of.cells, of.rows, 1}, [&](Int3 x) { range.add(block.cell(x)); });
    range.give(*totals++);
  }
}

template <class T>
void carry_packets(const BorderPatches<T>& border,
                   std::span<const typename BorderPatches<T>::Carried> carried) {
  SILT_CHOSEN(border_kernels<T>)().carry_packets(border, carried);
}

template <class T>
void cross_border(const BorderPatches<T>& border, const BorderLists<T>& lists,
                  std::span<const typename BorderPatches<T>::Passing> passing) {
  SILT_CHOSEN(border_kernels<T>)().cross_border(border, lists, passing);
}

}  // namespace silt::lbm::SILT_BUILD

#include "lbm/passes/passes_build.hpp"
