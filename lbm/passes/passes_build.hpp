// The passes of passes.hpp, for the one file per device that includes this (SILT_BUILD, SILT_SCALAR). That
// file has the passes over all cells of a block: vector kernels on the CPU, else block_passes.hpp.
#include "cpu/prefetch.hpp"
#include "device/for_each.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::lbm::SILT_BUILD {

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
    const auto move_at = [&](auto s, auto t, auto&& change) {
      for (std::ptrdiff_t n = team.lane; n < from.length; n += team.size)
        target[n * t] = change(source[n * s]);
    };
    const auto move = [&](auto&& change) {
      constexpr std::integral_constant<std::ptrdiff_t, 1> one;
      if (from.stride == 1 && to.stride == 1)
        move_at(one, one, change);
      else
        move_at(std::ptrdiff_t{from.stride}, std::ptrdiff_t{to.stride}, change);
    };
    if (addends)
      move([addend = addends[k]](T value) { return value + addend; });
    else
      move([](T value) { return value; });
  }
};

template <class T>
struct GatherMoments {
  ListedCells<T> of;
  Moments* moments;
  static constexpr int ahead = 6;
  void fetch(std::int64_t k) const {
    for (const std::ptrdiff_t arriving : of.block_of(k).arriving) prefetch_to_read(of.data(k) + arriving);
  }
  SILT_DEVICE void operator()(std::int64_t k) const { moments[k] = of.moments(k); }
};

template <class T>
void move_slots(const SlotPairs& pairs, std::span<const T> addends, SlotArrays<const T> sources,
                SlotArrays<T> targets, bool back) {
  for_teams(std::int64_t(pairs.pairs().size()),
            MoveSlots<T>{pairs.device(), addends.data(), sources, targets, back});
}

template <class T>
void gather_moments(const ListedCells<T>& cells, Moments* moments) {
  for_each(cells.count, GatherMoments<T>{cells, moments});
}

template <class T>
struct GiveMasses {
  ListedCells<T> cells;
  const std::int64_t* masses;
  SILT_DEVICE void operator()(std::int64_t k) const { add_to(*cells.excess(k), ExcessQuanta<T>(-masses[k])); }
};

template <class T>
void give_masses(const ListedCells<T>& cells, const std::int64_t* masses) {
  for_each(cells.count, GiveMasses<T>{cells, masses});
}

template <class T, class Lattice>
void return_from_outlet(const OutletCells<T, Lattice>& cells, const SideCondition& side) {
  with_outlet(side, [&]<class Outlet>(const Outlet& outlet) {
    for_each(std::int64_t(cells.count), ReturnFromOutlet<T, Lattice, Outlet>{cells, outlet});
  });
}

template <class T>
const Passes<T>& passes() {
  static constexpr Passes<T> passes = {
      .stream_collide = stream_collide<T>,
      .wait = silt::SILT_BUILD::wait,
      .move_slots = move_slots<T>,
      .return_from_outlet = return_from_outlet<T, D3Q19>,
      .return_temperature = return_from_outlet<T, D3Q7>,
      .carry_packets = carry_packets<T>,
      .cross_border = cross_border<T>,
      .gather_moments = gather_moments<T>,
      .give_masses = give_masses<T>,
      .take_excess = take_excess<T>,
      .total_rows = total_rows<T>,
  };
  return passes;
}
template const Passes<float>& passes();
template const Passes<double>& passes();

}  // namespace silt::lbm::SILT_BUILD
