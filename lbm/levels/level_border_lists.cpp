// Makes the lists of a border between levels by following each packet to its end.
#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "lbm/exchange/ghost_home.hpp"
#include "lbm/heat/temperature.hpp"
#include "lbm/levels/join_rows.hpp"
#include "lbm/levels/level_border.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

template <class Field>
struct LevelBorder<Field>::Builder {
  LevelBorder& border;
  const Domain &fine, &coarse;
  int rank;
  Leaves leaves{fine}, coarse_leaves{coarse};

  /// The current row: `length` coarse cells from x on along `axis`.
  Int3 x{};
  int axis = 0;
  std::uint32_t length = 0;

  struct Entry {
    int sub_step, corner;
    Flight to;
  };
  std::uint32_t coarse_next = 0, fine_next[2] = {}, sums = 0;
  /// Of the blocks that share a block's array the first in memory: rows go on from one to the next.
  std::vector<int> first_of[2] = {first_in_memory(border.fine_.blocks()),
                                  first_in_memory(border.coarse_.blocks())};
  /// A population that leaves a fine cell at rest has this much more than from a coarse cell, one that
  /// arrives lacks as much, and a packet that passes a cell without a collision lacks twice as much.
  double by_force(int j) const { return border.fine_.half_push(j); }
  bool is_fine(Int3 cell) { return leaves.level(cell) == fine.level(); }
  bool is_coarse(Int3 cell) { return leaves.level(cell) == coarse.level(); }
  /// Returns populations of cells of this rank, one (or every second fine one) per coarse cell of the row.
  Row own_row(const Field& fluid, Leaves& of, Int3 cell, int direction) const {
    const BlockPlace& place = of.at(cell);
    const int b = fluid.domain().local_index(place, rank);
    const auto& block = fluid.blocks()[b];
    const bool is_coarse = fluid.domain().level() == coarse.level();
    const int stride = int(axis == 0 ? 1 : block.row_stride()), first = first_of[is_coarse][b];
    return {std::uint32_t(first * Lattice::directions + direction),
            std::int32_t(block.cell(cell - place.box.lower) + (block.data() - fluid.blocks()[first].data())),
            is_coarse ? stride : 2 * stride};
  }
  SlotRun run_of(const Row& row) const { return {row.array, std::uint32_t(row.first), row.step, length}; }
  /// Returns the row that rank `user` reads populations of any rank from; lists the message, if any.
  Row fetched(SlotExchange<T>& slots, const Field& fluid, Leaves& of, int user, Int3 cell, int direction,
              std::uint32_t& next, std::uint32_t table, bool returned = false) {
    const int owner = of.at(cell).rank;
    Row row;
    if (owner == rank) {
      row = own_row(fluid, of, cell, direction);
      if (returned) row.array += std::uint32_t(fluid.blocks().size() * Lattice::directions);
    }
    if (owner == user) return row;
    if (owner == rank) slots.sent(user).add(run_of(row));
    if (user != rank) return {};
    slots.received(owner).add({table, next, 1, length});
    return {table, std::int32_t(std::exchange(next, next + length)), 1};
  }
  Row coarse_row(int user, Int3 cell, int direction, bool returned = false) {
    return fetched(border.coarse_left_, border.coarse_, coarse_leaves, user, cell, direction, coarse_next,
                   std::uint32_t(2 * border.coarse_.blocks().size() * Lattice::directions), returned);
  }
  Row fine_row(int user, Int3 cell, int direction, int sub_step) {
    return fetched(border.fine_left_[sub_step], border.fine_, leaves, user, cell, direction,
                   fine_next[sub_step],
                   std::uint32_t(2 * border.fine_.blocks().size() * Lattice::directions + sub_step));
  }

  /// The part of a block after which all fine cells of some rows are done; none for several blocks.
  struct Part {
    Builder& builder;
    int block = -1, part = 0;
    bool several = false;

    void add(Int3 cell) {
      const BlockPlace& place = builder.leaves.at(cell);
      const int b = builder.fine.local_index(place, builder.rank);
      several |= b < 0 || (block >= 0 && b != block);
      if (several) return;
      block = b;
      const Int3 x = cell - place.box.lower;
      const int last_y = x.y + (builder.axis == 1 ? 2 * int(builder.length - 1) : 0);
      const PassOrder& order = builder.border.fine_.pass_order(b);
      part = std::max(
          {part, order.part_of(x.y, x.z), order.part_of(std::min(last_y, place.box.size.y - 1), x.z)});
    }
    Lists& list() const {
      const bool is_late = several || block < 0 || builder.border.ready_[block].empty();
      return is_late ? builder.border.late_ : builder.border.ready_[block][part];
    }
  };

  /// Returns those packets of the population that left coarse cell y along j that enter fine cells.
  std::vector<Entry> entries_of(Int3 y, int j) {
    std::vector<Entry> entries;
    for (int k = 0; k < 8; ++k) {
      Flight packet{y + y + corner(k), j, 0, -by_force(j)};
      for (int sub_step = 0; sub_step < 2; ++sub_step) {
        if (sub_step == 1) packet.by_force += 2 * by_force(packet.direction);
        packet = one_step<Lattice>(fine, packet);
        if (!is_fine(packet.cell)) continue;
        entries.push_back({sub_step, k, packet});
        break;
      }
    }
    return entries;
  }
  /// The rows above and below coarse cell y along axis d of the population that left along j; `factor` times
  /// their difference is the change over a quarter of a cell.
  struct Slope {
    Row above, below;
    T factor;
  };
  Slope slope(int user, Int3 y, int j, int d) {
    Int3 up = y, down = y;
    ++up[d], --down[d];
    up = coarse.wrapped(up), down = coarse.wrapped(down);
    const auto has = [&](Int3 cell) {
      return coarse.inside(cell) && coarse.is_of_level(coarse_leaves.at(cell));
    };
    constexpr double factors[] = {0, 1. / 4, 1. / 8};  // by the number of neighbours
    const bool above = has(up), below = has(down);
    if (!above) up = y;
    if (!below) down = y;
    return {coarse_row(user, up, j), coarse_row(user, down, j), T(factors[above + below])};
  }

  void add_explosion(int j) {
    const std::vector<Entry> entries = entries_of(x, j);
    if (entries.empty()) return;
    int in_step[2] = {};
    bool by_outlet = false;
    std::set<int> users;
    for (const Entry& entry : entries) {
      ++in_step[entry.sub_step], by_outlet |= entry.to.by_outlet;
      users.insert(leaves.at(entry.to.cell).rank);
    }
    const bool in_time = in_step[0] == 4 && in_step[1] == 4 && !by_outlet;
    for (const int user : users) {
      typename Rows::Carried one{length, 0, coarse_row(user, x, j), {}, {}, {}, -1}, returned = one;
      for (int d = 0; d < 3; ++d) {
        const Slope s = slope(user, x, j, d);
        one.above[d] = s.above, one.below[d] = s.below, one.slope[d] = s.factor;
      }
      if (by_outlet) returned.value = coarse_row(user, x, opposite(j), true);
      returned.above = returned.below = {returned.value, returned.value, returned.value};
      if (in_time) one.before = before_row(user, j);
      if (user != rank) continue;
      Part part{*this};
      for (const Entry& entry : entries)
        if (leaves.at(entry.to.cell).rank == rank) part.add(entry.to.cell);
      for (const bool outlet : {false, true}) {
        Explosion explosion{length, std::uint32_t(border.carry_.size()), {}, {}};
        for (int s = 0; s < 2; ++s) explosion.first[s] = std::uint32_t(part.list().packets[s].size());
        for (const Entry& entry : entries) {
          if (entry.to.by_outlet != outlet || leaves.at(entry.to.cell).rank != rank) continue;
          const double addend = entry.to.addend + (in_time ? 0 : entry.to.by_force);
          RowJoints<T>::add(part.list().packets[entry.sub_step], explosion.packets[entry.sub_step],
                            {own_row(border.fine_, leaves, entry.to.cell, entry.to.direction), T(addend),
                             std::uint8_t(entry.corner)});
        }
        if (explosion.packets[0] + explosion.packets[1] == 0) continue;
        part.list().explosions.push_back(explosion);
        border.carry_.push_back(outlet ? returned : one);
        RowJoints<T>::join_explosions(part.list(), border.carry_);
      }
    }
  }

  /// Lists the populations that arrive along j in the row before collision; returns their place at the user.
  std::int32_t before_row(int user, int j) {
    const int owner = coarse_leaves.at(x).rank;
    const SlotRun to{
        std::uint32_t(border.coarse_.blocks().size() * Lattice::directions + 1),  // behind coarse_fetched_
        std::uint32_t(border.coarse_before_.size()), 1, length};
    const SlotRun from = owner == rank ? run_of(own_row(border.coarse_, coarse_leaves, x, j)) : SlotRun{0, 0};
    if (owner == rank || user == rank) border.before_.add(owner, from, user, to, rank);
    if (user == rank) border.coarse_before_.resize(border.coarse_before_.size() + length);
    return std::int32_t(to.first);
  }

  void add_coalescence(int j) {
    struct Left {
      int sub_step;
      Flight from;
    };
    std::vector<Left> packets;
    int by_outlet = 0;
    double addend = 0;
    for (int k = 0; k < 8; ++k) {
      Flight packet = step_back<Lattice>(fine, {x + x + corner(k), j});
      int sub_step = 1;
      if (is_coarse(packet.cell)) {
        packet.by_force = 2 * by_force(packet.direction);
        packet = step_back<Lattice>(fine, packet);
        sub_step = 0;
      }
      if (!is_fine(packet.cell)) continue;
      if (packet.by_outlet) {
        ++by_outlet;
        continue;
      }
      packets.push_back({sub_step, packet});
      addend += (packet.addend + packet.by_force - by_force(j)) / 8;
    }
    if (packets.empty()) return;
    const int user = coarse_leaves.at(x).rank;
    const Home back = home_of<Lattice>(coarse, x + Lattice::c[opposite(j)], opposite(j));
    const int from_direction = opposite(back.direction);
    const bool from_coarse = coarse.is_of_level(coarse_leaves.at(back.cell));
    const std::vector<Entry> entered =
        from_coarse ? entries_of(back.cell, from_direction) : std::vector<Entry>{};
    if (packets.size() + by_outlet != (from_coarse ? entered.size() : 8))
      throw std::logic_error("packets are lost or made at a border between levels");

    if (from_coarse && length > 1) {  // the surroundings of the source cell may differ along the row
      const auto [first, whole] = std::pair(x, length);
      for (length = 1; x[axis] < first[axis] + int(whole); ++x[axis]) add_coalescence(j);
      x = first, length = whole;
      return;
    }
    std::vector<Row> sources;
    Part part{*this};
    for (const Left& left : packets) {
      part.add(left.from.cell);
      sources.push_back(fine_row(user, left.from.cell, left.from.direction, left.sub_step));
    }
    Int3 corners{};
    for (const Entry& entry : entered)
      corners = corners + corner(entry.corner) + corner(entry.corner) - Int3{1, 1, 1};
    std::vector<Taken> taken;
    for (int d = 0; d < 3; ++d) {
      if (corners[d] == 0) continue;
      const Slope s = slope(user, back.cell, from_direction, d);
      taken.push_back({s.above, s.below, T(corners[d]) * s.factor});
    }
    if (user != rank) return;
    Lists& list = from_coarse ? border.late_ : part.list();
    Coalescence one{length,
                    own_row(border.coarse_, coarse_leaves, x, j),
                    sums,
                    T(addend),
                    {std::uint32_t(list.sources[0].size()), std::uint32_t(list.sources[1].size())},
                    std::uint32_t(list.taken.size()),
                    std::uint8_t(8 - packets.size()),
                    {},
                    std::uint8_t(taken.size())};
    for (std::size_t k = 0; k < packets.size(); ++k)
      RowJoints<T>::add(list.sources[packets[k].sub_step], one.sources[packets[k].sub_step], sources[k]);
    list.taken.insert(list.taken.end(), taken.begin(), taken.end());
    list.coalescences.push_back(one);
    sums += length;
    RowJoints<T>::join_coalescences(list);
  }

  /// Lists packets that leave a fine cell in the first step and enter one in the second, through cell x.
  void add_passing(int j) {
    for (int k = 0; k < 8; ++k) {
      const Flight middle{x + x + corner(k), j};
      const Flight from = step_back<Lattice>(fine, middle);
      if (!is_fine(from.cell)) continue;
      const Flight to = one_step<Lattice>(fine, middle);
      if (!is_fine(to.cell)) continue;
      const int user = leaves.at(to.cell).rank;
      typename Rows::Passing one{length,
                                 fine_row(user, from.cell, from.direction, 0),
                                 {},
                                 sums,
                                 T(from.addend + to.addend + 2 * by_force(j))};
      if (user != rank) continue;
      one.to = own_row(border.fine_, leaves, to.cell, to.direction);
      sums += length;
      border.passing_.push_back(one);
    }
  }

  /// The levels around a coarse cell, and the number of cells along `axis` from it on with the same.
  struct Surroundings {
    bool any_fine = false, any_outside = false, any_far = false;
    bool fine[3][3][3] = {};  // by z, y, x
    int alike = 1 << 30;
    /// Returns whether a population that moves along j may enter fine cells.
    bool may_meet(int j) const {
      bool found = any_outside;
      for (int k = 1; k < 8; ++k) {
        const Int3 v = corner(k);
        found |= fine[1 + v.z * Lattice::c[j].z][1 + v.y * Lattice::c[j].y][1 + v.x * Lattice::c[j].x];
      }
      return found;
    }
  };
  Surroundings around(Int3 cell) {
    Surroundings s;
    for_cells(cell - Int3{1, 1, 1}, cell + Int3{2, 2, 2}, [&](Int3 y) {
      const Int3 image = coarse.wrapped(y);
      if (!coarse.inside(image)) {
        s.any_outside = true;
        if (y[axis] != cell[axis]) s.alike = 1;  // at the end of the domain
        return;
      }
      const BlockPlace& place = coarse_leaves.at(image);
      s.any_far |= !coarse.is_known(place);
      const bool is_fine = fine.is_of_level(place);
      const Int3 v = y - cell;
      s.fine[1 + v.z][1 + v.y][1 + v.x] = is_fine;
      s.any_fine |= is_fine;
      s.alike = std::min(s.alike, place.box.lower[axis] + place.box.size[axis] - image[axis]);
    });
    return s;
  }

  /// Cuts the cells of a box, which may touch fine cells, into rows with the same leaves around them.
  void add_rows(const CellBox& box) {
    axis = box.size.x > 1 ? 0 : 1;
    const Int3 end = box.lower + box.size;
    Int3 ends = end;
    ends[axis] = box.lower[axis] + 1;
    for_cells(box.lower, ends, [&](Int3 first) {
      std::vector<std::pair<CellRun, Surroundings>> runs;
      for (x = first; x[axis] < end[axis]; x[axis] += int(length)) {
        const Surroundings s = around(x);
        length = std::uint32_t(std::min(s.alike, end[axis] - x[axis]));
        if (s.any_fine && !s.any_far) runs.push_back({{x[axis], int(length)}, s});  // far: not of this rank
      }
      const auto for_runs = [&](auto&& concerns, auto&& add) {
        for (const auto& [run, s] : runs)
          if (concerns(s)) x[axis] = run.first, length = std::uint32_t(run.count), add();
      };
      for (int j = 1; j < Lattice::directions; ++j) {  // run after run, to be joined
        const auto enters = [j](const Surroundings& s) { return s.may_meet(j); };
        const auto comes = [j](const Surroundings& s) { return s.may_meet(opposite(j)); };
        for_runs(enters, [&] { add_explosion(j); });
        for_runs(comes, [&] { add_coalescence(j); });
        for_runs([&](const Surroundings& s) { return enters(s) && comes(s); }, [&] { add_passing(j); });
      }
    });
  }

  void build() {
    for (int b = 0; b < int(border.fine_.blocks().size()); ++b)
      border.ready_.emplace_back(border.fine_.is_in_parts() ? border.fine_.pass_order(b).parts() : 0);
    std::set<int> near;  // blocks that may concern this rank, in an order common to all ranks
    const auto add_near = [&](const CellBox& box) {
      for (const int b : coarse.blocks_meeting(grown(box, 2))) near.insert(b);
    };
    for (const BlockPlace& mine : coarse.blocks_of(rank)) add_near(mine.box);
    for (const BlockPlace& mine : fine.blocks_of(rank))
      add_near({halved(mine.box.lower), halved(mine.box.size)});
    for (const int b : near) {
      CellBox inner = coarse.block(b).box;      // less the faces already examined
      for (const int k : {4, 5, 2, 3, 0, 1}) {  // low and high across z, y, x
        const int d = k / 2, high = k % 2;
        CellBox face = inner;
        if (high) face.lower[d] += inner.size[d] - 1;
        face.size[d] = 1, --inner.size[d], inner.lower[d] += !high;
        if (inner.size[d] < 0 || face.size.x <= 0 || face.size.y <= 0 || face.size.z <= 0) continue;
        const CellBox around = grown(face, 1);
        if (!fine.blocks_meeting({around.lower + around.lower, around.size + around.size}).empty())
          add_rows(face);
      }
    }
    border.coarse_fetched_.resize(coarse_next);
    for (int s = 0; s < 2; ++s) border.fine_fetched_[s].resize(fine_next[s]);
    border.sums_.resize(sums);
    place_carried();
  }

  /// Places what is carried in one array, to which explosions then refer instead of to entries of carry_.
  void place_carried() {
    std::uint32_t carried = 0;
    for (typename Rows::Carried& its : border.carry_)
      its.first = std::exchange(carried, carried + std::uint32_t(Rows::carried_rows) * its.length);
    border.carried_.resize(carried);
    const auto place = [&](Lists& list) {
      for (Explosion& one : list.explosions) one.carried = border.carry_[one.carried].first;
    };
    for (auto& parts : border.ready_) std::for_each(parts.begin(), parts.end(), place);
    place(border.late_);
  }
};

template <class Field>
void LevelBorder<Field>::make_lists() {
  Builder{*this, fine_.domain(), coarse_.domain(), parallel::rank_of(fine_.comm())}.build();
}
template void LevelBorder<Fluid<float>>::make_lists();
template void LevelBorder<Fluid<double>>::make_lists();
template void LevelBorder<Temperature<float>>::make_lists();
template void LevelBorder<Temperature<double>>::make_lists();

}  // namespace silt::lbm
