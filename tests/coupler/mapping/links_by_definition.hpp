#pragma once
// Cut links as they are defined, enumerated cell by cell and direction by direction, and compared with those
// of object mapping.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "lbm/walls/pairs_across.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/mapping/edges_by_definition.hpp"
#include "tests/ray_distance.hpp"

namespace silt::coupler::testing {

using lbm::Int3;
using rigid::Vec3;

/// The geometry as the shapes themselves tell it; nothing of the map is used.
class Geometry {
 public:
  explicit Geometry(const Simulation& s)
      : world_(s.scene().world), bodies_(s.bodies()), domain_(s.scene().flow->fields().domain()) {}

  /// A cell's centre from the nearest image of a body.
  Vec3 arm(std::size_t row, Int3 cell) const {
    Vec3 r = Vec3(cell.x + 0.5, cell.y + 0.5, cell.z + 0.5) - mapping_pose(bodies_, row).position;
    for (int d = 0; d < 3; ++d)
      if (domain_.periodic(d)) r[d] -= domain_.cells()[d] * std::round(r[d] / domain_.cells()[d]);
    return r;
  }
  /// The row of the body that has a cell: -1 none, -2 beyond a wall.
  int owner(Int3 cell) const {
    return once(owners_, cell, [&] { return find_owner(cell); });
  }
  const rigid::Shape& shape(std::size_t row) const { return world_.shapes[bodies_.shape[row]]; }
  /// 1: the link does not meet the body.
  double distance(std::size_t row, Int3 cell, int i) const {
    return on_link(row, cell, i,
                   [&](const Vec3& x, const Vec3& c) { return tests::ray_distance(shape(row), x, c, 1.0); });
  }
  double distance_under_lip(std::size_t row, Int3 cell, int i) const {
    return on_link(row, cell, i, [&](const Vec3& x, const Vec3& c) {
      return under_lip(shape(row), x, c, tests::ray_distance(shape(row), x, c, 1.0));
    });
  }
  /// A link as bodies see it: from a cell, and reflected if it leads beyond free-slip sides; `sign` by axes.
  struct Seen {
    Int3 cell;
    int direction;
    Vec3 sign{1, 1, 1};
  };
  Seen seen(Int3 cell, int i) const {
    Int3 along = lbm::D3Q19::c[i];
    Vec3 sign{1, 1, 1};
    for (int d = 0; d < 3; ++d) {
      const int n = domain_.cells()[d], end = cell[d] + along[d];
      if (domain_.periodic(d) || (end >= 0 && end < n)) continue;
      if (domain_.side(d, end >= n).kind != lbm::SideKind::free_slip) continue;
      cell[d] = end < 0 ? -1 - cell[d] : 2 * n - 1 - cell[d];
      along[d] = -along[d], sign[d] = -1;
    }
    return {cell, lbm::direction_of<lbm::D3Q19>(along), sign};
  }
  /// The body that a link between two fluid cells crosses, -1: none.
  int crossed(Int3 cell, int i) const {
    const Int3 other = cell + lbm::D3Q19::c[i];
    const int row = only_neighbour(cell);
    if (row < 0 || owner(other) != -1 || only_neighbour(other) != row || !has_edges(shape(row))) return -1;
    const int back = lbm::opposite(i);
    const bool meets = distance(row, cell, i) < 1 && distance(row, other, back) < 1;
    return meets && distance(row, cell, back) == 1 && distance(row, other, i) == 1 ? row : -1;
  }

 private:
  template <class F>
  double on_link(std::size_t row, Int3 cell, int i, F&& f) const {
    const rigid::Quat back = mapping_pose(bodies_, row).orientation.conjugate();
    return f(back * arm(row, cell), back * Vec3(lbm::D3Q19::c[i].x, lbm::D3Q19::c[i].y, lbm::D3Q19::c[i].z));
  }
  int find_owner(Int3 cell) const {
    if (!domain_.inside(domain_.wrapped(cell))) return -2;
    int found = -1;
    for (std::size_t row = 0; row < bodies_.first_wall(); ++row) {
      const rigid::Quat q = mapping_pose(bodies_, row).orientation;
      if (rigid::contains(shape(row), q.conjugate() * arm(row, cell)) &&
          (found < 0 || bodies_.id[row] < bodies_.id[found]))
        found = int(row);
    }
    return found;
  }
  /// The one body that has cells next to a cell; -1: none, -2: not one alone.
  int only_neighbour(Int3 cell) const {
    return once(neighbours_, cell, [&] {
      int found = -1;
      for (int i = 1; i < lbm::D3Q19::directions; ++i) {
        const int row = owner(cell + lbm::D3Q19::c[i]);
        if (row == -1 || row == found) continue;
        if (row == -2 || found != -1) return -2;
        found = row;
      }
      return found;
    });
  }

  /// Answers that were found once are kept.
  using Known = std::unordered_map<std::int64_t, int>;
  template <class Find>
  static int once(Known& known, Int3 cell, Find&& find) {
    const std::int64_t key = (std::int64_t(cell.z) << 20) + (std::int64_t(cell.y) << 10) + cell.x;
    const auto at = known.find(key);
    if (at != known.end()) return at->second;
    const int found = find();
    known.emplace(key, found);
    return found;
  }

  mutable Known owners_, neighbours_;
  const rigid::World& world_;
  const rigid::BodySet& bodies_;
  const lbm::Domain& domain_;
};

constexpr std::int64_t in_block = -1;  // Link::pair

struct Link {
  std::size_t row;
  WallScheme scheme;
  std::int64_t pair;  // place of the pair across
  double q;
  Vec3 arm;
  bool crossing;
};
using Links = std::map<std::tuple<int, int, int, int>, Link>;  // by cell of the block and direction

/// The numbers of links of each kind in a comparison.
struct LinkKinds {
  int single_cell = 0, two_cells = 0, across = 0, crossing = 0, reflected = 0;
};

/// After a part of the dense pass, a cell and all that a link of it may touch have collided.
inline void expect_all_done(const lbm::PassOrder& sweep, Int3 x, int reach, int part) {
  for (int z = x.z - reach; z <= x.z + reach; ++z)
    for (int y = x.y - reach; y <= x.y + reach; ++y) EXPECT_LE(sweep.part_of(y, z), part);
}

/// Links that fill up a group copy its last link.
template <class T>
void expect_filled_up(const lbm::CutLinks<T>& links, const lbm::LinkGroup& g) {
  for (std::uint32_t l = g.count; l < lbm::padded(g.count); ++l) {
    EXPECT_EQ(links.place.at(g.begin + l), links.place[g.begin + g.count - 1]);
    EXPECT_EQ(links.q.at(g.begin + l), links.q[g.begin + g.count - 1]);
    if (g.across) {
      EXPECT_EQ(links.across.at(g.across_begin + l), links.across[g.across_begin + g.count - 1]);
    }
  }
}

/// Returns whether two links are the ends of one.
template <class T>
bool face_each_other(const lbm::CutLinks<T>& links, std::uint32_t a, std::uint32_t b) {
  const int i = lbm::place_direction(links.place[a]);
  return lbm::place_direction(links.place[b]) == lbm::opposite(i) &&
         lbm::place_cell(links.place[a]) + lbm::D3Q19::c[i] == lbm::place_cell(links.place[b]);
}

/// Both ends of a crossing link that are in the block are beside one another, in one vector.
template <class T>
void expect_ends_together(const lbm::CutLinks<T>& links, const lbm::LinkGroup& g, Int3 block) {
  const lbm::CellBox inside{{}, block};
  for (std::uint32_t l = 0; l < g.count; ++l) {
    const std::uint32_t p = links.place[g.begin + l];
    const Int3 other = g.corner + lbm::place_cell(p) + lbm::D3Q19::c[lbm::place_direction(p)];
    if (inside.contains(other)) {
      ASSERT_LT(l ^ 1, g.count);
      EXPECT_TRUE(face_each_other(links, g.begin + l, g.begin + (l ^ 1)));
    }
  }
}

template <class T>
void add_links(const BlockMap& map, const BodyMask& mask, const lbm::CutLinks<T>& links, WallScheme scheme,
               bool on_device, Links& found) {
  const lbm::PassOrder sweep(map.box.size, sizeof(T));
  const int reach = scheme == WallScheme::multireflection ? 2 : 1;
  for (const lbm::LinkGroup& g : links.groups) {
    const lbm::SurfaceFrame& frame = links.frame;
    EXPECT_EQ(g.begin % lbm::link_lanes, 0u);
    if (g.crossing) expect_ends_together(links, g, map.box.size);
    for (std::uint32_t l = 0; l < g.count; ++l) {
      const std::uint32_t p = links.place[g.begin + l];
      const Int3 x = g.corner + lbm::place_cell(p);
      bool rim = false;
      for (int d = 0; d < 3; ++d) rim |= x[d] < reach || x[d] >= map.box.size[d] - reach;
      EXPECT_EQ(on_device || rim || g.crossing, g.ready < 0);  // a device applies all after the exchange
      if (g.ready >= 0) expect_all_done(sweep, x, reach, g.ready);
      Vec3 arm;
      for (int d = 0; d < 3; ++d) arm[d] = x[d] - frame.cell[d] + frame.offset[d];
      EXPECT_LE(arm.norm(), frame.reach);
      const std::int64_t pair = g.across ? links.across[g.across_begin + l] : in_block;
      const Link link{mask.row, g.scheme, pair, double(links.q[g.begin + l]), arm, g.crossing};
      EXPECT_TRUE(found.insert({{x.x, x.y, x.z, lbm::place_direction(p)}, link}).second)
          << "a link is listed twice";
    }
  }
}

/// The scheme of a link: in a gap of one or two cells it is another than the case's.
inline WallScheme scheme_at(const Geometry& geometry, Int3 cell, int i, WallScheme scheme) {
  const auto fluid = [&](Int3 x) { return geometry.owner(x) == -1; };
  const Int3 behind = cell - lbm::D3Q19::c[i];
  if (scheme != WallScheme::bounce_back && !fluid(behind)) return WallScheme::single_cell_gap;
  return scheme == WallScheme::multireflection && !fluid(behind - lbm::D3Q19::c[i]) ? WallScheme::cli
                                                                                    : scheme;
}

/// Every link of a block, by its definition; adds those of each kind. `surfaces`: of the mapping before, then
/// of this one.
template <class T>
void expect_all_links(const Simulation& s, const BlockMap& map, WallScheme scheme, double rounding,
                      std::vector<SurfaceLinks<T>>& surfaces, LinkKinds& kinds,
                      DeviceMapping<T>* device = nullptr) {
  const Geometry geometry(s);
  CouplingSpec coupling;
  coupling.wall_scheme = scheme;
  if (map.changed)  // else the surfaces are up to date
    build_links<T>(map, s.scene().world, s.bodies(),
                   {coupling, {}, lbm::PassOrder(map.box.size, sizeof(T)), nullptr, device}, surfaces);
  Links left;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const lbm::CutLinks<T>& links = surfaces[k].links;
    for (const lbm::LinkGroup& g : links.groups)
      if (!device) expect_filled_up(links, g);
    add_links(map, map.masks[k], links, scheme, device != nullptr, left);
  }
  const Int3 n = map.box.size;
  const lbm::CellBox inside{{}, n};
  const lbm::PlacesAcross<lbm::D3Q19> pair_of(n);
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        const Int3 at_block{x, y, z}, cell = map.box.lower + at_block;
        if (geometry.owner(cell) != -1) continue;
        for (int i = 1; i < lbm::D3Q19::directions; ++i) {
          const Geometry::Seen seen = geometry.seen(cell, i);
          const int owner = geometry.owner(seen.cell + lbm::D3Q19::c[seen.direction]);
          const int crossed = scheme == WallScheme::bounce_back ? -1 : geometry.crossed(cell, i);
          const int row = owner == -1 ? crossed : owner;
          if (row < 0) continue;
          const auto at = left.find({x, y, z, i});
          ASSERT_NE(at, left.end()) << "no link at " << x << " " << y << " " << z << " along " << i;
          const Link& link = at->second;
          EXPECT_EQ(int(link.row), row);
          EXPECT_LT((link.arm - seen.sign.cwiseProduct(geometry.arm(row, seen.cell))).norm(), 1e-12);
          EXPECT_EQ(link.crossing, owner == -1);
          const double q = geometry.distance_under_lip(row, seen.cell, seen.direction);
          if (scheme != WallScheme::bounce_back) {
            EXPECT_NEAR(link.q, q, rounding);
          }
          if (link.crossing) {
            EXPECT_EQ(link.scheme, scheme == WallScheme::multireflection ? WallScheme::cli : scheme);
          } else {
            EXPECT_EQ(link.scheme, scheme_at(geometry, cell, i, scheme));
          }
          const bool across =
              link.scheme == WallScheme::multireflection && !inside.contains(at_block - lbm::D3Q19::c[i]);
          EXPECT_EQ(link.pair, across ? std::int64_t(pair_of(at_block, i)) : in_block);
          kinds.single_cell += link.scheme == WallScheme::single_cell_gap;
          kinds.two_cells +=
              !link.crossing && link.scheme != scheme && link.scheme != WallScheme::single_cell_gap;
          kinds.across += across;
          kinds.crossing += link.crossing;
          kinds.reflected += seen.sign != Vec3(1, 1, 1);
          left.erase(at);
        }
      }
  EXPECT_TRUE(left.empty()) << left.size() << " links that are none";
}

}  // namespace silt::coupler::testing
