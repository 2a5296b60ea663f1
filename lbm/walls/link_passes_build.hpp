// The passes of device_links.hpp, for the one file per device that includes this (SILT_BUILD): a vector of
// links at a time, or one link (SILT_SCALAR).
#include "device/for_each.hpp"
#include "lbm/walls/device_links.hpp"
#include "lbm/walls/link_exchange.hpp"

namespace silt::lbm::SILT_BUILD {

/// The links of one group.
template <class T>
struct LinksOfGroup {
  const LinkPass<T>& pass;
  const SurfaceMotion& motion;
  const DeviceSurface<T>& surface;
  const LinkGroup& group;
  LinkSums& sums;
  PlaceOrigin<T> origin;
  WallDistances<T> distance;
  T* corner;
  ExcessQuanta<T>* excess;  // of the group's corner

  SILT_DEVICE LinksOfGroup(const LinkPass<T>& pass, const GroupOfSurface& of)
      : pass(pass),
        motion(pass.motions[pass.surfaces[of.surface].body]),
        surface(*pass.surfaces[of.surface].record),
        group(surface.groups[of.number]),
        sums(pass.sums[pass.surfaces[of.surface].body]),
        origin(group.corner, surface.frame, pass.slots->components),
        distance(surface.q + group.begin, surface.rate ? surface.rate + group.begin : nullptr,
                 T(pass.time - surface.measured)),
        corner(pass.data + corner_cell()),
        excess(pass.excess + corner_cell()) {
    origin.row = pass.row, origin.plane = pass.plane;
  }
  SILT_DEVICE std::ptrdiff_t corner_cell() const {
    return group.corner.x + std::ptrdiff_t{pass.row} * group.corner.y +
           std::ptrdiff_t{pass.plane} * group.corner.z;
  }
};

/// Writes the values of the first `count` links of a vector.
template <class T>
SILT_DEVICE void scatter(T* to, const typename Lanes<T>::Whole& slots, const typename Lanes<T>::Real& values,
                         int count) {
  if (count >= Lanes<T>::count) return Lanes<T>::scatter(to, slots, values);
  for (int k = 0; k < count; ++k) to[lane_of(slots, k)] = lane_of(values, k);
}

/// A vector of links.
template <WallScheme scheme, class T>
struct LinkAt {
  using L = Lanes<T>;
  using V = typename L::Real;
  using Whole = typename L::Whole;
  const LinksOfGroup<T>& links;
  int l;
  Places<T> at;
  V q;
  Whole back;  // the slots that the surface writes

  SILT_DEVICE LinkAt(const LinksOfGroup<T>& links, int l)
      : links(links),
        l(l),
        at(links.surface.place + links.group.begin + l, links.origin),
        q(links.distance.at(l)),
        back(at.slots(links.pass.slots->back)) {}
  SILT_DEVICE Whole out() const { return at.slots(links.pass.slots->out); }
  SILT_DEVICE SlotsBehind<Whole> slots() const {
    return {out(), back, L::look_up(links.pass.slots->step, at.direction)};
  }
  SILT_DEVICE V operator()(int row) const {
    if (row == out_row) return L::gather(links.corner, out());
    if constexpr (scheme == WallScheme::single_cell_gap)
      return L::gather(links.corner, at.cell + links.pass.slots->out[row - out_row]);
    return L::gather(links.corner, row == behind_row ? slots().behind : slots().against);
  }
  SILT_DEVICE BeyondPair<V> beyond() const {
    if (!links.group.across)
      return {L::gather(links.corner, slots().away), L::gather(links.corner, slots().toward)};
    T away[L::count], toward[L::count];
    for (int k = 0; k < L::count; ++k) {
      const BeyondPair<T>& pair =
          links.pass.pairs_across[links.surface.across[links.group.across_begin + l + k]];
      away[k] = pair.away, toward[k] = pair.toward;
    }
    return {load<V>(away), load<V>(toward)};
  }
  SILT_DEVICE OppositeWall<V> opposite() const {
    if (scheme != WallScheme::single_cell_gap || !links.surface.opposite_q) return {};
    return {load<V>(links.surface.opposite_q + links.group.opposite + l),
            load<V>(links.surface.opposite_u + links.group.opposite + l)};
  }
  SILT_DEVICE void give(const ExcessLanes<T>& given) const {
    for (int k = 0; k < L::count; ++k)
      add_to(links.excess[lane_of(at.cell, k)], ExcessQuanta<T>(lane_of(given, k)));
  }
};

/// Applies a member's share of a group, `together` vectors of links at a time: reads them all before it
/// writes.
template <WallScheme scheme, int together, class T>
SILT_DEVICE void apply_group(const LinksOfGroup<T>& links, const Team& member) {
  using L = Lanes<T>;
  const SurfaceMotion& motion = links.motion;
  GroupStep<T> step(motion, links.pass.fluid, links.pass.galilean,
                    largest_exchange(links.surface.frame.reach, motion));
  const int count = int(links.group.count);
  constexpr int some = together * L::count;
  for (int first = some * member.lane; first < count; first += some * member.size) {
    typename L::Real passed[together];
    typename L::Whole back[together];
    for (int k = 0; k < together; ++k)
      if (const int l = first + k * L::count; l < count) {
        const LinkAt<scheme, T> link(links, l);
        passed[k] = step.template apply<scheme>(link, L::below(count - l)), back[k] = link.back;
      }
    for (int k = 0; k < together; ++k)
      if (const int l = first + k * L::count; l < count) scatter(links.corner, back[k], passed[k], count - l);
  }
  step.sums.add_to(links.sums, [&](std::int64_t term, std::int64_t& sum) { member.add(term, sum); });
  member.add(step.sums.in_range() ? 0 : 1, links.sums.invalid);
}

template <class T>
SILT_DEVICE void correct_group(const LinksOfGroup<T>& links, const SurfaceIncrement& increment,
                               const Team& member) {
  using L = Lanes<T>;
  const Motion<T> u(increment);
  const int count = int(links.group.count);
  for (int l = L::count * member.lane; l < count; l += L::count * member.size) {
    const Places<T> at(links.surface.place + links.group.begin + l, links.origin);
    const auto back = at.slots(links.pass.slots->back);
    scatter(links.corner, back, corrected<T>(L::gather(links.corner, back), at, u), count - l);
  }
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
    const LinksOfGroup<T> links(pass, groups[k]);
    if (links.group.crossing != crossing) return;
    with_scheme(links.group.scheme, [&](auto scheme) {
      constexpr int together = crossing && Lanes<T>::count == 1 ? 2 : 1;
      apply_group<scheme(), together>(links, member);
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
    if (pass.increments[first].body == body)
      correct_group(LinksOfGroup<T>(pass, groups[k]), pass.increments[first], member);
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
struct SetOpposites {
  LinkPass<T> pass;
  const GroupOfSurface* groups;
  OppositesToSet all;
  SILT_DEVICE const LineInGap& line_of(Int3 cell, int i) const {
    const std::uint64_t key = key_of_line(cell, i);
    const std::size_t last = (std::size_t{1} << all.table.log_size) - 1;
    std::size_t at = first_place(key, all.table.log_size);
    while (all.table.lines[at].key != key) at = (at + 1) & last;
    return all.table.lines[at];
  }
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const LinksInGap<T> links(pass, groups[k]);
    links.visit(member, [&](std::uint32_t l, Int3 cell, int i) {
      const std::int32_t packed = pass.slots->components[i];
      const Int3 along{component(packed, 0), component(packed, 1), component(packed, 2)};
      const Int3 walls = walls_met(all.sides, all.cells, all.lower + cell - along);
      const bool at_side = !(walls == Int3{0, 0, 0});
      const LineInGap& line = line_of(cell, i);
      const int other = i & 1;  // place of the opposite link
      const OppositeLink<T> link{groups[k].surface,
                                 links.group.opposite + l,
                                 std::int32_t(line.surface[other]) - 1,
                                 line.number[other],
                                 cell,
                                 std::int8_t(i),
                                 at_side,
                                 at_side ? T(wall_velocity_along(all.sides, walls, along)) : T(0)};
      set_opposite(link, along, [&](std::uint32_t n) -> SurfaceInGap<T> {
        const DeviceSurface<T>& of = *pass.surfaces[n].record;
        return {of.frame, pass.motions[pass.surfaces[n].body], of.q, of.opposite_q, of.opposite_u};
      });
    });
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
void set_opposites(std::span<const GroupOfSurface> groups, const LinkPass<T>& pass,
                   const OppositesToSet& all) {
  for_teams(std::int64_t(groups.size()), SetOpposites<T>{pass, groups.data(), all});
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
