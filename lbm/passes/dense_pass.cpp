#include "lbm/passes/dense_pass.hpp"

#include <algorithm>

#include "lbm/passes/passes.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

namespace {
/// Returns the faces of a block that touch blocks of other ranks.
ShellFaces shell_of(const Domain& domain, const BlockPlace& place) {
  ShellFaces shell;
  for (int axis = 1; axis < 3; ++axis)
    for (int high = 0; high < 2; ++high) {
      CellBox beyond = place.box;
      beyond.lower[axis] += high ? beyond.size[axis] : -1;
      beyond.size[axis] = 1;
      beyond.lower = domain.wrapped(beyond.lower);
      if (!domain.inside(beyond.lower)) continue;
      bool& of_face = (axis == 1 ? shell.y : shell.z)[high];
      domain.for_blocks_meeting(beyond,
                                [&](const BlockPlace& there) { of_face |= there.rank != place.rank; });
    }
  return shell;
}

/// Returns the time of a pass over a box, in updates of a cell: a row takes whole vectors, and as long again
/// as one of them to begin.
template <class T>
std::int64_t time_of_pass(const CellBox& box) {
  constexpr int vector = 64 / sizeof(T);
  return std::int64_t{box.size.y} * box.size.z * ((box.size.x + vector - 1) / vector + 1) * vector;
}

/// Returns the arrays that are best passed whole.
template <class T>
std::vector<SharedArray<T>> arrays_to_pass_whole(const std::vector<Block<T>>& blocks) {
  std::vector<SharedArray<T>> arrays;
  for (std::size_t first = 0, end = 0; first < blocks.size(); first = end) {
    std::int64_t time = 0;
    for (; end < blocks.size() && blocks[end].shares_array(blocks[first]); ++end)
      time += time_of_pass<T>(blocks[end].box());
    const CellBox& all = blocks[first].array_box();
    if (time_of_pass<T>(all) < time) arrays.push_back({Block<T>(blocks[first], all), int(first), int(end)});
  }
  return arrays;
}
}  // namespace

template <class T>
DensePass<T>::DensePass(const Domain& domain, MPI_Comm comm, Device device, const CollisionRates<T>& rates,
                        std::vector<Block<T>>& blocks)
    : device_(device), rates_(rates), blocks_(blocks), idle_(blocks.size(), 0), in_parts_(blocks.size(), 1) {
  for (const BlockPlace& place : domain.blocks_of(parallel::rank_of(comm)))
    orders_.emplace_back(place.box.size, sizeof(T), shell_of(domain, place));
  if (device == Device::cpu) passed_whole_ = arrays_to_pass_whole(blocks);
  for (const SharedArray<T>& shared : passed_whole_)
    std::fill(in_parts_.begin() + shared.first, in_parts_.begin() + shared.end, 0);
}

template <class T>
void DensePass<T>::pass_no_array_whole() {
  passed_whole_.clear();
  std::ranges::fill(in_parts_, 1);
}

template <class T>
void DensePass<T>::begin() {
  fast_cells_.clear();
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    for (const RowRange& rows : orders_[b].shell())
      if (parts(int(b)) > 0) collide(int(b), rows);
  for (std::size_t k = 0; k < passed_whole_.size(); ++k) {
    SharedArray<T>& shared = passed_whole_[k];
    const Int3 size = shared.whole.size();
    pass_over(-1 - int(k), shared.whole, {0, size.y, 0, size.z});
    for (int b = shared.first; b < shared.end; ++b)
      for (int z = 0; z < blocks_[b].size().z; ++z)
        for (int y = 0; y < blocks_[b].size().y; ++y) blocks_[b].close_row(blocks_[b].cell(0, y, z), parity_);
  }
}

template <class T>
void DensePass<T>::pass_over(int number, Block<T>& block, RowRange rows) {
  constexpr int period = WatchedPlanes::period;
  const int first = int(passes_ % period) - block.box().lower.z % period;
  const int watched = (first + period) % period;
  passes_on<T>(device_).stream_collide(block, parity_, rates_, rows, {fast_list(device_), number, watched});
}

template <class T>
void DensePass<T>::end() {
  parity_ = flipped(parity_), ++passes_;
  for (const auto& [number, fast] : take_fast_cells(device_))
    if (number >= 0)
      fast_cells_.push_back({number, blocks_[number].cell_at(fast.cell), fast.speed});
    else
      see_fast(passed_whole_[-1 - number], fast);
}

/// Cells that are of no block are at rest again if one of them is too fast.
template <class T>
void DensePass<T>::see_fast(SharedArray<T>& shared, const FastCell& fast) {
  const auto block_of = [&](Int3 cell) {
    int b = shared.first;
    while (b < shared.end && !blocks_[b].box().contains(cell)) ++b;
    return b;
  };
  Block<T>& whole = shared.whole;
  const Int3 at = whole.box().lower + whole.cell_at(fast.cell);
  if (const int b = block_of(at); b < shared.end)
    return fast_cells_.push_back({b, at - blocks_[b].box().lower, fast.speed});
  for_cells({}, whole.size(), [&](Int3 x) {
    if (block_of(whole.box().lower + x) < shared.end) return;
    for (int i = 0; i < D3Q19::directions; ++i) whole.data()[whole.arriving(i, parity_) + whole.cell(x)] = 0;
  });
}

template class DensePass<float>;
template class DensePass<double>;

}  // namespace silt::lbm
