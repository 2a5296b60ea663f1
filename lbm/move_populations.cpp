#include <algorithm>
#include <tuple>

#include "lbm/fluid.hpp"
#include "lbm/slot_exchange.hpp"

namespace silt::lbm {

namespace {

CellBox overlap(const CellBox& a, const CellBox& b) {
  CellBox both;
  for (int d = 0; d < 3; ++d) {
    both.lower[d] = std::max(a.lower[d], b.lower[d]);
    both.size[d] = std::min(a.lower[d] + a.size[d], b.lower[d] + b.size[d]) - both.lower[d];
  }
  return both;
}

/// Calls visit(block, rank, box) for the cells that a local block of one cut shares with a block of a rank in
/// the other, in an order that both ends of a message find.
template <class T, class Visit>
void for_shared_cells(const Fluid<T>& here, const Domain& there, Visit&& visit) {
  struct Shared {
    int block, rank;
    CellBox box;
  };
  std::vector<Shared> list;
  for (int b = 0; b < int(here.blocks().size()); ++b)
    there.for_blocks_meeting(here.blocks()[b].box(), [&](const BlockPlace& place) {
      list.push_back({b, place.rank, overlap(here.blocks()[b].box(), place.box)});
    });
  std::sort(list.begin(), list.end(), [](const Shared& a, const Shared& b) {
    const Int3 p = a.box.lower, q = b.box.lower;
    return std::tie(p.z, p.y, p.x) < std::tie(q.z, q.y, q.x);
  });
  for (const Shared& part : list) {
    const Block<T>& block = here.blocks()[part.block];
    const Int3 first = part.box.lower - block.box().lower;
    for (int z = 0; z < part.box.size.z; ++z)
      for (int y = 0; y < part.box.size.y; ++y)
        visit(part.rank, SlotRun{std::uint32_t(part.block), std::uint32_t(block.cell(first + Int3{0, y, z})),
                                 1, std::uint32_t(part.box.size.x)});
  }
}

/// What arrives along i, from cell 0 of each block on.
template <class T, class F>
std::vector<T*> arriving(F& fluid, int i) {
  std::vector<T*> arrays;
  for (auto& block : fluid.blocks()) arrays.push_back(block.data() + block.arriving(i, fluid.parity()));
  return arrays;
}

}  // namespace

template <class T>
void move_populations(const Fluid<T>& from, Fluid<T>& to) {
  SlotExchange<T> cells(to.comm(), 4);
  for_shared_cells(from, to.domain(), [&](int rank, const SlotRun& row) { cells.sent(rank).add(row); });
  for_shared_cells(to, from.domain(), [&](int rank, const SlotRun& row) { cells.received(rank).add(row); });
  for (int i = 0; i < directions; ++i) {
    const auto sources = arriving<const T>(from, i);
    cells.start(sources);
    cells.finish(sources, arriving<T>(to, i));
  }
}

template void move_populations(const Fluid<float>&, Fluid<float>&);
template void move_populations(const Fluid<double>&, Fluid<double>&);

}  // namespace silt::lbm
