#include <algorithm>
#include <tuple>

#include "lbm/exchange/slot_exchange.hpp"
#include "lbm/fluid.hpp"
#include "lbm/heat/temperature.hpp"

namespace silt::lbm {

namespace {

/// Calls visit(rank, run) for the cells that local blocks of one cut share with blocks of the other, in an
/// order common to both ends of a message. Unknown parts have cells of the same levels.
template <class Field, class Visit>
void for_shared_cells(const Field& here, const Field& there, Visit&& visit) {
  struct Row {
    int block, rank;
    Int3 first;
    int cells;
  };
  std::vector<Row> rows;
  const int rank = parallel::rank_of(here.comm());
  for (int b = 0; b < int(here.blocks().size()); ++b) {
    const CellBox& box = here.blocks()[b].box();
    there.domain().for_leaves_meeting(box, [&](const BlockPlace& place) {
      if (!there.domain().is_of_level(place) && there.domain().is_known(place)) return;
      const int other = there.domain().local_index(place, rank);
      if (other >= 0 && there.blocks()[other].shares_array(here.blocks()[b])) return;
      const CellBox both = overlap(box, place.box);
      for_cells(both.lower, both.lower + Int3{1, both.size.y, both.size.z}, [&](Int3 x) {
        rows.push_back({b, place.rank, x, both.size.x});
      });
    });
  }
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return std::tie(a.first.z, a.first.y, a.first.x) < std::tie(b.first.z, b.first.y, b.first.x);
  });
  for (const Row& row : rows) {
    const auto& block = here.blocks()[row.block];
    visit(row.rank,
          SlotRun{std::uint32_t(row.block), std::uint32_t(block.cell(row.first - block.box().lower)), 1,
                  std::uint32_t(row.cells)});
  }
}

/// Returns the arrays of populations that arrive along i, from cell 0 of each block on.
template <class T, class F>
std::vector<T*> arriving(F& fluid, int i) {
  std::vector<T*> arrays;
  for (auto& block : fluid.blocks()) arrays.push_back(block.data() + block.arriving(i, fluid.parity()));
  return arrays;
}

}  // namespace

template <class Field>
void move_populations(const Field& from, Field& to) {
  using T = typename Field::Number;
  SlotExchange<T> cells(to.comm(), 4);
  for_shared_cells(from, to, [&](int rank, const SlotRun& row) { cells.sent(rank).add(row); });
  for_shared_cells(to, from, [&](int rank, const SlotRun& row) { cells.received(rank).add(row); });
  for (int i = 0; i < Field::Lattice::directions; ++i) {
    const auto sources = arriving<const T>(from, i);
    cells.start(sources);
    cells.finish(sources, arriving<T>(to, i));
  }
}

template void move_populations(const Fluid<float>&, Fluid<float>&);
template void move_populations(const Fluid<double>&, Fluid<double>&);
template void move_populations(const Temperature<float>&, Temperature<float>&);
template void move_populations(const Temperature<double>&, Temperature<double>&);

}  // namespace silt::lbm
