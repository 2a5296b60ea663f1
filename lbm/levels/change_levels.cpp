// Moves populations to another cut of the domain, and sets those of cells that were refined or coarsened.
#include <algorithm>
#include <map>
#include <tuple>

#include "lbm/exchange/slot_exchange.hpp"
#include "lbm/fluid.hpp"
#include "lbm/heat/temperature.hpp"
#include "lbm/levels/levels.hpp"
#include "parallel/communicator.hpp"

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

namespace {

/// Cells that change their level on a rank; the box is in the coarser cells.
struct Changed {
  CellBox box;
  int rank, from_block, to_block;  // indices on that rank
};

/// Lists the changed cells of all ranks known here: other ranks need this rank's cells beside theirs.
std::vector<Changed> changed_cells(const Domain& from, const Domain& to, int rank) {
  std::vector<Changed> all;
  const Domain& coarser = from.level() > to.level() ? from : to;
  const int up_from = coarser.level() - from.level(), up_to = coarser.level() - to.level();
  const auto coarsened = [](const CellBox& box, int up) {
    return CellBox{{box.lower.x >> up, box.lower.y >> up, box.lower.z >> up},
                   {box.size.x >> up, box.size.y >> up, box.size.z >> up}};
  };
  for (int leaf = 0; leaf < to.blocks(); ++leaf) {
    const BlockPlace there = to.block(leaf);
    if (!to.is_of_level(there)) continue;
    const CellBox box = coarsened(there.box, up_to);
    const CellBox in_from = {{box.lower.x << up_from, box.lower.y << up_from, box.lower.z << up_from},
                             {box.size.x << up_from, box.size.y << up_from, box.size.z << up_from}};
    from.for_blocks_meeting(in_from, [&](const BlockPlace& here) {
      if (here.rank != there.rank) return;
      all.push_back({overlap(box, coarsened(here.box, up_from)), here.rank, from.local_index(here, rank),
                     to.local_index(there, rank)});
    });
  }
  return all;
}

/// The factors of populations off equilibrium, proportional to the time step and to relaxation times.
struct Scales {
  double even, odd;
  Scales(const CollisionSpec& from, const CollisionSpec& to, double steps)
      : even(to.relaxation_time / from.relaxation_time * steps),
        odd(to.odd_relaxation_time() / from.odd_relaxation_time() * steps) {}
  Scales(const HeatSpec& from, const HeatSpec& to, double steps)
      : even((0.5 + HeatSpec::magic / to.excess()) / (0.5 + HeatSpec::magic / from.excess()) * steps),
        odd((0.5 + to.excess()) / (0.5 + from.excess()) * steps) {}
};

/// Converts populations of one level to another with the same density, velocity and velocity gradients.
void rescale(double (&g)[D3Q19::directions], const CollisionSpec& from, const CollisionSpec& to,
             const Scales& scale) {
  double rho = 0, u[3] = {from.force[0] / 2, from.force[1] / 2, from.force[2] / 2}, off[D3Q19::directions];
  for (int i = 0; i < D3Q19::directions; ++i) {
    rho += g[i];
    for (int d = 0; d < 3; ++d) u[d] += D3Q19::c[i][d] * g[i];
  }
  for (int i = 0; i < D3Q19::directions; ++i)
    off[i] = g[i] - (equilibrium(i, rho, u) - half_push(from.force, i));
  for (int i = 0; i < D3Q19::directions; ++i) {
    const double even = (off[i] + off[opposite(i)]) / 2, odd = (off[i] - off[opposite(i)]) / 2;
    g[i] = equilibrium(i, rho, u) - half_push(to.force, i) + scale.even * even + scale.odd * odd;
  }
}
template <class T>
void rescale(double (&g)[D3Q19::directions], const Fluid<T>& from, const Fluid<T>& to, const Scales& scale,
             const LocalCell&) {
  rescale(g, from.spec(), to.spec(), scale);
}

/// Does so with populations of the temperature: the same temperature and flux of heat. The fluid has changed
/// before.
template <class T>
void rescale(double (&g)[D3Q7::directions], const Temperature<T>&, const Temperature<T>& to,
             const Scales& scale, const LocalCell& at) {
  const std::array<double, 3> u = to.fluid().velocity(to.fluid().moments(at.block, at.cell));
  double t = 0;
  for (const double its : g) t += its;
  const auto equilibrium = [&](int i) {
    const Int3 c = D3Q7::c[i];
    return D3Q7::w(i) * t * (1 + 4 * (c.x * u[0] + c.y * u[1] + c.z * u[2]));
  };
  double off[D3Q7::directions];
  for (int i = 0; i < D3Q7::directions; ++i) off[i] = g[i] - equilibrium(i);
  for (int i = 0; i < D3Q7::directions; ++i)
    g[i] = equilibrium(i) + scale.even * (off[i] + off[opposite(i)]) / 2 +
           scale.odd * (off[i] - off[opposite(i)]) / 2;
}

/// `Field`: Fluid<T> or Temperature<T>.
template <class Field>
class Change {
  using T = typename Field::Number;
  using Lattice = typename Field::Lattice;

 public:
  Change(const Field& from, Field& to)
      : from_(from),
        to_(to),
        rank_(parallel::rank_of(to.comm())),
        changed_(changed_cells(from.domain(), to.domain(), rank_)),
        ratio_(1 << std::abs(from.domain().level() - to.domain().level())),
        scales_(from.spec(), to.spec(),
                from.domain().level() > to.domain().level() ? 1. / ratio_ : double(ratio_)) {}

  /// Sets new coarse cells to the mean of the populations that arrived in their place.
  void coarsen() {
    for (const Changed& part : changed_) {
      if (part.rank != rank_) continue;
      const Int3 before = from_.blocks()[part.from_block].box().lower,
                 after = to_.blocks()[part.to_block].box().lower;
      for_cells(part.box.lower, part.box.lower + part.box.size, [&](Int3 x) {
        double g[Lattice::directions] = {};
        for_cells(times(x), times(x + Int3{1, 1, 1}), [&](Int3 y) {
          for (int i = 0; i < Lattice::directions; ++i)
            g[i] += from_.arriving(part.from_block, y - before, i);
        });
        for (double& sum : g) sum /= ratio_ * ratio_ * ratio_;
        give(part.to_block, x - after, g);
      });
    }
  }

  /// Sets new fine cells by linear interpolation between the coarse cell and its neighbours.
  void refine() {
    fetch();
    for (const Changed& part : changed_) {
      if (part.rank != rank_) continue;
      const Int3 after = to_.blocks()[part.to_block].box().lower;
      for_cells(part.box.lower, part.box.lower + part.box.size, [&](Int3 x) {
        const std::vector<T>& middle = of(x);
        double slope[3][Lattice::directions] = {};
        for (int d = 0; d < 3; ++d) {
          Int3 above = x, below = x;
          ++above[d], --below[d];
          const int distance = has(above) + has(below);
          if (distance == 0) continue;
          const std::vector<T>&high = has(above) ? of(above) : middle, &low = has(below) ? of(below) : middle;
          for (int i = 0; i < Lattice::directions; ++i) slope[d][i] = (double(high[i]) - low[i]) / distance;
        }
        for_cells({}, times({1, 1, 1}), [&](Int3 y) {
          double g[Lattice::directions];
          for (int i = 0; i < Lattice::directions; ++i) {
            g[i] = middle[i];
            for (int d = 0; d < 3; ++d) g[i] += ((y[d] + 0.5) / ratio_ - 0.5) * slope[d][i];
          }
          give(part.to_block, times(x) + y - after, g);
        });
      });
    }
  }

 private:
  using Key = std::tuple<int, int, int>;  // z, y, x
  Int3 times(Int3 x) const { return {x.x * ratio_, x.y * ratio_, x.z * ratio_}; }
  Key key(Int3 x) const {
    x = from_.domain().wrapped(x);
    return {x.z, x.y, x.x};
  }
  bool has(Int3 x) const { return values_.contains(key(x)); }
  const std::vector<T>& of(Int3 x) const { return values_.at(key(x)); }

  void give(int block, Int3 cell, double (&g)[Lattice::directions]) {
    rescale(g, from_, to_, scales_, {block, cell});
    for (int i = 0; i < Lattice::directions; ++i) to_.arriving(block, cell, i) = T(g[i]);
  }

  /// Fetches the populations of coarse cells that change, and of their face neighbours.
  void fetch() {
    const Domain& domain = from_.domain();
    std::map<std::pair<int, int>, std::map<Key, BlockPlace>> needs;  // by rank that needs, rank that owns
    for (const Changed& part : changed_)
      for_cells(grown(part.box, 1).lower, part.box.lower + part.box.size + Int3{1, 1, 1}, [&](Int3 x) {
        int outside = 0;
        for (int d = 0; d < 3; ++d)
          outside += x[d] < part.box.lower[d] || x[d] >= part.box.lower[d] + part.box.size[d];
        x = domain.wrapped(x);
        if (outside > 1 || !domain.inside(x)) return;
        const BlockPlace place = domain.block_at(x);
        if (domain.is_of_level(place) && (part.rank == rank_ || place.rank == rank_))
          needs[{part.rank, place.rank}].insert({key(x), place});
      });
    SlotExchange<T> slots(to_.comm(), 6);
    std::uint32_t next = 0;
    for (const auto& [ends, cells] : needs)
      for (const auto& [key, place] : cells) {
        const auto [z, y, x] = key;
        SlotRun from{0, 0}, to{0, next};
        if (ends.first == rank_) values_[key], ++next;
        if (ends.second == rank_) {
          from.array = std::uint32_t(domain.local_index(place, rank_));
          from.first = std::uint32_t(from_.blocks()[from.array].cell(Int3{x, y, z} - place.box.lower));
        }
        slots.add(ends.second, from, ends.first, to, rank_);
      }
    std::vector<T> arrived(next);
    for (int i = 0; i < Lattice::directions; ++i) {
      std::vector<const T*> sources;
      for (const auto& block : from_.blocks())
        sources.push_back(block.data() + block.arriving(i, from_.parity()));
      T* const target[] = {arrived.data()};
      slots.start(sources);
      slots.finish(sources, target);
      std::size_t n = 0;
      for (const auto& [ends, cells] : needs)
        if (ends.first == rank_)
          for (const auto& [key, place] : cells) values_[key].push_back(arrived[n++]);
    }
  }

  const Field& from_;
  Field& to_;
  int rank_;
  std::vector<Changed> changed_;
  int ratio_;
  Scales scales_;
  std::map<Key, std::vector<T>> values_;  // populations that arrive in coarse cells
};

}  // namespace

template <class T>
void move_populations(const Levels<T>& from, Levels<T>& to) {
  const auto move = [&](auto&& at) {  // at(levels, level): the fluid or the temperature
    for (int level = 0; level < to.count(); ++level)
      for (int before = 0; before < from.count(); ++before) {
        if (before == level)
          move_populations(at(from, before), at(to, level));
        else if (before > level)
          Change(at(from, before), at(to, level)).refine();
        else
          Change(at(from, before), at(to, level)).coarsen();
      }
  };
  move([](auto& levels, int level) -> auto& { return levels.fluid(level); });
  if (to.heat(0)) move([](auto& levels, int level) -> auto& { return *levels.heat(level); });
}

template void move_populations(const Levels<float>&, Levels<float>&);
template void move_populations(const Levels<double>&, Levels<double>&);

}  // namespace silt::lbm
