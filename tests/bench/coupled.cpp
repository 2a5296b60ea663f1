// Whole coupled steps over the fluid alone on one core, stage by stage: the paper's Figure 7 and Table III.
//
// Layers of bodies that move by 0.01 cells a step (layers.hpp), cases a and b: 6.3 and 20 % solid; spheres of
// 6 cells in boxes of about 160, 80 and 40 cells an edge under every wall scheme, and spheres of 10 and 20
// cells, boxes, capsules and stars. The fluid alone, the bandwidth bound (bound.hpp) and the scenes of a box
// take turns, so that what disturbs the machine disturbs all of them; medians. GFlop/s and GB/s of the stages
// that have a count of operations and bytes (work.hpp), against a loop of additions and multiplications and
// that bound.
//   scripts/bench coupled [--quick] [--only TEXT[,TEXT...]] [--json FILE]      (--only: scenes whose key
//   contains a TEXT, TEXT$: is it; --quick: 96 cells an edge, fewer turns)
#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "lbm/fluid.hpp"
#include "tests/bench/bound.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/moving_layers.hpp"
#include "tests/bench/periodic_box.hpp"
#include "tests/bench/work.hpp"

namespace silt::bench::coupled {
namespace {

using coupler::Stage, coupler::StageSeconds, coupler::stage_names;

constexpr double resting_speed = 0.0005;  // cells a step: hardly ever mapped anew

struct Plan {
  int large, turns;  // cells an edge of the boxes that count

  std::string key(const Layers& l) const {
    return std::string("coupled.") + l.name + "." + l.scheme + (l.body == "d6" ? "" : "." + l.body) +
           (l.edge == large ? "" : ".n" + std::to_string(l.edge)) +
           (l.time == "explicit" ? ".explicit" : "") + (l.speed == resting_speed ? ".resting" : "");
  }
  /// Returns all scenes; scenes that share a box follow one another.
  std::vector<Layers> scenes() const {
    std::vector<Layers> all;
    for (const char name : {'a', 'b'}) {
      for (const int edge : {large, 80, 40})
        for (const char* scheme : {"multireflection", "cli", "parabolic", "bounce-back"}) {
          all.push_back({name, "d6", edge, scheme});
          if (edge == large) all.push_back({name, "d6", edge, scheme, "explicit"});
        }
      for (const char* body : {"d10", "d20", "box", "capsule", "star"})
        for (const char* scheme : {"multireflection", "cli"}) all.push_back({name, body, large, scheme});
      all.push_back({name, "d10", large, "cli", "explicit"});
      for (const char* body : {"d6", "d10"})
        for (const char* time : {"implicit", "explicit"})
          all.push_back({name, body, large, "cli", time, resting_speed});
    }
    return all;
  }
};

double count_of(lbm::Int3 n) {
  return double(n.x) * n.y * n.z;
}

/// Whole rounds of mapping, an even number of steps; long enough for a clock.
int steps_a_turn(double cells) {
  return 2 * round_of_mapping * std::max(1, int(1e6 / cells));
}

/// The fluid alone and the bound, against which all scenes of one box are measured.
class Machine {
 public:
  explicit Machine(lbm::Int3 n)
      : cells_(count_of(n)),
        fluid_(periodic_box<float>(n, {1.2, 1. / 6, lbm::Collision::trt, {}})),
        bound_(std::ptrdiff_t(cells_)) {
    take_turn();
    alone_ = {};
    bound_.forget();
  }
  void take_turn() {
    const int steps = steps_a_turn(cells_);
    alone_.add(seconds([&] { step(fluid_, steps); }) / steps);
    bound_.sample(std::max(1, steps / 8), [] {});
  }
  double cells() const { return cells_; }
  const Spread& alone() const { return alone_; }  // seconds a step
  double gbytes() const { return bound_.best().middle() * bytes_per_cell<float> * 1e-3; }

 private:
  double cells_;
  lbm::Fluid<float> fluid_;
  Bound<float> bound_;
  Spread alone_;
};

/// The operations and bytes of a step, where they are known.
struct Work {
  double flops = 0, bytes = 0;
};

std::map<Stage, Work> work_of(const MovingLayers& scene, double cells) {
  const LinkWork link = link_work(scene.layers().scheme, scene.layers().time == "implicit", sizeof(float));
  return {{Stage::stream_collide, {cells * flops_per_cell_with_force, cells * bytes_per_cell<float>}},
          {Stage::force_evaluation, {scene.links() * link.flops, scene.links() * link.bytes}}};
}

struct Rates {
  double seconds, gflops, gbytes;
  Rates(const Work& work, double time)
      : seconds(time), gflops(work.flops / time * 1e-9), gbytes(work.bytes / time * 1e-9) {}
};

/// A row of Table III; printed as well.
Json rates_row(const std::string& key, const std::string& stage, const Rates& r, const Machine& machine,
               double peak) {
  printf("    %-22s %6.1f GFlop/s, %2.0f %% of peak %6.1f GB/s, %3.0f %% of the bound\n", stage.c_str(),
         r.gflops, 100 * r.gflops / peak, r.gbytes, 100 * r.gbytes / machine.gbytes());
  return Json::object({{"scene", key},
                       {"stage", stage},
                       {"ns_per_cell", r.seconds / machine.cells() * 1e9},
                       {"gflops", r.gflops},
                       {"share_of_peak", r.gflops / peak},
                       {"gbytes_per_second", r.gbytes},
                       {"share_of_bound", r.gbytes / machine.gbytes()}});
}

class Report {
 public:
  Report(const Plan& plan, double peak) : plan_(plan), peak_(peak) {}

  void add(const Machine& machine, lbm::Int3 n) {
    const double alone = machine.alone().middle(), cells = machine.cells();
    printf("%d x %d x %d cells: the fluid alone %.0f MLUPS; bound %.1f GB/s, peak %.0f GFlop/s\n", n.x, n.y,
           n.z, cells / alone * 1e-6, machine.gbytes(), peak_);
    const std::string box = std::to_string(n.x) + "x" + std::to_string(n.y) + "x" + std::to_string(n.z);
    rates_.push_back(rates_row(box, "fluid alone",
                               Rates({cells * flops_per_cell, cells * bytes_per_cell<float>}, alone), machine,
                               peak_));
  }
  void add(MovingLayers& scene, const Machine& machine) {
    const double cells = machine.cells(), links = scene.links(), alone = machine.alone().middle();
    const Spread over = ratio(scene.whole(), machine.alone());
    const std::string key = plan_.key(scene.layers());
    const double ns = (scene.whole().middle() - alone) / links * 1e9, solid = 1 - scene.fluid_cells() / cells;
    printf(
        "%-34s %.2f of the fluid (%.2f to %.2f), %.0f MLUPS; %.1f %% solid, %.2f links a cell, %.1f ns a "
        "link\n",
        key.c_str(), over.middle(), over.lowest(), over.highest(), cells / scene.whole().middle() * 1e-6,
        100 * solid, links / cells, ns);
    figures_.figures[key + ".over_fluid"] = over.middle();
    figures_.figures[key + ".ns_per_link"] = ns;
    Json row = Json::object({{"scene", key},
                             {"over_fluid", over.middle()},
                             {"over_fluid_lowest", over.lowest()},
                             {"over_fluid_highest", over.highest()},
                             {"solid", solid},
                             {"links_per_cell", links / cells},
                             {"ns_per_link", ns}});
    printf("   ");
    for (int k = 0; k < int(Stage::count); ++k) {
      const double share = scene.seconds_of(Stage(k)) / alone;
      const std::string stage(stage_names[k]);
      row[stage] = share;
      if (share >= 0.005) printf(" %s %.2f", stage.c_str(), share);
    }
    printf("\n");
    figures_.table.push_back(row);
    add_rates(scene, machine, key);
  }
  void write(const std::string& file) {
    for (const auto& row : rates_) figures_.table.push_back(row);
    figures_.write(file);
  }

 private:
  void add_rates(const MovingLayers& scene, const Machine& machine, const std::string& key) {
    Work all;
    for (const auto& [stage, work] : work_of(scene, machine.cells())) {
      all.flops += work.flops, all.bytes += work.bytes;
      rates_.push_back(rates_row(key, std::string(stage_names[int(stage)]),
                                 Rates(work, scene.seconds_of(stage)), machine, peak_));
    }
    rates_.push_back(rates_row(key, "whole step", Rates(all, scene.whole().middle()), machine, peak_));
  }
  Plan plan_;
  double peak_;
  Figures figures_;
  std::vector<Json> rates_;
};

/// Scenes of one box take turns; together they must fit into memory.
void measure(const std::vector<Layers>& group, const Plan& plan, Report& report) {
  const lbm::Int3 n = group[0].cells();
  Machine machine(n);
  std::vector<std::unique_ptr<MovingLayers>> scenes;
  for (const Layers& l : group) scenes.push_back(std::make_unique<MovingLayers>(l));
  for (int turn = 0; turn < plan.turns; ++turn) {
    machine.take_turn();
    for (auto& scene : scenes) scene->take_turn(steps_a_turn(machine.cells()));
  }
  report.add(machine, n);
  for (auto& scene : scenes) report.add(*scene, machine);
}

/// `only` as the option has it; empty: all.
bool wanted(const std::string& key, const std::string& only) {
  std::istringstream texts(only);
  for (std::string text; std::getline(texts, text, ',');)
    if (text.ends_with("$") ? key + "$" == text : key.find(text) != std::string::npos) return true;
  return only.empty();
}

/// Returns the text of --only, the option that this benchmark has.
std::string wanted_scenes(const Options& options) {
  if (options.others.size() == 2 && options.others[0] == "--only") return options.others[1];
  require_no_others(options);
  return "";
}

}  // namespace

void run(const Options& options) {
  const std::string only = wanted_scenes(options);
  const Plan plan = options.quick ? Plan{96, 3} : Plan{160, 5};
  Report report(plan, peak_gflops<float>());
  std::map<std::string, std::vector<Layers>> groups;  // by case, body and box
  std::vector<std::string> order;
  for (const Layers& l : plan.scenes()) {
    const std::string key = plan.key(l);
    if (!wanted(key, only)) continue;
    const std::string box = std::string(1, l.name) + l.body + std::to_string(l.edge);
    if (!groups.count(box)) order.push_back(box);
    groups[box].push_back(l);
  }
  for (const std::string& box : order) measure(groups[box], plan, report);
  report.write(options.json);
}

}  // namespace silt::bench::coupled
