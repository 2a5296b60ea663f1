#pragma once
// The passes of a device that count and list links across edges (crossing_links.hpp): those that begin in a
// slab, along one half of the directions. Only for device_mapping_build.hpp (SILT_BUILD).
#include "coupler/mapping/device_mapping.hpp"
#include "coupler/mapping/surface_distance.hpp"
#include "device/for_each.hpp"

namespace silt::coupler::SILT_BUILD {

/// Finds the cells of a slab where such links may begin or end: fluid cells next to the surface, and not next
/// to another one.
template <class T>
struct NearCells {
  CellsToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const auto& [slab, first_near] = all.edge_slabs[std::size_t(k)];
    const SurfaceToMap<T>& surface = all.surfaces[slab.surface];
    const int words = near_words(surface.frame), rows = surface.frame.size.y;
    for (int n = member.lane; n < slab.planes * rows * words; n += member.size)
      all.near[first_near + std::uint32_t(n)] =
          near(surface, {n % words * 64, n / words % rows, slab.z + n / words / rows});
  }
  SILT_DEVICE std::uint64_t near(const SurfaceToMap<T>& surface, lbm::Int3 at) const {
    const BitFrame& frame = surface.frame;
    const lbm::Int3 x = frame.low + at, one{1, 1, 1};  // in the block or its first ghost layer:
    const std::uint64_t cells =
        shared_cells(frame, x) & cells_of_block(x + one, all.solid.size + one + one, 0, false);
    if (!cells) return 0;
    std::uint64_t own = 0, others = all.solid.from(x);
    for (int i = 1; i < lbm::D3Q19::directions; ++i) {
      const lbm::Int3 y = x + along(all.directions.packed[i]);
      const std::uint64_t mine = BitWindow::from(frame, surface.cells.words(), y);
      own |= mine, others |= all.solid.from(y) & ~mine;
    }
    return cells & own & ~others;
  }
};

/// The crossing links that begin in a slab, 64 cells of a row and one direction at a time.
template <class T>
struct EdgesOfSlab {
  const CellsToMap<T>& all;
  const SlabToMap& slab;
  const SurfaceToMap<T>& surface;
  const std::uint64_t* near_cells;  // from its first plane on
  lbm::Int3 corner;                 // of places: a link may end one plane below the slab
  lbm::SILT_BUILD::PlaceOrigin<T> origin;
  SurfaceView<T> parts;

  SILT_DEVICE EdgesOfSlab(const CellsToMap<T>& all, std::int64_t k)
      : all(all),
        slab(all.edge_slabs[std::size_t(k)].planes),
        surface(all.surfaces[slab.surface]),
        near_cells(all.near + all.edge_slabs[std::size_t(k)].first_near),
        corner(surface.frame.low + lbm::Int3{0, 0, slab.z - 1}),
        origin(corner, surface_frame(surface.frame, surface.centre), all.directions.packed),
        parts{all.turned + surface.now.first_part, surface.surface->shape.parts.count,
              surface.surface->shape.parts.planes} {}

  /// Links by their first cells: those with both ends in the block, and those with one.
  struct Found {
    lbm::Int3 at, c;  // the first cell of the word, from the corner
    int direction;
    std::uint64_t pairs, single;

    SILT_DEVICE std::uint32_t begin(int bit) const { return lbm::link_place(cell(bit), direction); }
    SILT_DEVICE std::uint32_t end(int bit) const {
      return lbm::link_place(cell(bit) + c, lbm::opposite(direction));
    }
    SILT_DEVICE lbm::Int3 cell(int bit) const { return at + lbm::Int3{bit, 0, 0}; }
  };

  SILT_DEVICE std::uint64_t inside(lbm::Int3 at) const {
    return cells_of_block(corner + at, all.solid.size, 0, false);
  }
  /// Returns 64 cells near the surface, moved by a step along x; `at` counts from the corner.
  SILT_DEVICE std::uint64_t near(lbm::Int3 at, int step) const {
    const int z = at.z + slab.z - 1, count = near_words(surface.frame), w = at.x / 64;
    if (z == 0 || z == surface.frame.size.z - 1) return 0;
    const std::uint64_t* const words = near_cells + ((at.z - 1) * surface.frame.size.y + at.y) * count;
    if (step > 0) return words[w] >> 1 | (w + 1 < count ? words[w + 1] << 63 : 0);
    if (step < 0) return words[w] << 1 | (w > 0 ? words[w - 1] >> 63 : 0);
    return words[w];
  }
  SILT_DEVICE std::uint64_t crossing(const Found& found, std::uint64_t candidates) const {
    constexpr int most = Lanes<T>::count;
    std::uint64_t crossing = 0;
    while (candidates) {
      std::uint32_t place[most];
      int bit[most], n = 0;
      for (; candidates && n < most; candidates &= candidates - 1, ++n)
        bit[n] = lowest_bit(candidates), place[n] = found.begin(bit[n]);
      for (int k = n; k < most; ++k) place[k] = place[n - 1];
      const Crossings<T> links = crossings_of(place, origin, parts);
      for (int k = 0; k < n; ++k)
        if (lane_of(links.cross, k)) crossing |= std::uint64_t{1} << bit[k];
    }
    return crossing;
  }
  SILT_DEVICE void set(Found& found) const {
    const lbm::Int3 at = found.at, end{at.x, at.y + found.c.y, at.z + found.c.z};
    const std::uint64_t begins = inside(at), ends = inside(at + found.c);
    const std::uint64_t cross = crossing(found, near(at, 0) & near(end, found.c.x) & (begins | ends));
    found.pairs = cross & begins & ends, found.single = cross & ~(begins & ends);
  }
  /// Calls visit(found) the same number of times in all threads of a team.
  template <class Visit>
  SILT_DEVICE void visit_all(const Team& member, Visit&& visit) const {
    const int words = near_words(surface.frame), rows = surface.frame.size.y - 2;
    const int in_direction = slab.planes * rows * words;
    for (int first = 0; first < in_direction * lbm::D3Q19::pairs; first += member.size) {
      const int e = first + member.lane, in = e % in_direction;
      Found found{{in % words * 64, 1 + in / words % rows, 1 + in / words / rows},
                  {},
                  1 + 2 * (e / in_direction),
                  0,
                  0};
      if (found.direction < lbm::D3Q19::directions) {
        found.c = along(all.directions.packed[found.direction]);
        set(found);
      }
      visit(found);
    }
  }
};

template <class T>
struct CountEdges {
  CellsToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    CrossingCounts n{};
    EdgesOfSlab<T>(all, k).visit_all(member, [&](const auto& found) {
      n.pairs += std::uint32_t(bits_in(found.pairs)), n.single += std::uint32_t(bits_in(found.single));
    });
    const auto sum = [](std::uint32_t a, std::uint32_t b) { return a + b; };
    n = {member.joined(n.pairs, sum), member.joined(n.single, sum)};
    if (member.lane == 0) all.crossings[k] = n;
  }
};

/// Lists pairs first, so that the ends of a link lie side by side in one vector.
template <class T>
struct ListEdges {
  LinksToMap<T> all;
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const CrossingCounts counted = all.cells.crossings[k];
    if (counted.links() == 0) return;
    const EdgesOfSlab<T> edges(all.cells, k);
    std::uint32_t* const place = all.edge_places[k];
    CrossingCounts n{};
    edges.visit_all(member, [&](const auto& found) {
      std::uint32_t to = 2 * member.before(std::uint32_t(bits_in(found.pairs)), n.pairs);
      for (std::uint64_t cells = found.pairs; cells; cells &= cells - 1) {
        const int bit = lowest_bit(cells);
        place[to++] = found.begin(bit), place[to++] = found.end(bit);
      }
      to = 2 * counted.pairs + member.before(std::uint32_t(bits_in(found.single)), n.single);
      for (std::uint64_t cells = found.single; cells; cells &= cells - 1) {
        const int bit = lowest_bit(cells);
        place[to++] = edges.inside(found.at) >> bit & 1 ? found.begin(bit) : found.end(bit);
      }
    });
  }
};

}  // namespace silt::coupler::SILT_BUILD
