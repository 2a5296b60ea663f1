#pragma once
// A periodic box of fluid with walls in it, given by formulas, for tests of the wall schemes: one block, its
// links found cell by cell.
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "lbm/cut_links.hpp"
#include "lbm/fluid.hpp"
#include "lbm/pairs_across.hpp"

namespace silt::lbm {

struct Point {
  double x, y, z;
};
struct Hit {
  double q;  // >= 1: no wall on the link
  int surface = 0;
};

/// Which cells are fluid, and where a link from a cell's centre meets a wall.
struct WalledScene {
  Int3 cells;
  std::function<bool(Point)> is_fluid;
  std::function<Hit(Point, Int3 c)> hit;
};

class WalledBox {
 public:
  WalledBox(const WalledScene& scene, WallScheme scheme, const CollisionSpec& collision)
      : scene_(scene),
        fluid_(Domain(scene.cells, {}, std::nullopt, 1), collision, MPI_COMM_SELF),
        pairs_(fluid_.domain(), MPI_COMM_SELF, std::span<const Block<double>>(fluid_.blocks())) {
    for (int surface = 0; surface < 2; ++surface) {
      links_[surface].fluid = WallFluid<double>(collision);
      links_[surface].frame = {{0, 0, 0}, {0, 0, 0}, 1, false};
      for (int z = 0; z < scene.cells.z; ++z) add_groups(scheme, surface, z);
    }
  }

  void step() {
    fluid_.stream_collide();
    fluid_.exchange();
    pairs_.exchange(fluid_.blocks(), fluid_.parity());
    sums_ = {};
    const LinkSlots slots = link_slots(fluid_.blocks()[0], fluid_.parity());
    for (int k = 0; k < 2; ++k)
      for (const LinkGroup& g : links_[k].groups)
        apply_cut_links<double>({fluid_.blocks()[0], slots, links_[k], g, {}, pairs_.of(0)}, motions[k],
                                ForceForm::galilean, sums_[k]);
  }
  /// Calls f(cell, its centre) for every fluid cell.
  template <class F>
  void for_fluid(F&& f) const {
    for (int z = 0; z < scene_.cells.z; ++z)
      for (int y = 0; y < scene_.cells.y; ++y)
        for (int x = 0; x < scene_.cells.x; ++x)
          if (is_fluid({x, y, z})) f(Int3{x, y, z}, centre({x, y, z}));
  }
  std::array<double, 3> velocity(Int3 x) { return fluid_.velocity(fluid_.moments(0, x)); }
  double force(int surface, int axis) const { return double(sums_[surface].force[axis]) * link_quantum; }
  Fluid<double>& fluid() { return fluid_; }
  /// Links under `single_cell_gap`, and those of two-cell gaps that are under another scheme than theirs.
  std::size_t gap_links() const { return gap_links_; }

  std::array<SurfaceMotion, 2> motions{};

 private:
  struct Link {
    std::uint32_t place;
    double q;
  };
  static Point centre(Int3 x) { return {x.x + 0.5, x.y + 0.5, x.z + 0.5}; }
  bool is_fluid(Int3 x) const { return scene_.is_fluid(centre(fluid_.domain().wrapped(x))); }
  bool outside(Int3 x) const {
    for (int d = 0; d < 3; ++d)
      if (x[d] < 0 || x[d] >= scene_.cells[d]) return true;
    return false;
  }

  void add_groups(WallScheme scheme, int surface, int z) {
    std::vector<Link> plain, across, two_cell, single_cell;
    for_fluid([&](Int3 x, Point p) {
      for (int i = 1; i < directions && x.z == z; ++i) {
        const Hit h = scene_.hit(p, c[i]);
        if (h.q >= 1 || h.surface != surface) continue;
        const Link link{link_place({x.x, x.y, 0}, i), h.q};
        if (reads_behind(scheme) && !is_fluid(x - c[i]))
          single_cell.push_back(link);
        else if (reads_beyond(scheme) && !is_fluid(x - c[i] - c[i]))
          two_cell.push_back(link);
        else
          (reads_beyond(scheme) && outside(x - c[i]) ? across : plain).push_back(link);
      }
    });
    add_group(plain, scheme, surface, z, false);
    add_group(across, scheme, surface, z, true);
    add_group(two_cell, two_cell_gap_scheme(scheme), surface, z, false);
    add_group(single_cell, WallScheme::single_cell_gap, surface, z, false);
    gap_links_ += two_cell.size() + single_cell.size();
  }

  void add_group(const std::vector<Link>& found, WallScheme scheme, int surface, int z, bool across) {
    if (found.empty()) return;
    CutLinks<double>& links = links_[surface];
    const std::uint32_t count = std::uint32_t(found.size());
    LinkGroup group{std::uint32_t(links.place.size()), count, scheme, {0, 0, z}, -1};
    group.across = across, group.across_begin = std::uint32_t(links.across.size());
    const PlacesAcross places(scene_.cells);
    for (std::uint32_t l = 0; l < padded(count); ++l) {
      const Link& link = found[std::min(l, count - 1)];
      links.place.push_back(link.place), links.q.push_back(link.q);
      if (across)
        links.across.push_back(places(place_cell(link.place) + Int3{0, 0, z}, place_direction(link.place)));
    }
    links.groups.push_back(group);
  }

  WalledScene scene_;
  Fluid<double> fluid_;
  PairsAcross<double> pairs_;
  std::array<CutLinks<double>, 2> links_;
  std::array<LinkSums, 2> sums_{};
  std::size_t gap_links_ = 0;
};

}  // namespace silt::lbm
