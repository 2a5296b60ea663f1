// The passes of device_passes.hpp, for the one file of each device that includes this (SILT_ISA,
// SILT_SCALAR).
#include <algorithm>
#include <cmath>
#include <tuple>

#include "device/for_each.hpp"
#include "lbm/blocks/lane_totals.hpp"
#include "lbm/collision/collide_cells.hpp"
#include "lbm/passes/device_passes.hpp"

namespace silt::lbm::SILT_ISA {

/// The cells of a range of rows, x fastest.
struct CellsOfRows {
  std::ptrdiff_t first, row, plane;
  int nx, ny;
  template <class T>
  CellsOfRows(const Block<T>& block, RowRange range)
      : first(block.cell(0, range.y0, range.z0)),
        row(block.row_stride()),
        plane(block.plane_stride()),
        nx(block.size().x),
        ny(range.y1 - range.y0) {}
  SILT_DEVICE std::ptrdiff_t row_at(int y, int z) const { return first + y * row + z * plane; }
  SILT_DEVICE std::ptrdiff_t row_at(int k) const { return row_at(k % ny, k / ny); }
};

/// Fast cells in the order in which they are found; beyond `room` they are counted alone.
struct FastList {
  static constexpr unsigned room = 4096;
  FastInBlock cells[room];
  unsigned count;
};

template <class T>
struct Watch {
  T limit, scale;
  FastList* list;
  int block;

  template <class Keep>
  SILT_DEVICE void see(T square, std::ptrdiff_t x, const Keep&) const {
    if (square <= limit) return;
    const unsigned k = next_of(&list->count);
    if (k < FastList::room) list->cells[k] = {block, {x, std::sqrt(double(square) / double(scale))}};
  }
};

struct NoWatch {
  template <class T, class Keep>
  SILT_DEVICE void see(const T&, std::ptrdiff_t, const Keep&) const {}
};

/// One plane in each period is watched, from the first such one on.
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

template <class Model, bool source, class T, class Planes, class Watch>
struct CollideCells {
  Slots<T> slots;
  CollisionRates<T> rates;
  CellsOfRows cells;
  Planes planes;
  Watch watch;
  [[gnu::always_inline]] SILT_DEVICE void operator()(int x, int row) const {
    collide<Model, source, T>(slots, cells.row_at(row % cells.ny, planes(row / cells.ny)) + x, rates,
                              AllLanes{}, watch);
  }
  void run() const { for_rows(cells.nx, planes.count() * cells.ny, *this); }
};

template <class T>
struct TakeExcess {
  Slots<T> slots;
  ExcessQuanta<T>* excess;
  T stress_share;
  CellsOfRows cells;
  SILT_DEVICE void operator()(int x, int row) const {
    const std::ptrdiff_t at = cells.row_at(row) + x;
    take_excess<T>(excess[at], stress_share, [&](int i) -> T& { return slots.arriving(i)[at]; });
  }
};
template <class T>
void take_excess(Block<T>& block, Parity parity, RowRange range) {
  const int rows = std::max(range.y1 - range.y0, 0) * std::max(range.z1 - range.z0, 0);
  if (block.excess() && rows > 0)
    for_rows(block.size().x, rows,
             TakeExcess<T>{Slots<T>(block, parity), block.excess(), block.stress_share(),
                           CellsOfRows(block, range)});
}

template <class T>
struct CloseRows {
  T* data;
  CellsOfRows cells;
  int count = 0;
  RowEnd<T> ends[10];  // five populations cross out at either end
  SILT_DEVICE void operator()(int k, int row) const {
    const RowEnd<T> end = ends[k];
    T* const first = data + cells.row_at(row);
    first[end.to] = end.wall ? first[end.from] + end.addend : first[end.from];
  }
};

template <class T>
struct MoveSlots {
  const SlotPairs::Pair* pairs;
  const T* addends;
  SlotArrays<const T> sources;
  SlotArrays<T> targets;
  bool back;
  SILT_DEVICE void operator()(std::int64_t k, Team team) const {
    const SlotRun from = back ? pairs[k].to : pairs[k].from, to = back ? pairs[k].from : pairs[k].to;
    T* target = targets[to.array];
    if (!target) return;
    target += to.first;
    const T* const source = sources[from.array] + from.first;
    for (std::ptrdiff_t n = team.lane; n < from.length; n += team.size) {
      const T value = source[n * from.stride];
      target[n * to.stride] = addends ? value + addends[k] : value;
    }
  }
};

/// These do a step of BorderRows with a part of a row at a border. (nvcc takes no pointer to a member.)
struct Carry {
  SILT_DEVICE void operator()(const auto& rows, const auto&... part) const { rows.carry(part...); }
};
struct Explode {
  SILT_DEVICE void operator()(const auto& rows, const auto&... part) const { rows.explode(part...); }
};
struct AddUp {
  SILT_DEVICE void operator()(const auto& rows, const auto&... part) const { rows.add_up(part...); }
};
struct Coalesce {
  SILT_DEVICE void operator()(const auto& rows, const auto&... part) const { rows.coalesce(part...); }
};
struct Pass {
  SILT_DEVICE void operator()(const auto& rows, const auto&... part) const { rows.pass(part...); }
};

/// A team does a row, whose elements its members do in turn.
template <class Act, class T, class Entry>
struct OverRows {
  BorderRows<T> rows;
  const Entry* entries;
  SILT_DEVICE void operator()(std::int64_t k, Team team) const {
    const std::ptrdiff_t length = entries[k].length;
    if (team.size == 1) return Act()(rows, entries[k], 0, length);
    for (std::ptrdiff_t n = team.lane; n < length; n += team.size) Act()(rows, entries[k], n, n + 1);
  }
};
template <class Act, class T, class Entries>
void over_rows(const BorderRows<T>& rows, const Entries& entries) {
  using Entry = std::remove_cvref_t<decltype(*entries.data())>;
  for_teams(std::int64_t(entries.size()), OverRows<Act, T, Entry>{rows, entries.data()});
}

template <class T>
struct GatherMoments {
  ListedCells<T> of;
  Moments* moments;
  double* densities;
  SILT_DEVICE void operator()(std::int64_t k) const {
    const auto& cell = of.cells[k];
    const auto& block = of.blocks[cell.block];
    const T* g[D3Q19::directions];
    for (int i = 0; i < D3Q19::directions; ++i) g[i] = cell.data + block.arriving[i];
    const Moments m = block.excess
                          ? moments_of<T>(g, 0, block.excess[cell.data - block.data], block.stress_share)
                          : moments_of<T>(g, 0);
    if (moments)
      moments[k] = m;
    else
      densities[k] = m.density_deviation;
  }
};

inline FastList& fast_list() {
#if defined(__CUDACC__)
  static const auto list = std::static_pointer_cast<FastList>(zeroed_on_gpu(sizeof(FastList)));
#else
  static const auto list = std::make_unique<FastList>();
#endif
  return *list;
}

template <class T>
void stream_collide(int b, Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range,
                    int first_watched) {
  const CellsOfRows cells(block, range);
  const int rows = std::max(range.y1 - range.y0, 0) * std::max(range.z1 - range.z0, 0);
  if (rows == 0) return;
  take_excess(block, parity, range);
  with_model(rates, [&]<class Model>(Model) {
    const T scale = Model::square_scale(rates);
    const Watch<T> watch{T(speed_of_sound * speed_of_sound) * scale, scale, &fast_list(), b};
    constexpr int period = WatchedPlanes::period;
    const int first = ((first_watched - range.z0) % period + period) % period, planes = range.z1 - range.z0;
    const auto collide_all = [&]<bool source>(std::bool_constant<source>) {
      const Slots<T> slots(block, parity);
      CollideCells<Model, source, T, OthersInTurn, NoWatch>{slots, rates, cells, {first, planes}, {}}.run();
      CollideCells<Model, source, T, WatchedInTurn, Watch<T>>{slots, rates, cells, {first, planes}, watch}
          .run();
    };
    if (rates.has_force())
      collide_all(std::true_type{});
    else
      collide_all(std::false_type{});
  });
  CloseRows<T> close{block.data(), cells, 0, {}};
  for (const RowEnd<T>& end : block.row_ends(parity)) close.ends[close.count++] = end;
  for_rows(close.count, rows, close);
}

std::vector<FastInBlock> take_fast_cells() {
  silt::SILT_ISA::wait();
  FastList& list = fast_list();
  std::vector<FastInBlock> found(list.cells, list.cells + std::min(list.count, FastList::room));
  list.count = 0;
  from_device(list.count, found);
  std::sort(found.begin(), found.end(), [](const FastInBlock& a, const FastInBlock& b) {
    return std::tie(a.block, a.at.cell) < std::tie(b.block, b.at.cell);
  });
  return found;
}

void wait() {
  silt::SILT_ISA::wait();
}

template <class T>
void move_slots(const SlotPairs& pairs, std::span<const T> addends, SlotArrays<const T> sources,
                SlotArrays<T> targets, bool back) {
  for_teams(std::int64_t(pairs.pairs().size()),
            MoveSlots<T>{pairs.on_device(), addends.data(), sources, targets, back});
}

template <class T, class Outlet>
struct ReturnFrom {
  ReturnFromOutlet<T> cell;
  Outlet outlet;
  SILT_DEVICE void operator()(std::int64_t k) const { cell(k, outlet); }
};
template <class T>
void return_from_outlet(const ReturnFromOutlet<T>& cell, const SideCondition& side, std::size_t cells) {
  with_outlet(side, [&]<class Outlet>(const Outlet& outlet) {
    for_each(std::int64_t(cells), ReturnFrom<T, Outlet>{cell, outlet});
  });
}

template <class T>
void carry_packets(const BorderRows<T>& rows, std::span<const typename BorderRows<T>::Carried> carried) {
  over_rows<Carry>(rows, carried);
}

/// Nothing that arrives is given before all is added up: it may lie where something else left.
template <class T>
void cross_border(const BorderRows<T>& all, const BorderLists<T>& lists,
                  std::span<const typename BorderRows<T>::Passing> passing) {
  BorderRows<T> rows = all;
  rows.refer_to(lists);
  over_rows<Explode>(rows, lists.explosions);
  over_rows<AddUp>(rows, lists.coalescences);
  over_rows<Coalesce>(rows, lists.coalescences);
  over_rows<Pass>(rows, passing);
  wait();
}

template <class T>
void gather_moments(const ListedCells<T>& cells, Moments* moments, double* densities) {
  for_each(cells.count, GatherMoments<T>{cells, moments, densities});
}

/// Calls visit(pointers to what arrives at the first cell of a row, how far a cell is from it) for the cells
/// of rows that a member of a team has; returns how many.
template <class T>
struct CellsOfTeam {
  const T* g[D3Q19::directions];  // what arrives at the first cell of a block
  std::ptrdiff_t row, plane;
  CellsOfTeam(const Block<T>& block, Parity parity) : row(block.row_stride()), plane(block.plane_stride()) {
    for (int i = 0; i < D3Q19::directions; ++i) g[i] = block.data() + block.arriving(i, parity);
  }
  template <class Visit>
  SILT_DEVICE std::int64_t operator()(const LocalRows& rows, Team team, Visit&& visit) const {
    const std::ptrdiff_t first = rows.first.x + rows.first.y * row + rows.first.z * plane;
    std::int64_t cells = 0;
    for (int y = 0; y < rows.rows; ++y)
      for (int x = team.lane; x < rows.cells; x += team.size, ++cells) visit(g, first + y * row + x);
    return cells;
  }
};

template <class T>
struct TotalRows {
  CellsOfTeam<T> cells_of;
  T half_force[3];
  const LocalRows* rows;
  CellTotals* totals;
  SILT_DEVICE void operator()(std::int64_t k, Team team) const {
    LaneTotals<T, 1> own;
    const std::int64_t cells = cells_of(
        rows[k], team, [&](const auto& g, std::ptrdiff_t at) { own.template add<false>(g, at, half_force); });
    CellTotals t;
    own.give(cells, t);
    const auto sum = [](auto a, auto b) { return a + b; };
    const auto most = [](auto a, auto b) { return a > b ? a : b; };
    t.mass = team.joined(t.mass, sum), t.mass_square = team.joined(t.mass_square, sum);
    for (std::int64_t& of : t.momentum) of = team.joined(of, sum);
    t.energy = team.joined(t.energy, sum), t.energy_rest = team.joined(t.energy_rest, sum);
    t.speed_squared = team.joined(t.speed_squared, most);
    t.most_deviation = team.joined(t.most_deviation, most);
    t.least_deviation = -team.joined(-t.least_deviation, most);
    t.sound = team.joined(int(!t.sound), most) == 0;
    if (team.lane == 0) totals[k] = t;
  }
};

template <class T>
void total_rows(const Block<T>& block, Parity parity, std::span<const LocalRows> rows,
                const std::array<double, 3>& force, CellTotals* totals) {
  TotalRows<T> pass{{block, parity}, {}, rows.data(), totals};
  for (int d = 0; d < 3; ++d) pass.half_force[d] = T(0.5 * force[d]);
  for_teams(std::int64_t(rows.size()), pass);
  wait();
  to_device(rows), from_device(std::span(totals, rows.size()));
}

template <class T>
struct GiveMasses {
  ListedCells<T> cells;
  const std::int64_t* masses;
  SILT_DEVICE void operator()(std::int64_t k) const {
    const auto& cell = cells.cells[k];
    const auto& block = cells.blocks[cell.block];
    add_to(block.excess[cell.data - block.data], ExcessQuanta<T>(-masses[k]));
  }
};

template <class T>
void give_masses(const ListedCells<T>& cells, const std::int64_t* masses) {
  for_each(cells.count, GiveMasses<T>{cells, masses});
}

template <class T>
const DevicePasses<T>& device_passes() {
  static constexpr DevicePasses<T> passes = {stream_collide<T>, take_fast_cells,       wait,
                                             move_slots<T>,     return_from_outlet<T>, carry_packets<T>,
                                             cross_border<T>,   gather_moments<T>,     give_masses<T>,
                                             take_excess<T>,    total_rows<T>};
  return passes;
}
template const DevicePasses<float>& device_passes();
template const DevicePasses<double>& device_passes();

}  // namespace silt::lbm::SILT_ISA
