// The lists of a border: which packet goes where is found by following each of them.
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>

#include "lbm/ghost_home.hpp"
#include "lbm/level_border.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

namespace of_border {

/// A population that left a cell, or what an outlet returned to one; of fine ones in which fine step.
struct Population {
  int sub_step, direction;
  Int3 cell;
  bool returned = false;
  auto order() const { return std::tie(returned, sub_step, direction, cell.z, cell.y, cell.x); }
  bool operator<(const Population& other) const { return order() < other.order(); }
};
using Populations = std::set<Population>;

constexpr Int3 corner(int k) {
  return {k & 1, k >> 1 & 1, k >> 2 & 1};
}

/// A population on its way from fine cell to fine cell.
struct Flight {
  Int3 cell;
  int direction;
  double addend = 0;       // by walls that it met
  double by_force = 0;     // what the force adds on the way
  bool by_outlet = false;  // it met one
};

/// Half of what the force adds in a fine cell to what leaves it along j. What leaves a fine cell at rest has
/// that much more than what a coarse cell would have sent, what arrives in it lacks as much; and a packet
/// that passes a place without a collision lacks twice as much.
double by_force(const CollisionSpec& fine, int j) {
  return 1.5 * w(j) * (c[j].x * fine.force[0] + c[j].y * fine.force[1] + c[j].z * fine.force[2]);
}

Flight one_step(const Domain& fine, Flight p) {
  const Int3 g = p.cell + c[p.direction];
  const Home home = home_of(fine, g, p.direction);
  if (home.kind == HomeKind::bounce) p.addend += wall_addend(fine, fine.walls_met(g), p.direction);
  p.by_outlet |= home.kind == HomeKind::outlet;
  p.cell = home.cell, p.direction = home.direction;
  return p;
}

/// Which levels cells have, asked for cells that lie near one another.
class LevelOf {
 public:
  explicit LevelOf(const Domain& fine) : fine_(fine) {}
  const BlockPlace& block_at(Int3 fine_cell) {
    if (!last_.box.contains(fine_cell)) last_ = fine_.block_at(fine_cell);
    return last_;
  }
  int operator()(Int3 fine_cell) { return fine_.tree().kinds()[block_at(fine_cell).index].level; }

 private:
  const Domain& fine_;
  BlockPlace last_{-1, {}, -1};
};

/// The blocks of a domain that lie near the blocks of a rank in one of two, in an order on which ranks agree.
std::vector<int> blocks_near(const Domain& of, const Domain& fine, const Domain& coarse, int rank) {
  std::set<int> near;
  const auto add = [&](const CellBox& box) {
    for (const int b : of.blocks_meeting(box)) near.insert(b);
  };
  for (const BlockPlace& mine : fine.blocks_of(rank)) {
    const CellBox around = grown(mine.box, 4);
    if (of.level() == fine.level())
      add(around);
    else
      add(grown({{around.lower.x >> 1, around.lower.y >> 1, around.lower.z >> 1},
                 {around.size.x / 2 + 1, around.size.y / 2 + 1, around.size.z / 2 + 1}},
                0));
  }
  for (const BlockPlace& mine : coarse.blocks_of(rank)) {
    const CellBox around = grown(mine.box, 2);
    if (of.level() == coarse.level())
      add(around);
    else
      add({around.lower + around.lower, around.size + around.size});
  }
  return {near.begin(), near.end()};
}

}  // namespace of_border
using namespace of_border;

template <class T>
struct LevelBorder<T>::Builder {
  LevelBorder& border;
  const Domain &fine, &coarse;
  int rank;
  LevelOf level_of{fine};

  /// What ranks need of what others, or they themselves, have: by who needs and who has it, as far as this
  /// rank is one of them.
  using Needs = std::map<std::pair<int, int>, Populations>;
  Needs coarse_left = {}, before = {}, fine_left[2] = {};

  struct Source {  // a coarse population of which packets enter fine cells here, or are taken from a cell
                   // here
    Population left;
    std::array<std::optional<Int3>, 3> plus, minus;  // coarse cells beside it
    bool in_time;
    struct Entry {
      int sub_step, corner;
      Flight to;
    };
    std::vector<Entry> entries;  // into blocks of this rank
  };
  std::vector<Source> sources = {};
  struct Arrival {
    std::vector<Population> packets;
    double addend = 0;
    int entered = 0, by_outlet = 0;  // packets: into fine cells, and fine ones that came back from an outlet
    std::vector<std::pair<Source, Int3>> taken;  // and the sum of the corners of what entered
  };
  std::map<std::tuple<int, int, int, int, int>, Arrival> arrivals = {};  // by block, direction, z, y, x
  struct Between {
    Population left;
    Flight to;
  };
  std::vector<Between> passing = {};

  static void need(Needs& needs, int who, int from, const Population& what, int rank) {
    if (who == rank || from == rank) needs[{who, from}].insert(what);
  }

  double by_force(int j) const { return of_border::by_force(border.fine_.spec(), j); }
  bool is_fine(Int3 cell) { return level_of(cell) == fine.level(); }
  bool is_known(Int3 cell) { return level_of(cell) != LeafKind::far; }
  Arrival& arrival(const BlockPlace& place, Int3 coarse_cell, int j) {
    const Int3 x = coarse_cell - place.box.lower;
    return arrivals[{coarse.local_index(place, rank), j, x.z, x.y, x.x}];
  }

  /// Follows the packets of what left the coarse cell x along j.
  void follow_coarse(const BlockPlace& place, Int3 x, int j) {
    Source source{{0, j, x}, {}, {}, false, {}};
    int entered[2] = {};
    Int3 corners{};
    bool turned = false;
    for (int k = 0; k < 8; ++k) {
      Flight packet{x + x + corner(k), j, 0, -by_force(j)};
      for (int sub_step = 0; sub_step < 2; ++sub_step) {
        if (sub_step == 1) packet.by_force += 2 * by_force(packet.direction);
        packet = one_step(fine, packet);
        if (!is_known(packet.cell)) return;
        if (!is_fine(packet.cell)) continue;
        source.entries.push_back({sub_step, k, packet});
        ++entered[sub_step], turned |= packet.by_outlet;
        corners = corners + corner(k) + corner(k) - Int3{1, 1, 1};
        break;
      }
    }
    if (source.entries.empty()) return;
    source.in_time = entered[0] == 4 && entered[1] == 4 && !turned;
    for (int d = 0; d < 3; ++d)
      for (const int side : {-1, 1}) {
        Int3 beside = x;
        beside[d] += side;
        beside = coarse.wrapped(beside);
        if (!coarse.inside(beside) || !coarse.has(beside)) continue;
        (side > 0 ? source.plus : source.minus)[d] = beside;
      }
    std::set<int> users;
    for (const auto& entry : source.entries) users.insert(level_of.block_at(entry.to.cell).rank);
    if (users.contains(rank)) sources.push_back(source);
    const Home home = home_of(coarse, x + c[j], j);
    const BlockPlace& home_place = level_of.block_at(home.cell + home.cell);
    if (fine.tree().kinds()[home_place.index].level == coarse.level()) {
      users.insert(home_place.rank);
      if (home_place.rank == rank) {
        Arrival& there = arrival(coarse.block(home_place.index), home.cell, home.direction);
        there.entered += entered[0] + entered[1];
        there.taken.push_back({source, corners});
      }
    }
    for (const int user : users) {
      need(coarse_left, user, place.rank, source.left, rank);
      if (source.in_time) need(before, user, place.rank, source.left, rank);
      if (turned) need(coarse_left, user, place.rank, {0, opposite(j), x, true}, rank);
      for (const auto& side : {source.plus, source.minus})
        for (const auto& beside : side)
          if (beside) need(coarse_left, user, coarse.rank_at(*beside), {0, j, *beside}, rank);
    }
  }

  /// Follows what leaves the fine cell x along j, in either step.
  void follow_fine(const BlockPlace& place, Int3 x, int j) {
    const Flight once = one_step(fine, {x, j});
    if (level_of(once.cell) != coarse.level()) return;
    Flight twice = one_step(fine, once);
    twice.by_force = 2 * by_force(once.direction);
    if (!is_known(twice.cell)) return;
    for (int sub_step = 0; sub_step < 2; ++sub_step) {
      const Population left{sub_step, j, x};
      const Flight& end = sub_step == 0 ? twice : once;
      const BlockPlace there = level_of.block_at(end.cell);
      need(fine_left[sub_step], there.rank, place.rank, left, rank);
      if (there.rank != rank) continue;
      if (is_fine(end.cell)) {
        passing.push_back({left, end});
        continue;
      }
      const Int3 cell{end.cell.x >> 1, end.cell.y >> 1, end.cell.z >> 1};
      Arrival& here = arrival(coarse.block(there.index), cell, end.direction);
      if (end.by_outlet) {
        ++here.by_outlet;
      } else {
        here.packets.push_back(left);
        here.addend += (end.addend + end.by_force - by_force(end.direction)) / 8;
      }
    }
  }

  /// Lists what is fetched, in order; returns where it lies.
  static std::map<Population, std::int32_t> list(const Needs& needs, SlotExchange<T>& slots,
                                                 const Fluid<T>& fluid, int rank, std::int32_t first = 0) {
    std::map<Population, std::int32_t> all;
    for (const auto& [ends, populations] : needs)
      if (ends.first == rank)
        for (const Population& p : populations) all[p] = 0;
    std::int32_t next = first;
    for (auto& [p, at] : all) at = next++;
    const Domain& domain = fluid.domain();
    for (const auto& [ends, populations] : needs)
      for (const Population& p : populations) {
        SlotRun from{0, 0}, to{0, 0};
        if (ends.first == rank) to.first = std::uint32_t(all.at(p));
        if (ends.second == rank) {
          const BlockPlace place = domain.block_at(p.cell);
          const auto& blocks = fluid.blocks();
          const int b = domain.local_index(place, rank);
          from.array =
              std::uint32_t((p.returned ? blocks.size() : 0) * directions + b * directions + p.direction);
          from.first = std::uint32_t(blocks[b].cell(p.cell - place.box.lower));
        }
        if (ends.first == ends.second)
          slots.copied().add(from, to);
        else if (ends.first == rank)
          slots.received(ends.second).add(to);
        else
          slots.sent(ends.first).add(from);
      }
    return all;
  }

  void build();
  void add_explosion(const Source&);
  void add_coalescence(int block, int j, Int3 cell, const Arrival&);
  std::map<Population, std::int32_t> of_coarse = {}, of_before = {}, of_fine[2] = {};
};

namespace {

/// Adds one to rows: as the next of the last row, if all places go on as they did.
template <class Row, class Alike>
void add_to_rows(std::vector<Row>& rows, Row one, Alike&& alike) {
  if (!rows.empty() && alike(rows.back(), one)) {
    Row& row = rows.back();
    auto step = one.at.first;
    for (std::size_t k = 0; k < step.size(); ++k) step[k] -= row.at.of(int(k), row.length - 1);
    if (row.length == 1 || step == row.at.step) {
      row.at.step = step;
      ++row.length;
      return;
    }
  }
  rows.push_back(std::move(one));
}

}  // namespace

template <class T>
void LevelBorder<T>::Builder::add_explosion(const Source& source) {
  const auto place_of = [&](Int3 cell) { return of_coarse.at({0, source.left.direction, cell}); };
  Explosion one{};
  one.length = 1;
  one.in_time = source.in_time;
  auto& at = one.at.first;
  at[Explosion::value] = place_of(source.left.cell);
  if (source.in_time) at[Explosion::before] = of_before.at(source.left);
  for (int d = 0; d < 3; ++d) {
    const auto &plus = source.plus[d], &minus = source.minus[d];
    at[Explosion::plus + d] = plus ? place_of(*plus) : at[Explosion::value];
    at[Explosion::minus + d] = minus ? place_of(*minus) : at[Explosion::value];
    one.slope[d] = plus && minus ? T(1. / 8) : plus || minus ? T(1. / 4) : T(0);
  }
  Explosion from_outlet = one;
  for (const auto& entry : source.entries) {
    const BlockPlace& place = level_of.block_at(entry.to.cell);
    const int b = fine.local_index(place, rank);
    if (b < 0) continue;
    Explosion& its = entry.to.by_outlet ? from_outlet : one;
    const std::size_t k = its.packets.size();
    const double addend = entry.to.addend + (source.in_time ? 0 : entry.to.by_force);
    its.packets.push_back({std::uint32_t(b * directions + entry.to.direction), std::uint8_t(entry.sub_step),
                           std::uint8_t(entry.corner), T(addend)});
    its.at.first[Explosion::target + k] =
        std::int32_t(border.fine_.blocks()[b].cell(entry.to.cell - place.box.lower));
  }
  const auto alike = [](const Explosion& a, const Explosion& b) {
    return a.slope == b.slope && a.in_time == b.in_time && a.packets == b.packets;
  };
  if (!from_outlet.packets.empty()) {
    from_outlet.slope = {};
    from_outlet.at.first[Explosion::value] =
        of_coarse.at({0, opposite(source.left.direction), source.left.cell, true});
    add_to_rows(border.explosions_, from_outlet, alike);
  }
  if (!one.packets.empty()) add_to_rows(border.explosions_, one, alike);
}

template <class T>
void LevelBorder<T>::Builder::add_coalescence(int block, int j, Int3 cell, const Arrival& arrival) {
  if (int(arrival.packets.size()) + arrival.by_outlet != (arrival.entered ? arrival.entered : 8))
    throw std::logic_error("packets are lost or made at a border between levels");
  Coalescence one{};
  one.length = 1;
  one.array = std::uint32_t(block * directions + j);
  one.packets = int(arrival.packets.size());
  one.addend = T(arrival.addend);
  one.at.first[Coalescence::target] = std::int32_t(border.coarse_.blocks()[block].cell(cell));
  std::vector<Population> packets = arrival.packets;
  std::sort(packets.begin(), packets.end());
  for (int k = 0; k < one.packets; ++k)
    one.at.first[Coalescence::packet + k] = of_fine[packets[k].sub_step].at(packets[k]);
  for (const auto& [source, corners] : arrival.taken)
    for (int d = 0; d < 3; ++d) {
      if (corners[d] == 0 || (!source.plus[d] && !source.minus[d])) continue;
      const auto place_of = [&](const std::optional<Int3>& beside) {
        return of_coarse.at({0, source.left.direction, beside ? *beside : source.left.cell});
      };
      const T slope = source.plus[d] && source.minus[d] ? T(1. / 8) : T(1. / 4);
      one.taken.push_back({place_of(source.plus[d]), place_of(source.minus[d]), T(corners[d]) * slope});
    }
  const auto alike = [](const Coalescence& a, const Coalescence& b) {
    return a.array == b.array && a.packets == 8 && b.packets == 8 && a.addend == b.addend;
  };
  add_to_rows(border.coalescences_, one, alike);
}

template <class T>
void LevelBorder<T>::Builder::build() {
  for (const int b : blocks_near(coarse, fine, coarse, rank)) {
    const BlockPlace place = coarse.block(b);
    const CellBox around = grown({place.box.lower + place.box.lower, place.box.size + place.box.size}, 2);
    if (fine.blocks_meeting(around).empty()) continue;
    for_ghost_slots(place.box.size,
                    [&](Int3 g, int j) { follow_coarse(place, place.box.lower + g - c[j], j); });
  }
  for (const int b : blocks_near(fine, fine, coarse, rank)) {
    const BlockPlace place = fine.block(b);
    for_ghost_slots(place.box.size,
                    [&](Int3 g, int j) { follow_fine(place, place.box.lower + g - c[j], j); });
  }
  of_coarse = list(coarse_left, border.coarse_left_, border.coarse_, rank);
  of_before = list(before, border.before_, border.coarse_, rank);
  for (int s = 0; s < 2; ++s)
    of_fine[s] = list(fine_left[s], border.fine_left_[s], border.fine_, rank,
                      s == 0 ? 0 : std::int32_t(of_fine[0].size()));
  border.coarse_values_.resize(of_coarse.size());
  border.coarse_before_.resize(of_before.size());
  border.fine_values_.resize(of_fine[0].size() + of_fine[1].size());
  for (const Source& source : sources) add_explosion(source);
  for (const auto& [key, arrival] : arrivals) {
    const auto& [block, j, z, y, x] = key;
    add_coalescence(block, j, {x, y, z}, arrival);
  }
  for (const Between& p : passing) {
    const BlockPlace& place = level_of.block_at(p.to.cell);
    const int b = fine.local_index(place, rank);
    border.passing_.push_back({std::uint32_t(b * directions + p.to.direction),
                               std::int32_t(border.fine_.blocks()[b].cell(p.to.cell - place.box.lower)),
                               of_fine[0].at(p.left), T(p.to.addend + p.to.by_force)});
  }
}

template <class T>
LevelBorder<T>::LevelBorder(Fluid<T>& fine, Fluid<T>& coarse)
    : fine_(fine),
      coarse_(coarse),
      before_(fine.comm(), 5),
      coarse_left_(fine.comm(), 5),
      fine_left_{{fine.comm(), 5}, {fine.comm(), 5}} {
  Builder{*this, fine.domain(), coarse.domain(), parallel::rank_of(fine.comm())}.build();
}

template LevelBorder<float>::LevelBorder(Fluid<float>&, Fluid<float>&);
template LevelBorder<double>::LevelBorder(Fluid<double>&, Fluid<double>&);

}  // namespace silt::lbm
