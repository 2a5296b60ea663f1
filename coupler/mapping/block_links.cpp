#include "coupler/mapping/block_links.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace silt::coupler {

using lbm::Int3;

template <class T>
void SingleCellGaps<T>::pair(const std::vector<SurfaceLinks<T>>& surfaces, const lbm::Domain& domain,
                             const lbm::CellBox& box) {
  links_.clear(), groups_.clear();
  for (std::uint32_t k = 0; k < surfaces.size(); ++k) {
    const SurfaceLinks<T>& surface = surfaces[k];
    for (std::uint32_t number = 0; number < surface.links.groups.size(); ++number) {
      const lbm::LinkGroup& g = surface.links.groups[number];
      if (g.scheme != lbm::WallScheme::single_cell_gap) continue;
      const std::uint32_t* const place = &surface.links.place[g.begin];
      groups_.push_back({k, number, g.opposite, g.count});
      for (std::uint32_t l = 0; l < g.count; ++l) {
        const Int3 cell = g.corner + lbm::place_cell(place[l]);
        const int i = lbm::place_direction(place[l]);
        const Int3 walls = domain.walls_met(box.lower + cell - lbm::D3Q19::c[i]);
        const bool at_side = walls != Int3{0, 0, 0};
        links_.push_back({{k, g.opposite + l, -1, 0, cell, std::int8_t(i), at_side,
                           at_side ? T(domain.wall_velocity_along(walls, lbm::D3Q19::c[i])) : T(0)},
                          lbm::key_of_line(cell, i),
                          g.begin + l});
      }
    }
  }
  for_pairs([&](std::uint32_t a, std::uint32_t b) {
    for (const auto& [one, other] : {std::pair(a, b), std::pair(b, a)})
      links_[one].other = std::int32_t(links_[other].surface), links_[one].number = links_[other].own_number;
  });
}

template <class T>
void SingleCellGaps<T>::set(std::vector<SurfaceLinks<T>>& surfaces) const {
  for (const Link& link : links_)
    lbm::set_opposite(link, lbm::D3Q19::c[link.direction], [&](std::uint32_t k) -> lbm::SurfaceInGap<T> {
      lbm::CutLinks<T>& of = surfaces[k].links;
      return {of.frame, surfaces[k].motion, of.q.data(), of.opposite_q.data(), of.opposite_u.data()};
    });
  pad(surfaces, &lbm::CutLinks<T>::opposite_q), pad(surfaces, &lbm::CutLinks<T>::opposite_u);
}

/// Pads the groups with copies of the values of their last links.
template <class T>
void SingleCellGaps<T>::pad(std::vector<SurfaceLinks<T>>& surfaces,
                            DeviceArray<T> lbm::CutLinks<T>::*values) const {
  for (const Group& g : groups_) {
    T* const first = (surfaces[g.surface].links.*values).data() + g.first;
    std::fill(first + g.count, first + lbm::padded(g.count), first[g.count - 1]);
  }
}

/// Finds pairs with a hash table: a link takes the first free slot from its key on or finds its partner.
template <class T>
template <class F>
void SingleCellGaps<T>::for_pairs(F&& f) {
  const int log_size = std::bit_width(2 * links_.size() + 1);
  table_.assign(std::size_t(1) << log_size, 0);
  for (std::uint32_t n = 0; n < links_.size(); ++n) {
    std::size_t at = lbm::first_place(links_[n].key, log_size);
    while (table_[at] != 0 && links_[table_[at] - 1].key != links_[n].key)
      at = (at + 1) & (table_.size() - 1);
    if (table_[at] != 0)
      f(table_[at] - 1, n);
    else
      table_[at] = n + 1;
  }
}

template class SingleCellGaps<float>;
template class SingleCellGaps<double>;

}  // namespace silt::coupler
