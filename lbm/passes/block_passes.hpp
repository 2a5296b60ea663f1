#pragma once
// The passes over all cells of a block: collision, giving up excess, totals. For builds for a device
// (SILT_BUILD): a vector of cells at a time, or one cell (SILT_SCALAR).
#include <algorithm>

#include "device/for_each.hpp"
#include "lbm/blocks/lane_totals.hpp"
#include "lbm/collision/carry_heat.hpp"
#include "lbm/collision/collide_cells.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::lbm::SILT_BUILD {

/// The cells of a range of rows, x fastest.
struct CellsOfRows {
  std::ptrdiff_t first, row, plane;
  int nx, ny;
  template <class T, class Lattice>
  CellsOfRows(const Block<T, Lattice>& block, RowRange range)
      : first(block.cell(0, range.y0, range.z0)),
        row(block.row_stride()),
        plane(block.plane_stride()),
        nx(block.size().x),
        ny(range.y1 - range.y0) {}
  SILT_DEVICE std::ptrdiff_t row_at(int y, int z) const { return first + y * row + z * plane; }
  SILT_DEVICE std::ptrdiff_t row_at(int k) const { return row_at(k % ny, k / ny); }
};

struct AddFast {
  FastList list;
  int block;
  SILT_DEVICE void operator()(std::ptrdiff_t x, double speed) const {
    const unsigned k = next_of(list.count);
    if (k < FastList::room) list.cells[k] = {block, {x, speed}};
  }
};

/// The watched planes, one per period from `first` on.
struct WatchedInTurn {
  static constexpr int period = WatchedPlanes::period;
  int first, planes;
  int count() const { return first < planes ? (planes - first + period - 1) / period : 0; }
  SILT_DEVICE int operator()(int n) const { return first + n * period; }
};
struct OthersInTurn {
  static constexpr int period = WatchedPlanes::period;
  int first, planes;
  int count() const { return planes - WatchedInTurn{first, planes}.count(); }
  SILT_DEVICE int operator()(int n) const { return n + int(n >= first) * (1 + (n - first) / (period - 1)); }
};

template <class Model, bool source, class T, class Excess, class Rates, class Planes, class Watch>
struct CollideCells {
  Slots<T> slots;
  Excess excess;
  Rates rates;
  CellsOfRows cells;
  Planes planes;
  Watch watch;
  static constexpr int together = Lanes<T>::count;
  [[gnu::always_inline]] SILT_DEVICE void operator()(int x, int row, int count) const {
    using V = typename Lanes<T>::Real;
    const std::ptrdiff_t at = cells.row_at(row % cells.ny, planes(row / cells.ny)) + x;
    if (count == together) return collide<Model, source, V>(slots, at, rates, AllLanes{}, watch, excess);
#if !defined(SILT_SCALAR)
    collide<Model, source, V>(slots, at, rates, FirstLanes<V, T>(count), watch, excess);
#endif
  }
  void run() const {
    for_rows(cells.nx, planes.count() * cells.ny, *this);
  }
};

template <class T>
struct TakeExcess {
  Slots<T> slots;
  ExcessQuanta<T>* excess;
  T stress_share;
  CellsOfRows cells;
  static constexpr int together = Lanes<T>::count;
  SILT_DEVICE void operator()(int x, int row, int count) const {
    const std::ptrdiff_t at = cells.row_at(row) + x;
    if (count == together) return take_excess_of_cells(slots, at, excess, stress_share);
    for (int n = 0; n < count; ++n)
      take_excess<T>(excess[at + n], stress_share, [&](int i) -> T& { return slots.arriving(i)[at + n]; });
  }
};
template <class T>
void take_excess(Block<T>& block, Parity parity) {
  const Int3 n = block.size();
  for_rows(n.x, n.y * n.z,
           TakeExcess<T>{Slots<T>(block, parity), block.excess(), block.stress_share(),
                         CellsOfRows(block, {0, n.y, 0, n.z})});
}

template <class T>
struct CloseRows {
  T* data;
  CellsOfRows cells;
  int count = 0;
  RowEnd<T> ends[10];  // five populations leave at each end
  static constexpr int together = 1;
  SILT_DEVICE void operator()(int k, int row, int) const { ends[k].move(data + cells.row_at(row)); }
};

template <class T, class Lattice>
void close_rows(Block<T, Lattice>& block, Parity parity, RowRange range) {
  CloseRows<T> close{block.data(), CellsOfRows(block, range), 0, {}};
  for (const RowEnd<T>& end : block.row_ends(parity)) close.ends[close.count++] = end;
  for_rows(close.count, (range.y1 - range.y0) * (range.z1 - range.z0), close);
}

/// Collides rows with models and rates chosen; watched planes by another pass, which finds fast cells.
template <class Model, bool source, class T, class Excess, class Rates>
void collide_rows(Block<T>& block, Parity parity, const Excess& excess, const Rates& rates, RowRange range,
                  const FastWatch& fast) {
  const Slots<T> slots(block, parity);
  const CellsOfRows cells(block, range);
  const T scale = Model::square_scale(rates.fluid);
  constexpr int period = WatchedPlanes::period;
  const int first = ((fast.first_plane - range.z0) % period + period) % period, planes = range.z1 - range.z0;
  const auto collide_planes = [&]<class Planes, class Seen>(const Planes& in_turn, const Seen& seen) {
    CollideCells<Model, source, T, Excess, Rates, Planes, Seen>{slots, excess, rates, cells, in_turn, seen}
        .run();
  };
  collide_planes(OthersInTurn{first, planes}, Unseen());
  collide_planes(
      WatchedInTurn{first, planes},
      Watch<T, AddFast>{T(speed_of_sound * speed_of_sound) * scale, scale, {fast.list, fast.block}});
}

template <class T>
void stream_collide(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range,
                    const FastWatch& fast) {
  if (range.y0 >= range.y1 || range.z0 >= range.z1) return;
  with_model(rates, [&]<class Model>(Model) {
    with_rates(rates, block, parity,
               [&]<bool source, class Rates>(std::bool_constant<source>, const Rates& of) {
                 if (block.excess())
                   collide_rows<Model, source>(block, parity, HeldExcess<T>(block), of, range, fast);
                 else
                   collide_rows<Model, source>(block, parity, NoExcess(), of, range, fast);
               });
  });
  close_rows(block, parity, range);
  if (block.temperature()) close_rows(*block.temperature(), parity, range);
}

template <class T>
struct TotalRows {
  const T* g[D3Q19::directions];  // populations that arrive at cell 0 of the block
  std::ptrdiff_t row, plane;
  T half_force[3];
  TemperatureRange<T> temperature;
  const LocalRows* rows;
  CellTotals* totals;
  TotalRows(const Block<T>& block, Parity parity, const std::array<double, 3>& force, const LocalRows* rows,
            CellTotals* totals)
      : row(block.row_stride()),
        plane(block.plane_stride()),
        temperature(block, parity),
        rows(rows),
        totals(totals) {
    for (int i = 0; i < D3Q19::directions; ++i) g[i] = block.data() + block.arriving(i, parity);
    for (int d = 0; d < 3; ++d) half_force[d] = T(0.5 * force[d]);
  }
  SILT_DEVICE void operator()(std::int64_t k, Team team) const {
    const LocalRows& of = rows[k];
    const std::ptrdiff_t first = of.first.x + of.first.y * row + of.first.z * plane;
    LaneTotals<T, 1> own;
    TemperatureRange<T> range = temperature;
    std::int64_t cells = 0;
    for (int y = 0; y < of.rows; ++y)
      for (int x = team.lane; x < of.cells; x += team.size, ++cells) {
        own.template add<false>(g, first + y * row + x, half_force);
        range.add(first + y * row + x);
      }
    CellTotals t;
    own.give(cells, t);
    range.give(t);
    const auto sum = [](auto a, auto b) { return a + b; };
    const auto most = [](auto a, auto b) { return a > b ? a : b; };
    t.mass = team.joined(t.mass, sum), t.mass_square = team.joined(t.mass_square, sum);
    for (std::int64_t& of : t.momentum) of = team.joined(of, sum);
    t.energy = team.joined(t.energy, sum), t.energy_rest = team.joined(t.energy_rest, sum);
    t.speed_squared = team.joined(t.speed_squared, most);
    t.most_deviation = team.joined(t.most_deviation, most);
    t.least_deviation = -team.joined(-t.least_deviation, most);
    t.most_temperature = team.joined(t.most_temperature, most);
    t.least_temperature = -team.joined(-t.least_temperature, most);
    t.sound = team.joined(int(!t.sound), most) == 0;
    if (team.lane == 0) totals[k] = t;
  }
};

template <class T>
void total_rows(const Block<T>& block, Parity parity, std::span<const LocalRows> rows,
                const std::array<double, 3>& force, CellTotals* totals) {
  for_teams(std::int64_t(rows.size()), TotalRows<T>(block, parity, force, rows.data(), totals));
  silt::SILT_BUILD::wait();
  to_device(rows), from_device(std::span(totals, rows.size()));
}

}  // namespace silt::lbm::SILT_BUILD
