#include "lbm/exchange/halo.hpp"

#include <algorithm>
#include <map>

#include "lbm/exchange/ghost_home.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

namespace {

enum class RowEndKind { lists, round, wall };

/// How the end of a row is served: by lists, by the row itself (it spans a periodic axis), or by a wall.
RowEndKind row_end_kind(const Domain& domain, const CellBox& box, bool upper) {
  const int cells = domain.cells().x;
  if (domain.periodic(0)) return box.size.x == cells ? RowEndKind::round : RowEndKind::lists;
  const bool at_side = upper ? box.lower.x + box.size.x == cells : box.lower.x == 0;
  return at_side && domain.side(0, upper).kind == SideKind::bounce ? RowEndKind::wall : RowEndKind::lists;
}

/// Returns whether the dense pass gives this ghost slot (g local to the block) its final value. At a wall it
/// treats all slots of a face alike; slots at edges that differ are listed and corrected after the pass.
template <class Lattice>
bool is_row_end(const Domain& domain, const CellBox& box, Int3 g, int j) {
  if (g.x >= 0 && g.x < box.size.x) return false;
  const RowEndKind kind = row_end_kind(domain, box, g.x > 0);
  if (kind == RowEndKind::wall) {
    const Int3 met = domain.walls_met(box.lower + g);
    bool varies = false;  // at an edge: addends that are equal now may differ later
    for (int d = 0; d < 3; ++d) varies |= met[d] != 0 && domain.side(d, met[d] > 0).varies;
    if (varies && met != Int3{Lattice::c[j].x, 0, 0}) return false;
    return wall_addend<Lattice>(domain, met, j) == wall_addend<Lattice>(domain, {Lattice::c[j].x, 0, 0}, j);
  }
  const bool own_row = g.y >= 0 && g.y < box.size.y && g.z >= 0 && g.z < box.size.z;
  return kind == RowEndKind::round && own_row;
}

/// Sets the row ends of a block. An even pass has just written the homes of a row, an odd pass the ghost
/// slots into which the last cell of the row sends.
template <class T, class Lattice>
void add_row_ends(const Domain& domain, Block<T, Lattice>& block) {
  const int nx = block.size().x;
  for (int j = 1; j < Lattice::directions; ++j) {
    if (Lattice::c[j].x == 0) continue;
    const bool upper = Lattice::c[j].x > 0;
    const int ghost = upper ? nx : -1, near = upper ? nx - 1 : 0, far = upper ? 0 : nx - 1;
    const auto at = [&](int x, int i, bool sent) {
      return block.slot(i) + block.cell(x, sent ? Lattice::c[j].y : 0, sent ? Lattice::c[j].z : 0);
    };
    const RowEndKind kind = row_end_kind(domain, block.box(), upper);
    if (kind == RowEndKind::round) {
      block.add_row_end(Parity::settled, {at(far, j, false), at(ghost, j, false), false, T(0)});
      block.add_row_end(Parity::crossed, {at(ghost, j, true), at(far, j, true), false, T(0)});
    } else if (kind == RowEndKind::wall) {
      const T addend = T(wall_addend<Lattice>(domain, {Lattice::c[j].x, 0, 0}, j));
      block.add_row_end(Parity::settled, {at(near, opposite(j), false), at(ghost, j, true), true, addend});
      block.add_row_end(Parity::crossed, {at(ghost, j, true), at(near, opposite(j), false), true, addend});
    }
  }
}

}  // namespace

template <class T, class Lattice>
struct Halo<T, Lattice>::Builder {
  Halo& halo;
  const Domain& domain;
  int rank;
  std::span<const Block> blocks;
  std::span<const PassOrder> orders;
  std::map<std::pair<int, int>, std::vector<std::pair<std::uint32_t, OutletLink>>> outlets = {};
  bool sides_vary = std::ranges::any_of(domain.sides(), &SideCondition::varies);
  int axis = 0;  // of the present row of slots
  std::uint32_t length = 1;

  SlotRun run(int local_block, Int3 cell, int i) const {
    const Block& b = blocks[local_block];
    const std::ptrdiff_t strides[] = {1, b.row_stride(), b.plane_stride()};
    return {std::uint32_t(local_block), std::uint32_t(b.slot(i) + b.cell(cell)), std::int32_t(strides[axis]),
            length};
  }

  /// Lists the row of populations that left a block along j, from ghost cell g on.
  void add_row(const BlockPlace& place, Int3 g, int j, const BlockPlace& home_place, const Home& home) {
    const int here = domain.local_index(place, rank), there = domain.local_index(home_place, rank);
    if (here < 0 && there < 0) return;
    const Int3 ghost = g - place.box.lower, cell = home.cell - home_place.box.lower;
    const SlotRun from = there >= 0 ? run(there, cell, home.direction) : SlotRun{},
                  to = here >= 0 ? run(here, ghost, j) : SlotRun{};
    if (here >= 0 && there >= 0 && blocks[there].data() + from.first == blocks[here].data() + to.first)
      return;
    halo.slots_.add(home_place.rank, from, place.rank, to, rank);
    if (here < 0)
      hold_back(place.rank, orders[there], cell);
    else if (there < 0)
      hold_back(home_place.rank, orders[here], ghost - Lattice::c[j]);
  }
  /// Messages whose slots are written outside the shell leave after the pass.
  void hold_back(int other, const PassOrder& order, Int3 writer) {
    for (std::uint32_t k = 0; k < length; ++k, ++writer[axis])
      if (!order.in_shell(writer.y, writer.z)) return halo.slots_.hold_back(other);
  }

  /// Lists what crosses the faces of a block, to other blocks or through periodic sides.
  void add_across(const BlockPlace& place) {
    const auto add_box = [&](const BlockPlace& home_place, Int3 way, const CellBox& ghosts, int j) {
      const bool by_rows = home_place.index == place.index && way.y == 0 && way.z == 0;  // is_row_end()
      if (by_rows || !domain.is_of_level(home_place)) return;  // level_border.hpp serves other levels
      axis = ghosts.size.x > 1 ? 0 : ghosts.size.y > 1 ? 1 : 2;
      length = std::uint32_t(ghosts.size[axis]);
      CellBox firsts = ghosts;
      firsts.size[axis] = 1;
      for_cells(firsts.lower, firsts.lower + firsts.size, [&](Int3 g) {
        add_row(place, g, j, home_place, {HomeKind::slot, g - way, j});
      });
    };
    for_ghost_boxes<Lattice>(domain, place.box, add_box);
    length = 1;
  }

  /// Lists what meets sides that are not periodic.
  void add_at_sides(const BlockPlace& place) {
    for (int j = 1; j < Lattice::directions; ++j) {
      CellBox left{place.box.lower + Lattice::c[j], place.box.size};  // not listed yet
      for (int d = 0; d < 3; ++d) {
        const bool low = left.lower[d] == -1, high = left.lower[d] + left.size[d] == domain.cells()[d] + 1;
        if (domain.periodic(d) || low == high) continue;
        CellBox beyond = left;
        if (high) beyond.lower[d] += left.size[d] - 1;
        beyond.size[d] = 1, --left.size[d], left.lower[d] += low;
        axis = d == 0 ? 1 : 0;
        for_cells(beyond.lower, beyond.lower + beyond.size, [&](Int3 g) { add_at_side(place, g, j); });
      }
    }
  }
  void add_at_side(const BlockPlace& place, Int3 g, int j) {
    const Int3 ghost = g - place.box.lower;
    if (is_row_end<Lattice>(domain, place.box, ghost, j)) return;
    const Home home = home_of<Lattice>(domain, g, j);
    const int here = domain.local_index(place, rank);
    if (home.kind != HomeKind::slot) {
      if (here >= 0) add_wall(here, ghost, j, home, domain.walls_met(g));
    } else if (const BlockPlace mirrored = domain.block_at(home.cell); domain.is_of_level(mirrored)) {
      add_row(place, g, j, mirrored, home);
    }
  }

  void add_wall(int here, Int3 g, int j, const Home& home, Int3 sides) {
    const SlotRun from = run(here, g - Lattice::c[j], opposite(j)), to = run(here, g, j);
    if (home.kind == HomeKind::bounce) {
      Walls& walls = halo.walls_;
      const T addend = T(wall_addend<Lattice>(domain, sides, j));
      const std::pair met(sides, j);
      std::pmr::vector<T>& addends = walls.addends.host();
      const bool is_alike =
          !addends.empty() && addends.back() == addend && (!sides_vary || walls.met.back() == met);
      if (!walls.pairs.add(from, to, is_alike)) addends.push_back(addend), walls.met.push_back(met);
    } else {
      const auto part = [](int of) { return std::int8_t(of); };
      outlets[{here, home.side}].push_back(
          {run(here, g - Lattice::c[j], 0).first,
           {to.first, from.first, part(Lattice::c[j].x), part(Lattice::c[j].y), part(Lattice::c[j].z),
            part(opposite(j))}});
    }
  }

  void build() {
    for (const int b : domain.neighbourhood_of_rank(rank)) {
      const BlockPlace place = domain.block(b);
      add_across(place);
      add_at_sides(place);
    }
    for (auto& [key, links] : outlets) add_outlet(key.first, domain.sides()[key.second], links);
  }

  template <class Links>
  void add_outlet(int block, const SideCondition& side, Links& links) {
    Outlet outlet{block, side, Mirror<OutletCell>(halo.device_), Mirror<OutletLink>(halo.device_)};
    std::pmr::vector<OutletCell>& cells = outlet.cells.host();
    std::stable_sort(links.begin(), links.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [cell, link] : links) {
      const auto n = std::uint32_t(outlet.links.size());
      if (cells.empty() || cells.back().cell != cell) cells.push_back({cell, n, n});
      outlet.links.host().push_back(link), ++cells.back().last;
    }
    outlet.cells.send(), outlet.links.send();
    halo.outlets_.push_back(std::move(outlet));
  }
};

template <class T, class Lattice>
Halo<T, Lattice>::Halo(const Domain& domain, MPI_Comm comm, std::span<Block> blocks,
                       std::span<const PassOrder> orders, const AtOutlets& at_outlets, Device device)
    : at_outlets_(at_outlets),
      device_(device),
      slots_(comm, Lattice::directions, device),
      sources_(device),
      targets_(device),
      idle_(blocks.size(), 0),
      walls_{SlotPairs(device), Mirror<T>(device)} {
  Builder{*this, domain, parallel::rank_of(comm), blocks, orders}.build();
  for (Block& block : blocks) {
    add_row_ends(domain, block);
    sources_.host().push_back(block.data()), targets_.host().push_back(block.data());
  }
  slots_.send_lists(), walls_.pairs.send(), walls_.addends.send();
  sources_.send(), targets_.send();
}

template <class T, class Lattice>
void Halo<T, Lattice>::take_side_velocities(const Domain& domain, std::span<Block> blocks) {
  for (std::size_t k = 0; k < walls_.addends.size(); ++k)
    walls_.addends.host()[k] = T(wall_addend<Lattice>(domain, walls_.met[k].first, walls_.met[k].second));
  walls_.addends.send();
  for (Block& block : blocks) {
    block.clear_row_ends();
    add_row_ends(domain, block);
  }
}

template <class T, class Lattice>
void Halo<T, Lattice>::start(Parity parity) {
  slots_.start({sources_.device(), sources_.size()}, parity == Parity::settled);
}

template <class T, class Lattice>
void Halo<T, Lattice>::apply_outlet(Block& block, const Outlet& o, Parity parity) const {
  OutletCells<T, Lattice> cells{block.data(),
                                {},
                                {},
                                at_outlets_.reversed,
                                parity == Parity::crossed,
                                o.cells.device(),
                                o.links.device(),
                                o.cells.size()};
  for (int i = 0; i < Lattice::directions; ++i) cells.left[i] = block.leaving(i, parity) - block.slot(0);
  for (int d = 0; d < 3; ++d) cells.half_force[d] = 0.5 * at_outlets_.force[d];
  if constexpr (std::is_same_v<Lattice, D3Q7>)
    passes_on<T>(device_).return_temperature(cells, o.side);
  else
    passes_on<T>(device_).return_from_outlet(cells, o.side);
}

template <class T, class Lattice>
void Halo<T, Lattice>::exchange(std::span<Block> blocks, std::span<const char> idle, Parity parity) {
  if (!std::ranges::equal(idle, idle_)) {
    idle_.assign(idle.begin(), idle.end());
    for (std::size_t b = 0; b < blocks.size(); ++b) targets_.host()[b] = idle[b] ? nullptr : blocks[b].data();
    targets_.send();
  }
  const bool back = parity == Parity::settled;
  slots_.finish({sources_.device(), sources_.size()}, {targets_.device(), targets_.size()}, back);
  const Mirror<T>& addends = walls_.addends;
  passes_on<T>(device_).move_slots(walls_.pairs, {addends.device(), addends.size()},
                                   {.table = sources_.device()}, {.table = targets_.device()}, back);
  for (const Outlet& outlet : outlets_)
    if (!idle[outlet.block]) apply_outlet(blocks[outlet.block], outlet, parity);
  wait(device_);
}

template class Halo<float>;
template class Halo<double>;
template class Halo<float, D3Q7>;
template class Halo<double, D3Q7>;

}  // namespace silt::lbm
