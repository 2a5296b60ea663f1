// The passes of device_links.hpp, for the one file per device that includes this (SILT_BUILD): a vector of
// links at a time, or one link (SILT_SCALAR).
#include "device/for_each.hpp"
#include "lbm/walls/device_links.hpp"
#include "lbm/walls/group_exchange.hpp"

namespace silt::lbm::SILT_BUILD {

template <class T>
SILT_DEVICE LinksOfGroup<T> links_of(const LinkPass<T>& pass, const DeviceSurface<T>& surface,
                                     const LinkGroup& group) {
  const std::ptrdiff_t corner = group.corner.x + std::ptrdiff_t{pass.row} * group.corner.y +
                                std::ptrdiff_t{pass.plane} * group.corner.z;
  return {group,
          *pass.slots,
          {group.corner, surface.frame, pass.slots->components, pass.row, pass.plane},
          {surface.q + group.begin, surface.rate ? surface.rate + group.begin : nullptr,
           T(pass.time - surface.measured)},
          surface.place + group.begin,
          surface.opposite_q ? surface.opposite_q + group.opposite : nullptr,
          surface.opposite_u ? surface.opposite_u + group.opposite : nullptr,
          surface.across ? surface.across + group.across_begin : nullptr,
          pass.pairs_across,
          pass.data + corner,
          pass.excess + corner};
}

template <class T>
struct ListGroups {
  const ListedSurface<T>* surfaces;
  GroupOfSurface* groups;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    if (surfaces[k].body == ListedSurface<T>::no_body) return;
    const std::uint32_t count = surfaces[k].record->group_count;
    for (auto n = std::uint32_t(member.lane); n < count; n += std::uint32_t(member.size))
      groups[surfaces[k].first_group + n] = {std::uint32_t(k), n};
  }
};

/// The two ends of a crossing link are neighbours in their group, and in one vector.
template <class T, bool crossing>
struct ApplyLinks {
  LinkPass<T> pass;
  const GroupOfSurface* groups;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const std::uint32_t body = pass.surfaces[groups[k].surface].body;
    const DeviceSurface<T>& surface = *pass.surfaces[groups[k].surface].record;
    const LinkGroup& group = surface.groups[groups[k].number];
    if (group.crossing != crossing) return;
    const SurfaceMotion& motion = pass.motions[body];
    const GroupStep<T> step(motion, pass.fluid, pass.galilean, largest_exchange(surface.frame.reach, motion));
    with_scheme(group.scheme, [&](auto scheme) {
      constexpr int together = crossing && Lanes<T>::count == 1 ? 2 : 1;
      apply_group<scheme(), together>(links_of(pass, surface, group), step, pass.sums[body], member);
    });
  }
};

template <class T>
struct CorrectLinks {
  LinkPass<T> pass;
  const GroupOfSurface* groups;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const std::uint32_t body = pass.surfaces[groups[k].surface].body;
    std::size_t first = 0, end = pass.increments.size();
    while (end - first > 1) {
      const std::size_t middle = (first + end) / 2;
      (pass.increments[middle].body <= body ? first : end) = middle;
    }
    if (pass.increments[first].body != body) return;
    const DeviceSurface<T>& surface = *pass.surfaces[groups[k].surface].record;
    correct_group(links_of(pass, surface, surface.groups[groups[k].number]),
                  Motion<T>(pass.increments[first]), member);
  }
};

/// The links of a group of `single_cell_gap` that know the wall on the other side.
template <class T>
struct LinksInGap {
  const DeviceSurface<T>& surface;
  const LinkGroup& group;

  SILT_DEVICE LinksInGap(const LinkPass<T>& pass, const GroupOfSurface& of)
      : surface(*pass.surfaces[of.surface].record), group(surface.groups[of.number]) {}
  /// Calls visit(l, cell, direction) for a member's share of the links.
  template <class Visit>
  SILT_DEVICE void visit(const Team& member, Visit&& visit) const {
    if (group.scheme != WallScheme::single_cell_gap || !surface.opposite_q) return;
    for (auto l = std::uint32_t(member.lane); l < group.count; l += std::uint32_t(member.size)) {
      const std::uint32_t place = surface.place[group.begin + l];
      visit(l, group.corner + place_cell(place), place_direction(place));
    }
  }
};

/// Enters links into the table of lines: each has a place of its own there, by its direction.
template <class T>
struct PairGaps {
  LinkPass<T> pass;
  const GroupOfSurface* groups;
  LinesInGaps table;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const LinksInGap<T> links(pass, groups[k]);
    links.visit(member, [&](std::uint32_t l, Int3 cell, int i) {
      const std::uint64_t key = key_of_line(cell, i);
      const std::size_t last = (std::size_t{1} << table.log_size) - 1;
      std::size_t at = first_place(key, table.log_size);
      for (;; at = (at + 1) & last)
        if (const std::uint64_t found = set_if_zero(table.lines[at].key, key); found == 0 || found == key)
          break;
      LineInGap& line = table.lines[at];
      line.surface[(i - 1) & 1] = groups[k].surface + 1, line.number[(i - 1) & 1] = links.group.begin + l;
    });
  }
};

template <class T>
struct ListOpposites {
  LinkPass<T> pass;
  const GroupOfSurface* groups;
  LinesInGaps table;
  OppositeLinks all;
  SILT_DEVICE const LineInGap& line_of(Int3 cell, int i) const {
    const std::uint64_t key = key_of_line(cell, i);
    const std::size_t last = (std::size_t{1} << table.log_size) - 1;
    std::size_t at = first_place(key, table.log_size);
    while (table.lines[at].key != key) at = (at + 1) & last;
    return table.lines[at];
  }
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const LinksInGap<T> links(pass, groups[k]);
    links.visit(member, [&](std::uint32_t l, Int3 cell, int i) {
      const LineInGap& line = line_of(cell, i);
      const int other = i & 1;  // place of the opposite link
      all.links[next_of(all.count)] = {
          groups[k].surface + 1, links.group.opposite + l, line.surface[other], line.number[other], cell, i};
    });
  }
};

/// Sets the OppositeWall of links in gaps: a side of the domain; a surface, whose link points the other way;
/// both (the position of the side, the motion of the surface); or none.
template <class T>
struct SetOpposites {
  LinkPass<T> pass;
  OppositesToSet all;
  SILT_DEVICE void operator()(std::int64_t k) const {
    const OppositeLink& link = all.links[std::size_t(k)];
    if (link.surface == 0) return;
    const std::int32_t packed = pass.slots->components[link.direction];
    const Int3 along{component(packed, 0), component(packed, 1), component(packed, 2)};
    const Int3 walls = walls_met(all.sides, all.cells, all.lower + link.cell - along);
    const bool at_side = !(walls == Int3{0, 0, 0});
    T q = at_side ? T(0.5) : T(0),
      velocity = at_side ? T(wall_velocity_along(all.sides, walls, along)) : T(0);
    if (link.other > 0) {
      const ListedSurface<T>& listed = pass.surfaces[link.other - 1];
      const DeviceSurface<T>& of = *listed.record;
      if (!at_side) q = of.q[link.number];
      velocity = T(lbm::velocity_along(of.frame, pass.motions[listed.body], link.cell, along));
    }
    const DeviceSurface<T>& own = *pass.surfaces[link.surface - 1].record;
    own.opposite_q[link.place] = q, own.opposite_u[link.place] = velocity;
  }
};

template <class T>
void list_groups(std::span<const ListedSurface<T>> surfaces, GroupOfSurface* groups) {
  for_teams(std::int64_t(surfaces.size()), ListGroups<T>{surfaces.data(), groups});
}
template <class T>
void pair_gaps(std::span<const GroupOfSurface> groups, const LinkPass<T>& pass, const LinesInGaps& table) {
  for_teams(std::int64_t(groups.size()), PairGaps<T>{pass, groups.data(), table});
}
template <class T>
void list_opposites(std::span<const GroupOfSurface> groups, const LinkPass<T>& pass, const LinesInGaps& table,
                    const OppositeLinks& all) {
  for_teams(std::int64_t(groups.size()), ListOpposites<T>{pass, groups.data(), table, all});
}
template <class T>
void set_opposites(const LinkPass<T>& pass, const OppositesToSet& all) {
  for_each(std::int64_t(all.links.size()), SetOpposites<T>{pass, all});
}
template <class T, bool crossing>
void apply_links(std::span<const GroupOfSurface> groups, const LinkPass<T>& pass) {
  for_teams(std::int64_t(groups.size()), ApplyLinks<T, crossing>{pass, groups.data()});
}
template <class T>
void correct_links(std::span<const GroupOfSurface> groups, const LinkPass<T>& pass) {
  for_teams(std::int64_t(groups.size()), CorrectLinks<T>{pass, groups.data()});
}

template <class T>
const LinkPasses<T>& link_passes() {
  static constexpr LinkPasses<T> passes = {
      .list_groups = list_groups<T>,
      .pair_gaps = pair_gaps<T>,
      .list_opposites = list_opposites<T>,
      .set_opposites = set_opposites<T>,
      .apply = apply_links<T, false>,
      .apply_crossing = apply_links<T, true>,
      .correct = correct_links<T>,
  };
  return passes;
}
template const LinkPasses<float>& link_passes();
template const LinkPasses<double>& link_passes();

}  // namespace silt::lbm::SILT_BUILD
