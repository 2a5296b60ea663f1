// Makes the lists of a border between levels by following each packet to its end.
#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "lbm/exchange/ghost_home.hpp"
#include "lbm/heat/temperature.hpp"
#include "lbm/levels/border_pieces.hpp"
#include "lbm/levels/join_patches.hpp"
#include "lbm/levels/level_border.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

template <class Field>
struct LevelBorder<Field>::Builder {
  LevelBorder& border;
  const Domain &fine, &coarse;
  int rank;
  Leaves leaves{fine}, coarse_leaves{coarse};
  BorderSurroundings surroundings{fine, coarse};
  PacketWays<Lattice> ways{fine, leaves};

  /// The current patch: coarse cells from x on, rows along `axis`, one after another along `outer`.
  Int3 x{};
  Surroundings around_x{};
  int axis = 0, outer = 1;
  Extent size{};

  struct Entry {
    int sub_step, corner;
    Flight to;
  };
  /// Of the blocks that share a block's array the first in memory: patches go on from one to the next.
  std::vector<int> first_of[2] = {first_in_memory(border.fine_.blocks()),
                                  first_in_memory(border.coarse_.blocks())};
  /// A population that leaves a fine cell at rest has this much more than from a coarse cell, one that
  /// arrives lacks as much, and a packet that passes a cell without a collision lacks twice as much.
  double by_force(int j) const { return border.fine_.half_push(j); }

  /// Returns populations of cells of this rank, one (or every second fine one) per coarse cell of the patch.
  Patch own_patch(const Field& fluid, Leaves& of, Int3 cell, int direction) const {
    const BlockPlace& place = of.at(cell);
    const int b = fluid.domain().local_index(place, rank);
    const auto& block = fluid.blocks()[b];
    const bool is_coarse = fluid.domain().level() == coarse.level();
    const int first = first_of[is_coarse][b];
    const auto stride = [&](int d) {
      return std::int32_t((is_coarse ? 1 : 2) * (d == 0   ? 1
                                                 : d == 1 ? block.row_stride()
                                                          : block.plane_stride()));
    };
    return {std::uint32_t(first * Lattice::directions + direction),
            std::int32_t(block.cell(cell - place.box.lower) + (block.data() - fluid.blocks()[first].data())),
            stride(axis), stride(outer)};
  }
  /// Calls use(run) for the rows of a patch.
  template <class Use>
  static void for_runs(const Patch& patch, const Extent& size, Use&& use) {
    for (std::uint32_t row = 0; row < size.rows; ++row)
      use(SlotRun{patch.array, std::uint32_t(patch.first + std::int64_t{row} * patch.pitch), patch.step,
                  size.length});
  }
  /// Returns the patch that rank `user` reads populations of any rank from; lists the message, if any.
  Patch fetched(FetchedSlots<T>& slots, const Patch& own, int owner, int user, std::uint32_t table) {
    if (owner == user) return own;
    if (owner == rank) for_runs(own, size, [&](const SlotRun& run) { slots.exchange.sent(user).add(run); });
    if (user != rank) return {};
    const std::uint32_t first = std::exchange(slots.count, slots.count + size.cells());
    slots.exchange.received(owner).add({table, first, 1, size.cells()});
    return {table, std::int32_t(first), 1, std::int32_t(size.length)};
  }
  static std::uint32_t arrays_of(const Field& fluid) {
    return std::uint32_t(fluid.blocks().size() * Lattice::directions);
  }
  /// The same for coarse populations that left, or that outlets returned, and for fine ones that left.
  Patch coarse_patch(int user, Int3 cell, int direction, bool returned = false) {
    const int owner = coarse_leaves.at(cell).rank;
    Patch own;
    if (owner == rank) {
      own = own_patch(border.coarse_, coarse_leaves, cell, direction);
      if (returned) own.array += arrays_of(border.coarse_);
    }
    return fetched(border.coarse_left_, own, owner, user, 2 * arrays_of(border.coarse_));
  }
  Patch fine_patch(int user, Int3 cell, int direction, int sub_step) {
    const int owner = leaves.at(cell).rank;
    const Patch own = owner == rank ? own_patch(border.fine_, leaves, cell, direction) : Patch{};
    return fetched(border.fine_left_[sub_step], own, owner, user,
                   2 * arrays_of(border.fine_) + std::uint32_t(sub_step));
  }

  /// The part of a block after which all fine cells of some patches are done; none for several blocks.
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
      Int3 last = cell - place.box.lower;
      last[builder.axis] += 2 * int(builder.size.length - 1),
          last[builder.outer] += 2 * int(builder.size.rows - 1);
      part = std::max(part, builder.border.fine_.pass_order(b).ready(last.y, last.z, 0));
    }
    Lists& list() const {
      const bool is_late = several || block < 0 || builder.border.ready_[block].empty();
      return is_late ? builder.border.late_ : builder.border.ready_[block][part];
    }
  };

  /// Returns those packets of the population that left coarse cell y along j that enter fine cells.
  std::vector<Entry> entries_of(Int3 y, const Surroundings& around_y, int j) {
    std::vector<Entry> entries;
    for (int k = 0; k < 8; ++k) {
      Flight packet{y + y + corner(k), j, 0, -by_force(j)};
      for (int sub_step = 0; sub_step < 2; ++sub_step) {
        if (sub_step == 1) packet.by_force += 2 * by_force(packet.direction);
        packet = ways.moved(packet, around_y);
        if (!ways.is_fine(packet, y, around_y)) continue;
        packet.cell = fine.wrapped(packet.cell);
        entries.push_back({sub_step, k, packet});
        break;
      }
    }
    return entries;
  }
  /// Returns the populations that left along j above and below coarse cell y along axis d; `factor` times
  /// their difference is the change over a quarter of a cell.
  typename Patches::Taken slope(int user, Int3 y, int j, int d) {
    Int3 up = y, down = y;
    ++up[d], --down[d];
    up = coarse.wrapped(up), down = coarse.wrapped(down);
    const auto has = [&](Int3 c) { return coarse.inside(c) && coarse.is_of_level(coarse_leaves.at(c)); };
    constexpr double factors[] = {0, 1. / 4, 1. / 8};  // by the number of neighbours
    const bool above = has(up), below = has(down);
    if (!above) up = y;
    if (!below) down = y;
    return {coarse_patch(user, up, j), coarse_patch(user, down, j), T(factors[above + below])};
  }

  void add_explosion(int j) {
    const std::vector<Entry> entries = entries_of(x, around_x, j);
    if (entries.empty()) return;
    int in_step[2] = {};
    bool by_outlet = false;
    std::set<int> users;
    for (const Entry& entry : entries) {
      ++in_step[entry.sub_step], by_outlet |= entry.to.by_outlet;
      users.insert(leaves.at(entry.to.cell).rank);
    }
    const bool in_time = in_step[0] > 0 && in_step[1] > 0 && !by_outlet;
    const double half = in_time ? 0.5 / (in_step[0] + in_step[1]) : 0,
                 change[2] = {half * in_step[1], -half * in_step[0]};  // together the packets have none
    for (const int user : users) {
      typename Patches::Carried one{size, 0, coarse_patch(user, x, j), {}, {}, {}, {}, {}}, returned = one;
      for (int d = 0; d < 3; ++d) {
        const auto s = slope(user, x, j, d);
        one.above[d] = s.above, one.below[d] = s.below, one.slope[d] = s.factor;
      }
      if (by_outlet) returned.value = coarse_patch(user, x, opposite(j), true);
      returned.above = returned.below = {returned.value, returned.value, returned.value};
      if (in_time) one.change = {T(change[0]), T(change[1])}, one.before = before_patch(user, j);
      if (user != rank) continue;
      Part part{*this};
      for (const Entry& entry : entries)
        if (leaves.at(entry.to.cell).rank == rank) part.add(entry.to.cell);
      for (const bool outlet : {false, true}) {
        Explosion explosion{size, std::uint32_t(border.carry_.size()), {}, {}};
        for (int s = 0; s < 2; ++s) explosion.first[s] = std::uint32_t(part.list().packets[s].size());
        for (const Entry& entry : entries) {
          if (entry.to.by_outlet != outlet || leaves.at(entry.to.cell).rank != rank) continue;
          // the change by the collision holds what the force adds
          const double lacks = entry.to.by_force + 4 * change[entry.sub_step] * by_force(j);
          const double addend = entry.to.addend + (in_time && in_step[0] == in_step[1] ? 0 : lacks);
          PatchJoints<T>::add(part.list().packets[entry.sub_step], explosion.packets[entry.sub_step],
                              {own_patch(border.fine_, leaves, entry.to.cell, entry.to.direction), T(addend),
                               std::uint8_t(entry.corner)});
        }
        if (explosion.packets[0] + explosion.packets[1] == 0) continue;
        part.list().explosions.push_back(explosion);
        border.carry_.push_back(outlet ? returned : one);
        PatchJoints<T>::join_explosions(part.list(), border.carry_);
      }
    }
  }

  /// Returns the populations that arrive along j in the patch before collision; place_kept() lists the copies
  /// of those of this rank.
  Patch before_patch(int user, int j) {
    const int owner = coarse_leaves.at(x).rank;
    const Patch own = owner == rank ? own_patch(border.coarse_, coarse_leaves, x, j) : Patch{};
    return fetched(border.before_, own, owner, user, before_table());
  }
  std::uint32_t before_table() const { return arrays_of(border.coarse_) + 1; }  // behind what left

  void add_coalescence(int j) {
    struct Left {
      int sub_step;
      Flight from;
    };
    std::vector<Left> packets;
    int by_outlet = 0;
    double addend = 0;
    for (int k = 0; k < 8; ++k) {
      Flight packet = ways.moved({x + x + corner(k), j}, around_x, true);
      int sub_step = 1;
      if (!ways.is_fine(packet, x, around_x)) {
        packet.by_force = 2 * by_force(packet.direction);
        packet = ways.moved(packet, around_x, true);
        sub_step = 0;
      }
      if (!ways.is_fine(packet, x, around_x)) continue;
      packet.cell = fine.wrapped(packet.cell);
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
    const Surroundings around_it = from_coarse ? surroundings.around(back.cell) : Surroundings{};
    const std::vector<Entry> entered =
        from_coarse ? entries_of(back.cell, around_it, from_direction) : std::vector<Entry>{};
    if (packets.size() + by_outlet != (from_coarse ? entered.size() : 8))
      throw std::logic_error("packets are lost or made at a border between levels");

    if (from_coarse && in_alike_parts(around_it.alike, [&] { add_coalescence(j); })) return;
    std::vector<Patch> sources;
    Part part{*this};
    for (const Left& left : packets) {
      part.add(left.from.cell);
      sources.push_back(fine_patch(user, left.from.cell, left.from.direction, left.sub_step));
    }
    Int3 corners{};
    for (const Entry& entry : entered)
      corners = corners + corner(entry.corner) + corner(entry.corner) - Int3{1, 1, 1};
    std::vector<typename Patches::Taken> taken;
    for (int d = 0; d < 3; ++d) {
      if (corners[d] == 0) continue;
      taken.push_back(slope(user, back.cell, from_direction, d));
      taken.back().factor *= T(corners[d]);
    }
    if (user != rank) return;
    Lists& list = from_coarse ? border.late_ : part.list();
    Coalescence one{size,
                    own_patch(border.coarse_, coarse_leaves, x, j),
                    0,
                    T(addend),
                    {std::uint32_t(list.sources[0].size()), std::uint32_t(list.sources[1].size())},
                    std::uint32_t(list.taken.size()),
                    std::uint8_t(8 - packets.size()),
                    {},
                    std::uint8_t(taken.size())};
    for (std::size_t k = 0; k < packets.size(); ++k)
      PatchJoints<T>::add(list.sources[packets[k].sub_step], one.sources[packets[k].sub_step], sources[k]);
    list.taken.insert(list.taken.end(), taken.begin(), taken.end());
    list.coalescences.push_back(one);
    PatchJoints<T>::join_coalescences(list);
  }

  /// Lists packets that leave a fine cell in the first step and enter one in the second, through cell x.
  void add_passing(int j) {
    for (int k = 0; k < 8; ++k) {
      const Flight middle{x + x + corner(k), j};
      Flight from = ways.moved(middle, around_x, true), to = ways.moved(middle, around_x);
      if (!ways.is_fine(from, x, around_x) || !ways.is_fine(to, x, around_x)) continue;
      from.cell = fine.wrapped(from.cell), to.cell = fine.wrapped(to.cell);
      const int user = leaves.at(to.cell).rank;
      typename Patches::Passing one{size,
                                    fine_patch(user, from.cell, from.direction, 0),
                                    {},
                                    0,
                                    T(from.addend + to.addend + 2 * by_force(j))};
      if (user != rank) continue;
      one.to = own_patch(border.fine_, leaves, to.cell, to.direction);
      border.passing_.push_back(one);
    }
  }

  /// Calls add() for parts of the patch if it has more cells than are alike; returns whether it does.
  template <class Add>
  bool in_alike_parts(Int3 all, Add&& add) {
    const Extent alike{std::min(size.length, std::uint32_t(all[axis])),
                       std::min(size.rows, std::uint32_t(all[outer]))};
    if (alike.cells() == size.cells()) return false;
    const auto [first, whole] = std::pair(x, size);
    const Extent rest_of_rows{whole.length - alike.length, alike.rows},
        other_rows{whole.length, whole.rows - alike.rows};
    size = alike, add();
    if (rest_of_rows.length > 0) size = rest_of_rows, x[axis] += int(alike.length), add();
    x = first;
    if (other_rows.rows > 0) size = other_rows, x[outer] += int(alike.rows), add();
    x = first, size = whole;
    return true;
  }

  void add_patches(const CellBox& face) {
    axis = face.size.x > 1 ? 0 : 1, outer = axis == 0 && face.size.y > 1 ? 1 : 2;
    const std::vector<BorderPiece> pieces = alike_pieces(surroundings, face, axis, outer);
    const auto for_pieces = [&](auto&& concerns, auto&& add) {
      for (const BorderPiece& piece : pieces)
        if (concerns(piece.around))
          x = piece.first, around_x = piece.around,
          size = {std::uint32_t(piece.length), std::uint32_t(piece.rows)}, add();
    };
    for (int j = 1; j < Lattice::directions; ++j) {  // piece after piece, to be joined
      const auto enters = [j](const Surroundings& s) { return s.template may_meet<Lattice>(j); };
      const auto comes = [j](const Surroundings& s) { return s.template may_meet<Lattice>(opposite(j)); };
      for_pieces(enters, [&] { add_explosion(j); });
      for_pieces(comes, [&] { add_coalescence(j); });
      for_pieces([&](const Surroundings& s) { return enters(s) && comes(s); }, [&] { add_passing(j); });
    }
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
          add_patches(face);
      }
    }
    place_kept();
    for (FetchedSlots<T>* slots :
         {&border.before_, &border.coarse_left_, &border.fine_left_[0], &border.fine_left_[1]})
      slots->values.resize(slots->count);
  }

  /// Gives what is kept of each patch its place, in the order of passes. Explosions then refer to what is
  /// carried instead of to entries of carry_, and these to copied populations before collision.
  void place_kept() {
    std::uint32_t carried = 0, sums = 0;
    std::pmr::vector<typename Patches::Carried> carry(border.carry_.get_allocator());
    const auto place = [&](Lists& list) {
      PatchJoints<T>::turn_columns(list, border.carry_);
      for (Explosion& one : list.explosions) {
        keep_before(carry.emplace_back(border.carry_[one.carried]));
        one.carried = carry.back().first =
            std::exchange(carried, carried + std::uint32_t(Patches::carried_values) * one.size.cells());
      }
      for (Coalescence& one : list.coalescences) one.sum = std::exchange(sums, sums + one.size.cells());
    };
    for (auto& parts : border.ready_) std::for_each(parts.begin(), parts.end(), place);
    place(border.late_);
    border.carry_.swap(carry);
    for (typename Patches::Passing& one : border.passing_)
      one.kept = std::exchange(sums, sums + one.size.cells());
    border.carried_.resize(carried), border.sums_.resize(sums);
  }

  /// Lists the copies of populations before collision.
  void keep_before(typename Patches::Carried& its) {
    if (!its.in_time() || its.before.array == before_table()) return;
    FetchedSlots<T>& kept = border.before_;
    const std::uint32_t first = kept.count;
    for_runs(its.before, its.size, [&](const SlotRun& run) {
      kept.exchange.copied().add(run, {before_table(), kept.count, 1, run.length});
      kept.count += run.length;
    });
    its.before = {before_table(), std::int32_t(first), 1, std::int32_t(its.size.length)};
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
