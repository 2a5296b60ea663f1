// The cost of a cut link and of what it waits for, on one core: the kernels of lbm/cut_links by themselves,
// on the links of the paper's layers of spheres (layers.hpp), nanoseconds a link.
//
//   at hand      one sphere's links over and over: all its cache lines are in the first levels
//   fetched      all links in the order of a step, as ones far from the dense pass
//   waited for   the same as ones near it, though none goes before them
//
// The last two read what the cores' caches do not hold (no dense pass goes before them). Medians of turns.
//   scripts/bench links [--quick] [--json FILE]
#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "lbm/fluid.hpp"
#include "lbm/walls/pairs_across.hpp"
#include "silt/simulation.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/layers.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::bench::links {
namespace {

using Group = coupler::BlockLinks<float>::Group;
enum Cost {
  applied_at_hand,
  applied_fetched,
  applied_waited,
  corrected_at_hand,
  corrected_fetched,
  corrected_waited,
  resistance,
  costs
};
constexpr std::array<const char*, costs> cost_names = {
    "applied, at hand",   "applied, fetched",      "applied, waited for", "corrected, at hand",
    "corrected, fetched", "corrected, waited for", "resistance"};

lbm::WallScheme scheme_of(const std::string& name) {
  const auto& names = lbm::wall_scheme_names;
  return lbm::WallScheme(std::find(names.begin(), names.end(), name) - names.begin());
}

/// The links of a scene, applied to a fluid at rest that nothing else moves.
class Links {
 public:
  explicit Links(const Layers& layers)
      : scene_(silt::testing::simulation_of(layers.text())),
        fluid_(scene_.scene().flow->fields().domain(), {1.2, 1. / 6, lbm::Collision::trt, {}},
               MPI_COMM_SELF) {
    const lbm::CellBox box{{}, fluid_.domain().cells()};
    coupler::MapBodies map(fluid_.domain(), scene_.scene().world, std::vector<lbm::CellBox>{box},
                           lbm::link_reach(scheme_of(layers.scheme)));
    map(scene_.bodies());
    coupler::CouplingSpec coupling;
    coupling.wall_scheme = scheme_of(layers.scheme);
    const lbm::WallFluid<float> fluid(fluid_.spec());
    coupler::build_links<float>(map.blocks()[0], scene_.scene().world, scene_.bodies(),
                                {coupling, fluid, fluid_.pass_order(0)}, links_.surfaces);
    links_.order_groups(fluid_.pass_order(0));
    links_.slots = lbm::link_slots(fluid_.blocks()[0], lbm::Parity::crossed);
    links_.leave_to_device(), links_.begin_step(0, fluid_.domain(), box.lower);
    const lbm::RowRange rows[] = {{0, box.size.y, 0, box.size.z}};
    fluid_.hold_excess(0, rows);
    const std::uint32_t middle = links_.inner[links_.inner.size() / 2].surface;
    for (std::uint32_t g = 0; g < links_.surfaces[middle].links.groups.size(); ++g)
      one_.push_back({middle, g});
  }
  std::size_t count() const { return links_.count; }
  const std::vector<Group>& all() const { return links_.inner; }
  const std::vector<Group>& one() const { return one_; }
  std::size_t count_of(const std::vector<Group>& order) const {
    std::size_t n = 0;
    for (const Group& g : order) n += links_.surfaces[g.surface].links.groups[g.number].count;
    return n;
  }

  void apply(const std::vector<Group>& order, bool next, bool fetch = false) {
    for_groups(order, next, [&](const auto& links, const auto& group, auto after) {
      lbm::apply_cut_links<float>(
          {fluid_.blocks()[0], links_.slots, links, group, after, pairs_.of(0), &listed_, fetch}, {},
          lbm::ForceForm::galilean, sums_);
    });
  }
  void correct(const std::vector<Group>& order, bool next, bool fetch = false) {
    for_groups(order, next, [&](const auto& links, const auto& group, auto after) {
      lbm::correct_cut_links<float>(
          {fluid_.blocks()[0], links_.slots, links, group, after, nullptr, &listed_, fetch}, {});
    });
  }
  void sum_resistance() {
    for (const auto& surface : links_.surfaces) resistance_ += lbm::resistance_of(surface.links, 3).h[0];
  }
  /// Keeps what was computed from being left out.
  bool finite() const { return !sums_.invalid && resistance_ >= 0; }

 private:
  template <class F>
  void for_groups(const std::vector<Group>& order, bool next, F&& f) {
    if (next)
      return links_.for_groups(
          order, 0, order.size(),
          [&](const auto& surface, const auto& group, auto after) { f(surface.links, group, after); });
    for (const Group& g : order) {
      const lbm::CutLinks<float>& links = links_.surfaces[g.surface].links;
      f(links, links.groups[g.number], lbm::NextGroup<float>{});
    }
  }

  Simulation scene_;
  lbm::Fluid<float> fluid_;
  lbm::PairsAcross<float> pairs_{fluid_.domain(), MPI_COMM_SELF, fluid_.blocks()};
  coupler::BlockLinks<float> links_;
  std::vector<Group> one_;
  lbm::LinkSums sums_;
  lbm::ListedLinks listed_;
  std::int64_t resistance_ = 0;
};

std::array<Spread, costs> measured(Links& links, int turns) {
  std::array<Spread, costs> cost;
  const int repeats = 200;
  const double hot = double(links.count_of(links.one())) * repeats * 1e-9,
               cold = double(links.count_of(links.all())) * 1e-9;
  const auto again = [&](auto&& work) {
    return seconds([&] {
      for (int k = 0; k < repeats; ++k) work();
    });
  };
  for (int t = 0; t < turns; ++t) {
    cost[applied_at_hand].add(again([&] { links.apply(links.one(), false); }) / hot);
    cost[applied_fetched].add(seconds([&] { links.apply(links.all(), true, true); }) / cold);
    cost[applied_waited].add(seconds([&] { links.apply(links.all(), true, false); }) / cold);
    cost[corrected_at_hand].add(again([&] { links.correct(links.one(), false); }) / hot);
    cost[corrected_fetched].add(seconds([&] { links.correct(links.all(), true, true); }) / cold);
    cost[corrected_waited].add(seconds([&] { links.correct(links.all(), true, false); }) / cold);
    cost[resistance].add(seconds([&] { links.sum_resistance(); }) / double(links.count()) * 1e9);
  }
  return cost;
}

}  // namespace

void run(const Options& o) {
  require_no_others(o);
  Figures out;
  for (const char* scheme : {"bounce-back", "cli", "parabolic", "multireflection"}) {
    Links links({.name = 'b', .edge = o.quick ? 64 : 160, .scheme = scheme});
    const auto cost = measured(links, o.quick ? 5 : 15);
    if (!links.finite()) throw std::runtime_error("the links of a fluid at rest are not at rest");
    std::printf("%s, %zu links\n", scheme, links.count());
    for (int k = 0; k < costs; ++k) {
      std::printf("  %-22s %5.2f ns a link (%.2f to %.2f)\n", cost_names[k], cost[k].middle(),
                  cost[k].lowest(), cost[k].highest());
      out.table.push_back(
          Json::object({{"scheme", scheme}, {"what", cost_names[k]}, {"ns_per_link", cost[k].middle()}}));
    }
    out.figures[std::string("links.") + scheme + ".at_hand"] = cost[applied_at_hand].middle();
    out.figures[std::string("links.") + scheme + ".fetched"] = cost[applied_fetched].middle();
    out.figures[std::string("links.") + scheme + ".waited_for"] = cost[applied_waited].middle();
  }
  out.write(o.json);
}

}  // namespace silt::bench::links
