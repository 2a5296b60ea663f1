#include "lbm/halo.hpp"

#include <algorithm>
#include <map>

#include "lbm/prefetch.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

namespace {

enum class HomeKind { slot, bounce, outlet };

struct Home {
  HomeKind kind;
  Int3 cell;  // global
  int direction;
  int axis = -1;  // of the wall, for bounce and outlet
  bool upper = false;
};

/// The home of the population that left along j into the ghost cell g (global, unwrapped).
Home home_of(const Domain& domain, Int3 g, int j) {
  Int3 cell = g, direction = c[j];
  Home pressure{HomeKind::slot, {}, 0};
  for (int d = 0; d < 3; ++d) {
    if (domain.periodic(d) || (cell[d] >= 0 && cell[d] < domain.cells()[d])) continue;
    const bool upper = cell[d] >= domain.cells()[d];
    switch (domain.side(d, upper).kind) {
      case SideKind::bounce:
        return {HomeKind::bounce, g - c[j], opposite(j), d, upper};
      case SideKind::pressure:
        pressure = {HomeKind::outlet, g - c[j], opposite(j), d, upper};
        break;
      case SideKind::periodic:  // has been left out
        break;
      case SideKind::free_slip:  // the mirror image of cell and direction
        cell[d] = upper ? 2 * domain.cells()[d] - 1 - cell[d] : -1 - cell[d];
        direction[d] = -direction[d];
    }
  }
  if (pressure.kind == HomeKind::outlet) return pressure;
  return {HomeKind::slot, domain.wrapped(cell), direction_of(direction)};
}

/// What moving walls add to what left along j and meets these sides.
double wall_addend(const Domain& domain, Int3 sides, int j) {
  return -6 * w(j) * domain.wall_velocity_along(sides, j);
}

enum class RowEndKind { lists, round, wall };

/// The rows of a block may by themselves go round to the other end, or meet a wall; else the lists of this
/// file do what is to do there.
RowEndKind row_end_kind(const Domain& domain, const CellBox& box, bool upper) {
  const int cells = domain.cells().x;
  if (domain.periodic(0)) return box.size.x == cells ? RowEndKind::round : RowEndKind::lists;
  const bool at_side = upper ? box.lower.x + box.size.x == cells : box.lower.x == 0;
  return at_side && domain.side(0, upper).kind == SideKind::bounce ? RowEndKind::wall : RowEndKind::lists;
}

/// Whether the dense pass moves this ghost slot (g local to the block) for good. At a wall it does as the
/// face does; edges that do otherwise are listed, and put right after it.
bool is_row_end(const Domain& domain, const CellBox& box, Int3 g, int j) {
  if (g.x >= 0 && g.x < box.size.x) return false;
  const RowEndKind kind = row_end_kind(domain, box, g.x > 0);
  if (kind == RowEndKind::wall)
    return wall_addend(domain, domain.walls_met(box.lower + g), j) == wall_addend(domain, {c[j].x, 0, 0}, j);
  const bool own_row = g.y >= 0 && g.y < box.size.y && g.z >= 0 && g.z < box.size.z;
  return kind == RowEndKind::round && own_row;
}

/// Gives the block its row ends. An even pass has just written the homes of its row, an odd one the ghost
/// slots that its row's last cell sends to.
template <class T>
void add_row_ends(const Domain& domain, Block<T>& block) {
  const int nx = block.size().x;
  for (int j = 1; j < directions; ++j) {
    if (c[j].x == 0) continue;
    const bool upper = c[j].x > 0;
    const int ghost = upper ? nx : -1, near = upper ? nx - 1 : 0, far = upper ? 0 : nx - 1;
    const auto at = [&](int x, int i, bool sent) {
      return block.slot(i) + block.cell(x, sent ? c[j].y : 0, sent ? c[j].z : 0);
    };
    const RowEndKind kind = row_end_kind(domain, block.box(), upper);
    if (kind == RowEndKind::round) {
      block.add_row_end(Parity::settled, {at(far, j, false), at(ghost, j, false), false, T(0)});
      block.add_row_end(Parity::crossed, {at(ghost, j, true), at(far, j, true), false, T(0)});
    } else if (kind == RowEndKind::wall) {
      const T addend = T(wall_addend(domain, {c[j].x, 0, 0}, j));
      block.add_row_end(Parity::settled, {at(near, opposite(j), false), at(ghost, j, true), true, addend});
      block.add_row_end(Parity::crossed, {at(ghost, j, true), at(near, opposite(j), false), true, addend});
    }
  }
}

/// Copies a few slots at a time, without a call.
template <class T>
inline void copy_slots(const T* from, T* to, std::uint32_t length) {
  for (std::uint32_t n = 0; n < length; ++n) to[n] = from[n];
}

/// Calls visit(g, j) for every ghost slot of a block: g local to the block, g - c_j inside it.
template <class Visit>
void for_ghost_slots(Int3 size, Visit&& visit) {
  for (int j = 1; j < directions; ++j) {
    Int3 lo = c[j], hi = size + c[j];
    for (int z = lo.z; z < hi.z; ++z)
      for (int y = lo.y; y < hi.y; ++y) {
        const bool outside = y < 0 || z < 0 || y >= size.y || z >= size.z;
        if (outside)
          for (int x = lo.x; x < hi.x; ++x) visit(Int3{x, y, z}, j);
        else if (c[j].x)
          visit(Int3{c[j].x > 0 ? size.x : -1, y, z}, j);
      }
  }
}

}  // namespace

template <class T>
void Halo<T>::add_to(std::vector<Run>& runs, std::uint32_t ghost, std::uint32_t home) {
  if (!runs.empty() && runs.back().ghost + runs.back().length == ghost &&
      runs.back().home + runs.back().length == home)
    ++runs.back().length;
  else
    runs.push_back({ghost, home, 1});
}

template <class T>
void Halo<T>::add_to(std::vector<Place>& places, int block, std::uint32_t slot) {
  if (!places.empty() && places.back().block == block && places.back().slot + places.back().length == slot)
    ++places.back().length;
  else
    places.push_back({block, slot, 1});
}

template <class T>
struct Halo<T>::Builder {
  Halo& halo;
  const Domain& domain;
  int rank;
  std::vector<const Block<T>*> layout;
  std::span<const PassOrder> orders;
  std::map<std::pair<int, int>, Copy> copies;
  std::map<std::tuple<int, int, int, int, int>, Wall> walls;  // by block, sides met, direction
  std::map<std::tuple<int, int, bool>, Outlet> outlets;
  std::map<int, Peer> peers;
  BlockPlace home_block{-1, {}, -1};  // of the last home: rows stay in one block
  const BlockPlace& block_at(Int3 cell) {
    if (!home_block.box.contains(cell)) home_block = domain.block_at(cell);
    return home_block;
  }

  std::uint32_t slot(int local_block, Int3 cell, int i) const {
    const Block<T>& b = *layout[local_block];
    return std::uint32_t(b.slot(i) + b.cell(cell));
  }

  void add(const BlockPlace& place, Int3 g, int j) {
    const int here = domain.local_index(place, rank);
    if (is_row_end(domain, place.box, g, j)) return;
    const Home home = home_of(domain, place.box.lower + g, j);
    if (home.kind != HomeKind::slot) {
      if (here >= 0) add_wall(here, g, j, home, domain.walls_met(place.box.lower + g));
      return;
    }
    const BlockPlace& home_place = block_at(home.cell);
    const int there = domain.local_index(home_place, rank);
    const Int3 cell = home.cell - home_place.box.lower;
    if (here >= 0 && there >= 0) {
      Copy& copy = copies[{here, there}];
      copy.ghost_block = here;
      copy.home_block = there;
      add_to(copy.runs, slot(here, g, j), slot(there, cell, home.direction));
    } else if (here >= 0) {
      const Int3 writer = g - c[j];
      Peer& peer = peers[home_place.rank];
      peer.early &= orders[here].in_shell(writer.y, writer.z);
      add_to(peer.ghosts, here, slot(here, g, j));
    } else if (there >= 0) {
      Peer& peer = peers[place.rank];
      peer.early &= orders[there].in_shell(cell.y, cell.z);
      add_to(peer.homes, there, slot(there, cell, home.direction));
    }
  }

  void add_wall(int here, Int3 g, int j, const Home& home, Int3 sides) {
    const Int3 inner = g - c[j];
    if (home.kind == HomeKind::bounce) {
      Wall& wall = walls[{here, sides.x, sides.y, sides.z, j}];
      wall.block = here, wall.addend = T(wall_addend(domain, sides, j));
      add_to(wall.runs, slot(here, g, j), slot(here, inner, opposite(j)));
    } else {
      Outlet& outlet = outlets[{here, home.axis, home.upper}];
      outlet.block = here, outlet.density_deviation = domain.side(home.axis, home.upper).density_deviation;
      outlet.links.push_back({slot(here, inner, 0), slot(here, g, j), slot(here, inner, opposite(j)), j});
    }
  }

  static std::size_t slots_in(const std::vector<Place>& places) {
    std::size_t n = 0;
    for (const Place& place : places) n += place.length;
    return n;
  }

  void build() {
    for (const int b : domain.neighbourhood_of_rank(rank)) {
      const BlockPlace place = domain.block(b);
      for_ghost_slots(place.box.size, [&](Int3 g, int j) { add(place, g, j); });
    }
    for (auto& [key, x] : copies) halo.copies_.push_back(std::move(x));
    for (auto& [key, x] : walls) halo.walls_.push_back(std::move(x));
    for (auto& [key, x] : outlets) {
      std::stable_sort(x.links.begin(), x.links.end(),
                       [](const OutletLink& a, const OutletLink& b) { return a.cell < b.cell; });
      halo.outlets_.push_back(std::move(x));
    }
    for (auto& [r, peer] : peers) {
      peer.rank = r;
      peer.ghost_buffer.resize(slots_in(peer.ghosts));
      peer.home_buffer.resize(slots_in(peer.homes));
      halo.peers_.push_back(std::move(peer));
    }
  }
};

template <class T>
Halo<T>::Halo(const Domain& domain, MPI_Comm comm, std::span<Block<T>> blocks,
              std::span<const PassOrder> orders, const std::array<double, 3>& force)
    : transfers_(comm, 1), force_(force) {
  const int rank = parallel::rank_of(comm);
  Builder builder{*this, domain, rank, {}, orders, {}, {}, {}, {}};
  for (auto& b : blocks) builder.layout.push_back(&b);
  builder.build();
  for (Block<T>& block : blocks) add_row_ends(domain, block);
}

template <class T>
std::size_t Halo<T>::Peer::bytes() const {
  return (ghost_buffer.size() + home_buffer.size()) * sizeof(T) / 2;
}

template <class T>
std::size_t Halo<T>::message_bytes() const {
  std::size_t bytes = 0;
  for (const Peer& p : peers_) bytes += p.bytes();
  return bytes;
}

template <class T>
std::size_t Halo<T>::early_bytes() const {
  std::size_t bytes = 0;
  for (const Peer& p : peers_)
    if (p.early) bytes += p.bytes();
  return bytes;
}

template <class T>
void Halo<T>::send(std::span<const Block<T>> blocks, Parity parity, std::size_t peer) {
  const bool fill = parity == Parity::crossed;
  Peer& p = peers_[peer];
  auto& outgoing = fill ? p.home_buffer : p.ghost_buffer;
  T* to = outgoing.data();
  for (const Place& run : fill ? p.homes : p.ghosts) {
    copy_slots(blocks[run.block].data() + run.slot, to, run.length);
    to += run.length;
  }
  transfers_.send(p.rank, std::span<const T>(outgoing));
}

template <class T>
void Halo<T>::start(std::span<const Block<T>> blocks, Parity parity) {
  const bool fill = parity == Parity::crossed;
  for (std::size_t k = 0; k < peers_.size(); ++k) {
    auto& incoming = fill ? peers_[k].ghost_buffer : peers_[k].home_buffer;
    transfers_.receive(peers_[k].rank, std::span<T>(incoming));
  }
  for (std::size_t k = 0; k < peers_.size(); ++k)
    if (peers_[k].early) send(blocks, parity, k);
}

template <class T>
void Halo<T>::finish_peers(std::span<Block<T>> blocks, std::span<const char> idle, Parity parity) {
  for (std::size_t k = 0; k < peers_.size(); ++k)
    if (!peers_[k].early) send(std::span<const Block<T>>(blocks), parity, k);
  transfers_.wait();
  const bool fill = parity == Parity::crossed;
  for (Peer& p : peers_) {
    const T* from = (fill ? p.ghost_buffer : p.home_buffer).data();
    for (const Place& run : fill ? p.ghosts : p.homes) {
      if (!idle[run.block]) copy_slots(from, blocks[run.block].data() + run.slot, run.length);
      from += run.length;
    }
  }
}

template <class T>
void Halo<T>::apply_outlet(Block<T>& block, const Outlet& o, Parity parity) const {
  const bool fill = parity == Parity::crossed;
  T* const p = block.data();
  const T* out[directions];  // what left a cell, from its Block::slot(0) on
  for (int i = 1; i < directions; ++i) out[i] = p + (block.leaving(i, parity) - block.slot(0));
  const auto add = [](double& sum, int factor, double g) {  // factor: -1, 0, 1, known to the compiler
    if (factor) sum += factor * g;
  };
  double u[3] = {}, rest = 0;
  for (std::size_t n = 0; n < o.links.size(); ++n) {
    const OutletLink& link = o.links[n];
    if (n == 0 || link.cell != o.links[n - 1].cell) {
      constexpr std::size_t ahead = 5 * 16;  // links: the cells of a cache line
      if (n + ahead < o.links.size())
        for (int i = 1; i < directions; ++i) prefetch_to_read(out[i] + o.links[n + ahead].cell);
      for (int d = 0; d < 3; ++d) u[d] = 0.5 * force_[d];
#pragma GCC unroll 19
      for (int i = 1; i < directions; ++i) {
        const double g = out[i][link.cell];
        add(u[0], c[i].x, g);
        add(u[1], c[i].y, g);
        add(u[2], c[i].z, g);
      }
      rest = 1.5 * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    }
    const Int3 cj = c[link.direction];
    const double cu = cj.x * u[0] + cj.y * u[1] + cj.z * u[2];
    const double even = o.density_deviation + 4.5 * cu * cu - rest;
    const auto from = fill ? link.home : link.ghost, to = fill ? link.ghost : link.home;
    p[to] = T(2 * w(link.direction) * even - p[from]);
  }
}

template <class T>
void Halo<T>::exchange(std::span<Block<T>> blocks, std::span<const char> idle, Parity parity) {
  const bool fill = parity == Parity::crossed;
  finish_peers(blocks, idle, parity);
  for (const Copy& copy : copies_) {
    if (idle[copy.ghost_block] || idle[copy.home_block]) continue;
    T* const ghost = blocks[copy.ghost_block].data();
    T* const home = blocks[copy.home_block].data();
    for (const Run& run : copy.runs)
      fill ? copy_slots(home + run.home, ghost + run.ghost, run.length)
           : copy_slots(ghost + run.ghost, home + run.home, run.length);
  }
  for (const Wall& wall : walls_) {
    if (idle[wall.block]) continue;
    T* const p = blocks[wall.block].data();
    for (const Run& run : wall.runs) {
      const T* const from = p + (fill ? run.home : run.ghost);
      T* const to = p + (fill ? run.ghost : run.home);
      for (std::uint32_t n = 0; n < run.length; ++n) to[n] = from[n] + wall.addend;
    }
  }
  for (const Outlet& outlet : outlets_)
    if (!idle[outlet.block]) apply_outlet(blocks[outlet.block], outlet, parity);
}

template class Halo<float>;
template class Halo<double>;

}  // namespace silt::lbm
