// The passes of device_mapping.hpp, for the one file per device other than `cpu` that includes this
// (SILT_BUILD): a vector of links at a time, or one link (SILT_SCALAR).
#include <algorithm>
#include <cstring>
#include <type_traits>

#include "coupler/mapping/device_mapping.hpp"
#include "coupler/mapping/refill_build.hpp"
#include "coupler/mapping/surface_distance.hpp"
#include "device/for_each.hpp"
#include "lbm/walls/link_resistance.hpp"

namespace silt::coupler::SILT_BUILD {

struct SetWords {
  const ChangedWord* words;
  SILT_DEVICE void operator()(std::int64_t k) const { *words[k].at = words[k].bits; }
};

template <class T>
struct CopyTold {
  LinksToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const HostCopy& run = all.runs[k];
    for (std::uint32_t n = std::uint32_t(member.lane); n < run.count; n += std::uint32_t(member.size))
      memcpy(run.to + n, all.told + run.first + n, sizeof *run.to);  // of any type
  }
};

/// Lists the links of a group by direction and row.
template <class T>
struct ListGroup {
  LinksToMap<T> all;

  SILT_DEVICE std::uint64_t solid(lbm::Int3 x) const {
    return CellBits::from(all.solid + CellBits::row(all.size, x.y, x.z, all.solid_words), x.x);
  }
  SILT_DEVICE std::uint64_t inside(lbm::Int3 x) const { return cells_of_block(x, all.size, 0, false); }
  /// Returns those of 64 open cells of a row, from x on, that have a link along c in this group.
  SILT_DEVICE std::uint64_t with_link(const SurfaceToMap<T>& surface, bool rim, lbm::Int3 x,
                                      lbm::Int3 c) const {
    std::uint64_t cells = cells_of_block(x, all.size, lbm::link_reach(all.scheme), rim);
    if (!cells) return 0;
    const BitFrame& frame = surface.frame;
    cells &= cells_between(x.x, frame.low.x, frame.low.x + frame.size.x) & ~solid(x);
    cells &= BitWindow::from(frame, surface.cells, x + c);
    if (!cells) return 0;
    if (lbm::reads_behind(all.scheme)) cells &= ~solid(x - c);
    if (lbm::reads_beyond(all.scheme)) cells &= inside(x - c) & ~solid(x - c - c);
    return cells;
  }
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const GroupToMap& group = all.groups[k];
    const ListedGroup& listed = group.listed;
    const SurfaceToMap<T>& surface = all.surfaces[group.surface];
    std::uint32_t* const place = surface.place + group.begin;
    const int rows = listed.y1 - listed.y0, words = (surface.frame.size.x + 63) / 64;
    const int in_direction = listed.planes * rows * words;
    std::uint32_t n = 0;
    for (int first = 0; first < in_direction * (lbm::D3Q19::directions - 1); first += member.size) {
      const int e = first + member.lane, direction = 1 + e / in_direction, in = e % in_direction;
      const lbm::Int3 at{in % words * 64, listed.y0 + in / words % rows, in / words / rows};
      std::uint64_t cells = 0;
      if (direction < lbm::D3Q19::directions) {
        const std::int32_t packed = all.directions.packed[direction];
        const lbm::Int3 c{lbm::SILT_BUILD::component(packed, 0), lbm::SILT_BUILD::component(packed, 1),
                          lbm::SILT_BUILD::component(packed, 2)};
        cells = with_link(surface, listed.rim, group.corner + at, c);
      }
      std::uint32_t to = member.before(std::uint32_t(bits_in(cells)), n);
      for (; cells; cells &= cells - 1)
        place[to++] = lbm::link_place(at + lbm::Int3{lowest_bit(cells), 0, 0}, direction);
    }
  }
};

template <class T>
SILT_DEVICE typename Lanes<T>::Real distance_of(const std::uint32_t* place,
                                                const lbm::SILT_BUILD::PlaceOrigin<T>& origin,
                                                const SurfaceView<T>& surface, T past) {
  const lbm::SILT_BUILD::Places<T> at(place, origin);
  if (surface.count > 1) return distance_to_any(at, surface, past);
  typename Lanes<T>::Real found{};
  with_kind(surface.parts[0].kind, [&](auto kind) { found = distance_to_part<kind()>(at, surface, past); });
  return found;
}

template <class T>
struct MeasureGroup {
  using L = Lanes<T>;
  using V = typename L::Real;
  LinksToMap<T> all;

  SILT_DEVICE SurfaceView<T> view(const SurfaceAtTime& at) const {
    return {all.parts + at.first_part, at.parts, all.planes + at.first_plane};
  }
  SILT_DEVICE lbm::SILT_BUILD::PlaceOrigin<T> origin(const GroupToMap& group, const SurfaceAtTime& at) const {
    return {group.corner, at.frame, all.directions.packed};
  }
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const GroupToMap& group = all.groups[k];
    const SurfaceToMap<T>& surface = all.surfaces[group.surface];
    if (member.lane == 0) pad(group, surface.place + group.begin);
    measure(group, surface, member);
    if (surface.arm != 0) add_resistance_of(group, surface, member);
  }
  /// Completes the last vector of places by copies, since all of them are read.
  SILT_DEVICE static void pad(const GroupToMap& group, std::uint32_t* place) {
    for (std::uint32_t l = group.count; l % L::count != 0; ++l) place[l] = place[l - 1];
  }
  /// Sets whole vectors of distances and rates.
  SILT_DEVICE void measure(const GroupToMap& group, const SurfaceToMap<T>& surface,
                           const Team& member) const {
    for (int n = L::count * member.lane; n < int(group.count); n += L::count * member.size) {
      const int l = int(group.begin) + n;
      const auto at = [&](const SurfaceAtTime& time, T past) {
        return distance_of(surface.place + l, origin(group, time), view(time), past);
      };
      V q = V{} + T(0.5);
      if (group.crossing)
        q = load<V>(surface.q + l);
      else if (lbm::follows_distance(group.scheme))
        q = at(surface.now, T(0));
      store(surface.q + l, q);
      if (surface.steps > 0)
        store(surface.rate + l,
              group.crossing ? V{} : rate_of<T>(q, at(surface.last, T(most_change)), surface.steps));
    }
  }
  SILT_DEVICE void add_resistance_of(const GroupToMap& group, const SurfaceToMap<T>& surface,
                                     const Team& member) const {
    using Terms = std::conditional_t<sizeof(T) == 4, typename L::Whole, typename L::Quanta>;
    using lbm::SILT_BUILD::resistance_entries, lbm::SILT_BUILD::push_entries;
    typename L::Quanta h[resistance_entries + push_entries] = {};
    for (int l = L::count * member.lane; l < int(group.count); l += L::count * member.size) {
      const lbm::SILT_BUILD::Places<T> at(surface.place + group.begin + l, origin(group, surface.now));
      lbm::SILT_BUILD::add_resistance<T>(
          at, L::below(int(group.count) - l), surface.arm,
          [&](int e, const V& term) { h[e] += converted<typename L::Quanta>(converted<Terms>(term)); });
    }
    lbm::ResistanceSums& sums = all.resistance[group.surface];
    for (int e = 0; e < resistance_entries + push_entries; ++e) {
      std::int64_t sum = 0;
      for (int k = 0; k < L::count; ++k) sum += lane_of(h[e], k);
      member.add(sum, e < resistance_entries ? sums.h[e] : sums.push[e - resistance_entries]);
    }
  }
};

template <class T>
void map_links(const LinksToMap<T>& all) {
  for_each(std::int64_t(all.word_count), SetWords{all.words});
  for_teams(std::int64_t(all.run_count), CopyTold<T>{all});
  for_teams(std::int64_t(all.group_count), ListGroup<T>{all});
  for_teams(std::int64_t(all.group_count), MeasureGroup<T>{all});
}

template void map_links(const LinksToMap<float>&);
template void map_links(const LinksToMap<double>&);

}  // namespace silt::coupler::SILT_BUILD
