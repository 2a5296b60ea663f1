// The passes of device_mapping.hpp, for the one file per device other than `cpu` that includes this
// (SILT_BUILD): a vector of links at a time, or one link (SILT_SCALAR).
#include <algorithm>
#include <cstring>
#include <type_traits>

#include "coupler/mapping/crossing_passes.hpp"
#include "coupler/mapping/device_mapping.hpp"
#include "coupler/mapping/mark_cells.hpp"
#include "coupler/mapping/refill_build.hpp"
#include "coupler/mapping/surface_distance.hpp"
#include "device/for_each.hpp"
#include "lbm/walls/link_resistance.hpp"

namespace silt::coupler::SILT_BUILD {

template <class T>
struct CopyTold {
  HostCopies all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const HostCopy& run = all.runs[std::size_t(k)];
    for (std::uint32_t n = std::uint32_t(member.lane); n < run.count; n += std::uint32_t(member.size))
      memcpy(run.to + n, all.values + run.first + n, sizeof *run.to);  // of any type
  }
};

/// Flips the solid cells that are set in words of a frame.
SILT_DEVICE inline void flip_solid(const SolidBits& solid, const BitFrame& frame, const std::uint64_t* words,
                                   const Team& member) {
  const int rows_a_word = frame.pitch < 64 ? 64 / frame.pitch : 1;
  for (int w = member.lane; w < int(frame.words()); w += member.size) {
    if (words[w] == 0) continue;
    const lbm::Int3 first = frame.cell(64 * std::uint32_t(w));
    for (int r = 0; r < rows_a_word; ++r) {
      const std::uint64_t cells = words[w] >> (r * frame.pitch) & frame.row_bits();
      if (cells == 0) continue;
      const int bit = first.x + CellBits::ghosts;
      std::uint64_t* const to =
          solid.words + CellBits::row(solid.size, first.y + r, first.z, solid.words_a_row) + (bit >> 6);
      flip_bits(to[0], cells << (bit & 63));
      if (const std::uint64_t beyond = cells >> 1 >> (63 - (bit & 63))) flip_bits(to[1], beyond);
    }
  }
}

/// Takes the cells of the last mapping from the solid ones, and clears those of this one.
template <class T>
struct LiftCells {
  CellsToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const SurfaceToMap<T>& surface = all.surfaces[std::size_t(k)];
    if (surface.before.exist()) flip_solid(all.solid, surface.before.frame(), surface.before.words(), member);
    std::uint64_t* const words = surface.cells.words();  // cleared by the thread that has read it
    for (int w = member.lane; w <= int(surface.frame.words()); w += member.size) words[w] = 0;
  }
};
template <class T>
struct LiftGone {
  CellsToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const CellsOnDevice& cells = all.gone[std::size_t(k)];
    flip_solid(all.solid, cells.frame(), cells.words(), member);
  }
};

template <class T>
struct MarkCells {
  CellsToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const SurfaceToMap<T>& surface = all.surfaces[std::size_t(k)];
    if (member.lane == 0) surface.cells.frame() = surface.frame;
    if (surface.marking == Marking::told) return;
    const rigid::ShapeView<T>& shape = surface.surface->shape.parts;
    std::uint64_t* const words = surface.cells.words();
    if (surface.marking == Marking::ball)
      return mark_sphere(surface.frame, surface.centre, shape.parts[0].size[0], words, member);
    const rigid::Rotation turn(all.turns[surface.now.turn]);
    for (int p = 0; p < shape.count; ++p) {
      const rigid::SurfacePart<double> part = rigid::turned<double>(shape.parts[p], turn);
      with_kind(part.kind, [&](auto kind) {
        mark_part<kind()>(surface.frame, surface.centre, part, surface.surface->shape.planes, words, member);
      });
    }
  }
};

template <class T>
struct SetWords {
  CellsToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k) const {
    *all.words[std::size_t(k)].at = all.words[std::size_t(k)].bits;
  }
};

template <class T>
struct FlipBits {
  CellsToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const FlippedBits& of = all.flipped[std::size_t(k)];
    std::uint64_t* const words =
        of.surface == FlippedBits::no_surface ? all.solid.words : all.surfaces[of.surface].cells.words();
    for (std::uint32_t n = std::uint32_t(member.lane); n < of.count; n += std::uint32_t(member.size)) {
      const std::uint32_t bit = all.flips[of.first + n];
      flip_bits(words[bit >> 6], std::uint64_t{1} << (bit & 63));
    }
  }
};

template <class T>
struct LowerCells {
  CellsToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const SurfaceToMap<T>& surface = all.surfaces[std::size_t(k)];
    flip_solid(all.solid, surface.frame, surface.cells.words(), member);
  }
};

/// The links of a slab, 64 cells of a row and one direction at a time.
template <class T>
struct LinksOfSlab {
  const CellsToMap<T>& all;
  const SlabToMap& slab;
  const SurfaceToMap<T>& surface;
  lbm::Int3 corner;

  SILT_DEVICE LinksOfSlab(const CellsToMap<T>& all, std::int64_t k)
      : all(all),
        slab(all.slabs[std::size_t(k)]),
        surface(all.surfaces[slab.surface]),
        corner(surface.frame.low + lbm::Int3{0, 0, slab.z}) {}

  /// The links of up to 64 cells along one direction, by kind.
  struct Found {
    lbm::Int3 at, c;  // the first cell, from the corner of the slab
    int direction;
    std::uint64_t cells[link_kinds];
  };

  SILT_DEVICE std::uint64_t solid(lbm::Int3 x) const { return all.solid.from(x); }
  SILT_DEVICE std::uint64_t inside(lbm::Int3 x) const { return cells_of_block(x, all.solid.size, 0, false); }
  SILT_DEVICE void set(Found& found) const {
    const lbm::Int3 x = corner + found.at, c = found.c;
    const BitFrame& frame = surface.frame;
    std::uint64_t left = inside(x);
    if (!left) return;
    left &= cells_between(x.x, frame.low.x, frame.low.x + frame.size.x) & ~solid(x);
    left &= BitWindow::from(frame, surface.cells.words(), x + c);
    const auto take = [&](LinkKind kind, std::uint64_t cells) {
      found.cells[int(kind)] = left & cells, left &= ~cells;
    };
    if (left && lbm::reads_behind(all.scheme)) take(LinkKind::single_cell, solid(x - c));
    if (left && lbm::reads_beyond(all.scheme)) {
      take(LinkKind::two_cells, solid(x - c - c));
      take(LinkKind::across, ~inside(x - c));
    }
    found.cells[int(LinkKind::own)] = left;
  }
  /// Calls visit(found) the same number of times in all threads of a team.
  template <class Visit>
  SILT_DEVICE void visit_all(const Team& member, Visit&& visit) const {
    const int rows = surface.frame.size.y - 2, words = (surface.frame.size.x + 63) / 64;
    const int in_direction = slab.planes * rows * words;
    for (int first = 0; first < in_direction * (lbm::D3Q19::directions - 1); first += member.size) {
      const int e = first + member.lane, in = e % in_direction;
      Found found{{in % words * 64, 1 + in / words % rows, in / words / rows}, {}, 1 + e / in_direction, {}};
      if (found.direction < lbm::D3Q19::directions) {
        found.c = along(all.directions.packed[found.direction]);
        set(found);
      }
      visit(found);
    }
  }
};

template <class T>
struct CountSlab {
  CellsToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    KindCounts n{};
    LinksOfSlab<T>(all, k).visit_all(member, [&](const auto& found) {
      for (int kind = 0; kind < link_kinds; ++kind) n[kind] += std::uint32_t(bits_in(found.cells[kind]));
    });
    const auto sum = [](std::uint32_t a, std::uint32_t b) { return a + b; };
    for (std::uint32_t& of : n) of = member.joined(of, sum);
    if (member.lane == 0) all.counts[k] = n;
  }
};

template <class T>
struct TurnParts {
  CellsToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k) const {
    const SurfaceToMap<T>& surface = all.surfaces[std::size_t(k)];
    const rigid::ShapeView<T>& shape = surface.surface->shape.parts;
    const auto turn_to = [&](const TurnedSurface& at) {
      const rigid::Rotation turn(all.turns[at.turn]);
      for (int p = 0; p < shape.count; ++p)
        all.turned[at.first_part + p] = rigid::turned<T>(shape.parts[p], turn);
    };
    turn_to(surface.now);
    if (surface.steps > 0) turn_to(surface.last);
  }
};

template <class T>
void count_links(const CellsToMap<T>& all) {
  for_teams(std::int64_t(all.told.runs.size()), CopyTold<T>{all.told});
  for_teams(std::int64_t(all.surfaces.size()), LiftCells<T>{all});
  for_teams(std::int64_t(all.gone.size()), LiftGone<T>{all});
  for_teams(std::int64_t(all.surfaces.size()), MarkCells<T>{all});
  for_each(std::int64_t(all.words.size()), SetWords<T>{all});
  for_teams(std::int64_t(all.flipped.size()), FlipBits<T>{all});
  for_teams(std::int64_t(all.surfaces.size()), LowerCells<T>{all});
  for_teams(std::int64_t(all.slabs.size()), CountSlab<T>{all});
  for_each(std::int64_t(all.surfaces.size()), TurnParts<T>{all});
  if (all.edge_slabs.empty()) return;
  for_teams(std::int64_t(all.edge_slabs.size()), NearCells<T>{all});
  for_teams(std::int64_t(all.edge_slabs.size()), CountEdges<T>{all});
}

/// Makes the groups of a surface for the counts of its slabs, as LinkGroups does, and the lists of its slabs.
template <class T>
struct MakeGroups {
  LinksToMap<T> all;

  SILT_DEVICE void operator()(std::int64_t k) const {
    const auto number = std::size_t(k);
    const auto& [surface_number, first_group] = all.listed[number];
    const SurfaceToMap<T>& surface = all.cells.surfaces[surface_number];
    lbm::DeviceSurface<T>& links = surface.surface->links;
    const std::size_t end =
        number + 1 < all.listed.size() ? all.listed[number + 1].first_group : all.groups.size();
    links.frame = surface_frame(surface.frame, surface.centre), links.measured = surface.middle;
    links.group_count = std::uint32_t(end) - first_group;
    LinkRoom room{all.cells.scheme};
    lbm::LinkGroup* to = links.groups;
    for (std::uint32_t n = surface.first_slab; n < surface.first_slab + surface.slabs; ++n) {
      const lbm::Int3 corner = LinksOfSlab<T>(all.cells, n).corner;
      SlabLists& lists = all.lists[n];
      for (int kind = 0; kind < link_kinds; ++kind) {
        const std::uint32_t count = all.cells.counts[n][kind];
        if (count == 0) continue;
        const lbm::LinkGroup group = room.group(LinkKind(kind), count, corner, -1);
        lists.place[kind] = links.place + group.begin;
        if (group.across) lists.across = links.across + group.across_begin;
        *to++ = group;
      }
    }
    const std::span<const EdgeSlab> edges = all.cells.edge_slabs;
    for (std::size_t n = first_slab_of(surface_number, edges);
         n < edges.size() && edges[n].planes.surface == surface_number; ++n) {
      const std::uint32_t count = all.cells.crossings[n].links();
      if (count == 0) continue;
      const lbm::LinkGroup group =
          room.group(LinkKind::crossing, count, EdgesOfSlab<T>(all.cells, std::int64_t(n)).corner, -1);
      all.edge_places[n] = links.place + group.begin;
      *to++ = group;
    }
    for (std::uint32_t g = 0; g < links.group_count; ++g) all.groups[first_group + g] = {std::uint32_t(k), g};
  }
};

template <class T>
struct ListSlab {
  LinksToMap<T> all;

  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const LinksOfSlab<T> links(all.cells, k);
    const SlabLists& lists = all.lists[k];
    std::uint32_t n[link_kinds] = {};
    links.visit_all(member, [&](const auto& found) {
      for (int kind = 0; kind < link_kinds; ++kind) {
        std::uint64_t cells = found.cells[kind];
        std::uint32_t to = member.before(std::uint32_t(bits_in(cells)), n[kind]);
        for (; cells; cells &= cells - 1, ++to) {
          const lbm::Int3 at = found.at + lbm::Int3{lowest_bit(cells), 0, 0};
          const std::uint32_t place = lbm::link_place(at, found.direction);
          lists.place[kind][to] = place;
          if (kind == int(LinkKind::across))
            lists.across[to] = all.pairs(links.corner + at, found.direction, found.c);
        }
      }
    });
    if (member.lane == 0 && n[int(LinkKind::across)] > 0) {
      std::uint32_t l = n[int(LinkKind::across)];
      for (; l % Lanes<T>::count != 0; ++l) lists.across[l] = lists.across[l - 1];
    }
  }
};

template <class T>
struct MeasureGroup {
  using L = Lanes<T>;
  using V = typename L::Real;
  LinksToMap<T> all;

  SILT_DEVICE lbm::SILT_BUILD::PlaceOrigin<T> origin(const lbm::LinkGroup& group,
                                                     const lbm::SurfaceFrame& frame) const {
    return {group.corner, frame, all.cells.directions.packed};
  }
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const auto& [listed, number] = all.groups[std::size_t(k)];
    const SurfaceToMap<T>& surface = all.cells.surfaces[all.listed[listed].surface];
    const lbm::DeviceSurface<T>& links = surface.surface->links;
    const lbm::LinkGroup& group = links.groups[number];
    if (member.lane == 0) pad(group, links.place + group.begin);
    measure(group, surface, member);
    if (surface.arm != 0) add_resistance_of(group, surface, all.resistance[listed], member);
  }
  /// Completes the last vector of places by copies, since all of them are read.
  SILT_DEVICE static void pad(const lbm::LinkGroup& group, std::uint32_t* place) {
    for (std::uint32_t l = group.count; l % L::count != 0; ++l) place[l] = place[l - 1];
  }
  /// Sets whole vectors of distances and rates.
  SILT_DEVICE void measure(const lbm::LinkGroup& group, const SurfaceToMap<T>& surface,
                           const Team& member) const {
    const lbm::DeviceSurface<T>& links = surface.surface->links;
    const rigid::ShapeView<T>& shape = surface.surface->shape.parts;
    const lbm::SurfaceFrame last = frame_after(links.frame, surface.velocity, surface.steps);
    for (int n = L::count * member.lane; n < int(group.count); n += L::count * member.size) {
      const int l = int(group.begin) + n;
      const auto at = [&](const TurnedSurface& time, const lbm::SurfaceFrame& frame, T past) {
        return distance_of(links.place + l, origin(group, frame),
                           {all.cells.turned + time.first_part, shape.count, shape.planes}, past);
      };
      V q = V{} + T(0.5);
      if (lbm::follows_distance(group.scheme)) q = at(surface.now, links.frame, T(0));
      store(links.q + l, q);
      if (surface.steps > 0)
        store(links.rate + l,
              group.crossing ? V{} : rate_of<T>(q, at(surface.last, last, T(most_change)), surface.steps));
    }
  }
  SILT_DEVICE void add_resistance_of(const lbm::LinkGroup& group, const SurfaceToMap<T>& surface,
                                     lbm::ResistanceSums& sums, const Team& member) const {
    using Terms = std::conditional_t<sizeof(T) == 4, typename L::Whole, typename L::Quanta>;
    using lbm::SILT_BUILD::resistance_entries, lbm::SILT_BUILD::push_entries;
    typename L::Quanta h[resistance_entries + push_entries] = {};
    for (int l = L::count * member.lane; l < int(group.count); l += L::count * member.size) {
      const lbm::SILT_BUILD::Places<T> at(surface.surface->links.place + group.begin + l,
                                          origin(group, surface.surface->links.frame));
      lbm::SILT_BUILD::add_resistance<T>(
          at, L::below(int(group.count) - l), surface.arm,
          [&](int e, const V& term) { h[e] += converted<typename L::Quanta>(converted<Terms>(term)); });
    }
    const auto sum_of = [](const typename L::Quanta& lanes) {
      std::int64_t sum = 0;
      for (int k = 0; k < L::count; ++k) sum += lane_of(lanes, k);
      return sum;
    };
    for (int e = 0; e < resistance_entries; ++e) member.add(sum_of(h[e]), sums.h[e]);
    for (int e = 0; e < push_entries; ++e) member.add(sum_of(h[resistance_entries + e]), sums.push[e]);
  }
};

template <class T>
void map_links(const LinksToMap<T>& all) {
  for_teams(std::int64_t(all.told.runs.size()), CopyTold<T>{all.told});
  for_each(std::int64_t(all.listed.size()), MakeGroups<T>{all});
  for_teams(std::int64_t(all.cells.slabs.size()), ListSlab<T>{all});
  for_teams(std::int64_t(all.cells.edge_slabs.size()), ListEdges<T>{all});
  for_teams(std::int64_t(all.groups.size()), MeasureGroup<T>{all});
}

template void count_links(const CellsToMap<float>&);
template void count_links(const CellsToMap<double>&);
template void map_links(const LinksToMap<float>&);
template void map_links(const LinksToMap<double>&);

}  // namespace silt::coupler::SILT_BUILD
