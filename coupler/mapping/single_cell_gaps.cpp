#include "coupler/mapping/block_links.hpp"

#include <algorithm>
#include <bit>

namespace silt::coupler {

using lbm::Int3;

namespace {

/// Returns a key that the two links of a pair share, and no other link of a block of less than 2^18 cells a
/// side; cells may lie outside the block.
std::uint64_t key_of(Int3 cell, int direction) {
  const auto part = [](int x) {
    const int shifted = x + (1 << 18);
    return std::uint64_t(shifted);
  };
  const int pair = (direction - 1) / 2;  // opposite directions follow one another
  return ((part(cell.z) << 19 | part(cell.y)) << 19 | part(cell.x)) << 4 | std::uint64_t(pair);
}

}  // namespace

template <class T>
void SingleCellGaps<T>::pair(std::vector<SurfaceLinks<T>>& surfaces, const lbm::Domain& domain,
                             const lbm::CellBox& box) {
  links_.clear(), groups_.clear();
  opposites_.clear();
  for (std::uint32_t k = 0; k < surfaces.size(); ++k) {
    lbm::CutLinks<T>& links = surfaces[k].links;
    std::uint32_t room = 0;
    for (lbm::LinkGroup& g : links.groups) {
      if (g.scheme != lbm::WallScheme::single_cell_gap) continue;
      g.opposite = room, room += lbm::padded(g.count);
      groups_.push_back({k, g.opposite, g.count});
      for (std::uint32_t l = 0; l < g.count; ++l) {
        const std::uint32_t p = links.place[g.begin + l];
        const Int3 cell = g.corner + lbm::place_cell(p);
        const int i = lbm::place_direction(p);
        links_.push_back({key_of(cell, i), k, g.opposite + l, i, cell, links.q[g.begin + l]});
      }
    }
    links.opposite_q.assign(room, T(0)), links.opposite_u.assign(room, T(0));
  }
  for_pairs([&](const Link& a, const Link& b) {
    surfaces[a.surface].links.opposite_q[a.place] = b.q, surfaces[b.surface].links.opposite_q[b.place] = a.q;
    opposites_.push_back({a.surface, a.place, b.surface, a.direction, a.cell});
    opposites_.push_back({b.surface, b.place, a.surface, b.direction, b.cell});
  });
  for (const Link& link : links_) {
    const Int3 walls = domain.walls_met(box.lower + link.cell - lbm::c[link.direction]);
    if (walls == Int3{0, 0, 0}) continue;
    lbm::CutLinks<T>& links = surfaces[link.surface].links;
    links.opposite_q[link.place] = T(0.5);
    links.opposite_u[link.place] = T(domain.wall_velocity_along(walls, link.direction));
  }
  pad(surfaces, &lbm::CutLinks<T>::opposite_q), pad(surfaces, &lbm::CutLinks<T>::opposite_u);
}

/// Fills the groups up with copies of their last links' values.
template <class T>
void SingleCellGaps<T>::pad(std::vector<SurfaceLinks<T>>& surfaces,
                            std::pmr::vector<T> lbm::CutLinks<T>::*values) const {
  for (const Group& g : groups_) {
    T* const first = (surfaces[g.surface].links.*values).data() + g.first;
    std::fill(first + g.count, first + lbm::padded(g.count), first[g.count - 1]);
  }
}

/// Each link takes the first free place of the table from that of its key on, unless the other one of its
/// pair has been there before.
template <class T>
template <class F>
void SingleCellGaps<T>::for_pairs(F&& f) {
  const int log_size = std::bit_width(2 * links_.size() + 1);
  table_.assign(std::size_t(1) << log_size, 0);
  for (std::uint32_t n = 0; n < links_.size(); ++n) {
    constexpr std::uint64_t golden = 0x9e3779b97f4a7c15;
    std::size_t at = links_[n].key * golden >> (64 - log_size);
    while (table_[at] != 0 && links_[table_[at] - 1].key != links_[n].key)
      at = (at + 1) & (table_.size() - 1);
    if (table_[at] != 0)
      f(links_[table_[at] - 1], links_[n]);
    else
      table_[at] = n + 1;
  }
}

template <class T>
void SingleCellGaps<T>::set_velocities(std::vector<SurfaceLinks<T>>& surfaces) const {
  for (const Opposite& o : opposites_)
    surfaces[o.surface].links.opposite_u[o.place] = T(
        lbm::velocity_along(surfaces[o.of].links.frame, surfaces[o.of].motion, o.cell, lbm::c[o.direction]));
  if (!opposites_.empty()) pad(surfaces, &lbm::CutLinks<T>::opposite_u);
}

template class SingleCellGaps<float>;
template class SingleCellGaps<double>;

}  // namespace silt::coupler
