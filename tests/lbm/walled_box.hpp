#pragma once
// A periodic box of fluid with walls in it, given by formulas, for tests of the wall schemes: on one rank, in
// one block or in those of a tree, its links found cell by cell.
#include <array>
#include <functional>
#include <vector>

#include "lbm/walls/cut_links.hpp"
#include "lbm/walls/pairs_across.hpp"
#include "tests/lbm/levelled_flow.hpp"

namespace silt::lbm {

struct Point {
  double x, y, z;
};
struct Hit {
  double q;  // > 1: no wall on the link
  int surface = 0;
};

/// A scene says which cells are fluid, and where a link from a cell's centre meets a wall.
struct WalledScene {
  Int3 cells;
  std::function<bool(Point)> is_fluid;
  std::function<Hit(Point, Int3 c)> hit;
};

class WalledBox {
 public:
  WalledBox(const WalledScene& scene, WallScheme scheme, const CollisionSpec& collision)
      : WalledBox(scene, scheme, collision, CutTree(scene.cells, {}, {{0, 0}}), 0) {}
  /// Leaves of the tree with fluid near a wall are of level 0, others of so many coarser ones.
  WalledBox(const WalledScene& scene, WallScheme scheme, const CollisionSpec& collision, const CutTree& tree,
            int coarser)
      : scene_(scene),
        flow_(tree, {}, collision, coarser, MPI_COMM_SELF),
        pairs_(domain(), MPI_COMM_SELF, std::span<const Block<double>>(fluid().blocks())),
        links_(fluid().blocks().size()) {
    for (std::size_t b = 0; b < links_.size(); ++b)
      for (int surface = 0; surface < 2; ++surface) {
        links_[b][surface].fluid = WallFluid<double>(collision);
        links_[b][surface].frame = {{0, 0, 0}, {0, 0, 0}, 1, false};
        for (int z = 0; z < fluid().blocks()[b].size().z; ++z) add_groups(scheme, int(b), surface, z);
      }
    for (std::size_t b = 0; b < links_.size(); ++b) {
      const Int3 size = fluid().blocks()[b].size();
      const RowRange rows[] = {{0, size.y, 0, size.z}};
      fluid().hold_excess(int(b), rows);
    }
  }

  void step() {
    flow_.step(1);
    pairs_.exchange(fluid().blocks(), fluid().parity());
    sums_ = {};
    for (std::size_t b = 0; b < links_.size(); ++b) {
      Block<double>& block = fluid().blocks()[b];
      const LinkSlots slots = link_slots(block, fluid().parity());
      for (int k = 0; k < 2; ++k)
        for (const LinkGroup& g : links_[b][k].groups)
          apply_cut_links<double>({block, slots, links_[b][k], g, {}, pairs_.of(int(b))}, motions[k],
                                  ForceForm::galilean, sums_[k]);
    }
    if (!keeps_mass) drop_excess();
  }
  /// Calls f(cell, its centre) for every fluid cell of level 0.
  template <class F>
  void for_fluid(F&& f) const {
    for (const Block<double>& block : fluid().blocks())
      for_cells(block.box().lower, block.box().lower + block.size(), [&](Int3 x) {
        if (is_fluid(x)) f(x, centre(x));
      });
  }
  std::array<double, 3> velocity(Int3 x) const {
    const BlockPlace at = domain().block_at(x);
    return fluid().velocity(fluid().moments(domain().local_index(at, 0), x - at.box.lower));
  }
  double force(int surface, int axis) const { return double(sums_[surface].force[axis]) * link_quantum; }
  Fluid<double>& fluid() { return flow_.finest; }
  const Fluid<double>& fluid() const { return flow_.finest; }
  testing::LevelledFlow<double>& flow() { return flow_; }
  /// The links of a surface in the first block.
  CutLinks<double>& links(int surface) { return links_[0][surface]; }
  /// Links under `single_cell_gap`, and those of two-cell gaps that are under another scheme than theirs.
  std::size_t gap_links() const { return gap_links_; }

  std::array<SurfaceMotion, 2> motions{};
  /// Cells get the excess of their links back, as in a run. Without it the flow has the closure alone.
  bool keeps_mass = false;

 private:
  struct Link {
    std::uint32_t place;
    double q;
  };
  const Domain& domain() const { return fluid().domain(); }
  static Point centre(Int3 x) { return {x.x + 0.5, x.y + 0.5, x.z + 0.5}; }
  bool is_fluid(Int3 x) const { return scene_.is_fluid(centre(domain().wrapped(x))); }

  void add_groups(WallScheme scheme, int b, int surface, int z) {
    std::vector<Link> plain, across, two_cell, single_cell;
    const CellBox box = fluid().blocks()[b].box();
    for_cells({0, 0, z}, {box.size.x, box.size.y, z + 1}, [&](Int3 local) {
      const Int3 x = box.lower + local;
      for (int i = 1; i < D3Q19::directions && is_fluid(x); ++i) {
        const Hit h = scene_.hit(centre(x), D3Q19::c[i]);
        if (h.q > 1 || h.surface != surface) continue;
        const Link link{link_place({local.x, local.y, 0}, i), h.q};
        if (reads_behind(scheme) && !is_fluid(x - D3Q19::c[i]))
          single_cell.push_back(link);
        else if (reads_beyond(scheme) && !is_fluid(x - D3Q19::c[i] - D3Q19::c[i]))
          two_cell.push_back(link);
        else
          (reads_beyond(scheme) && !box.contains(x - D3Q19::c[i]) ? across : plain).push_back(link);
      }
    });
    CutLinks<double>& links = links_[b][surface];
    const PlacesAcross<D3Q19> places(box.size);
    add_group(links, plain, scheme, z, nullptr);
    add_group(links, across, scheme, z, &places);
    add_group(links, two_cell, two_cell_gap_scheme(scheme), z, nullptr);
    add_group(links, single_cell, WallScheme::single_cell_gap, z, nullptr);
    gap_links_ += two_cell.size() + single_cell.size();
  }

  void drop_excess() {
    for (Block<double>& block : fluid().blocks())
      for_cells({}, block.size(), [&](Int3 x) { block.excess()[block.cell(x)] = 0; });
  }

  static void add_group(CutLinks<double>& links, const std::vector<Link>& found, WallScheme scheme, int z,
                        const PlacesAcross<D3Q19>* across) {
    if (found.empty()) return;
    const std::uint32_t count = std::uint32_t(found.size());
    LinkGroup group{std::uint32_t(links.place.size()), count, scheme, {0, 0, z}, -1};
    group.across = across, group.across_begin = std::uint32_t(links.across.size());
    for (std::uint32_t l = 0; l < padded(count); ++l) {
      const Link& link = found[std::min(l, count - 1)];
      links.place.push_back(link.place), links.q.push_back(link.q);
      if (across)
        links.across.push_back(
            (*across)(place_cell(link.place) + Int3{0, 0, z}, place_direction(link.place)));
    }
    links.groups.push_back(group);
  }

  WalledScene scene_;
  testing::LevelledFlow<double> flow_;
  PairsAcross<double> pairs_;
  std::vector<std::array<CutLinks<double>, 2>> links_;  // of the blocks, by surface
  std::array<LinkSums, 2> sums_{};
  std::size_t gap_links_ = 0;
};

}  // namespace silt::lbm
