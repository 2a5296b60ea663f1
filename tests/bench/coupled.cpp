// Whole coupled steps over the fluid alone on one core: layers of spheres moving through a periodic box.
// Case a: 6 % solid; case b: 17 %. The fluid alone and the scenes of a case take turns, so that what disturbs
// the machine disturbs all of them; medians. --quick: a smaller box, fewer turns. --only TEXT: only scenes
// whose key contains it (TEXT$: is it).
#include <mpi.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "coupler/case_file.hpp"
#include "coupler/simulation.hpp"
#include "lbm/fluid.hpp"
#include "tests/bench/figures.hpp"

using namespace silt;

namespace {

constexpr int steps_a_turn = 8;
const rigid::Vec3 course =
    rigid::Vec3(0.6, 0.5, 0.62).normalized();  // so that no lattice direction is special

struct Size {
  int cells, turns;
};

struct Setup {
  char name;  // a or b
  int diameter;
  std::string wall_scheme, time;
  double speed;

  std::string key() const {
    return std::string("coupled.") + name + "." + wall_scheme + (diameter == 6 ? "" : ".d10") +
           (time == "explicit" ? ".explicit" : "") + (speed < 0.001 ? ".resting" : "");
  }
};

std::string centres(const Setup& setup, int n) {
  const double scale = setup.diameter / 6.0, across = (setup.name == 'a' ? 16 : 9) * scale, up = 7 * scale;
  unsigned random = 1;
  const auto shift = [&] {
    return random = random * 1664525u + 1013904223u, (random >> 8) / double(1 << 24);
  };
  std::string text;
  for (double z = 4 * scale; z + up / 2 < n; z += up)
    for (double y = across / 2; y + across / 2 <= n; y += across)
      for (double x = across / 2; x + across / 2 <= n; x += across)
        text += "[" + std::to_string(x + shift()) + ", " + std::to_string(y + shift()) + ", " +
                std::to_string(z + 0.5 * shift()) + "], ";
  return text;
}

std::string case_text(const Setup& setup, int n) {
  const std::string edge = std::to_string(n);
  return "title = \"bench\"\n[units]\nsystem = \"lattice\"\n[domain]\nsize = [" + edge + ", " + edge + ", " +
         edge + "]\nboundary = \"periodic\"\n[fluid]\nrelaxation_time = 1.2\n[coupling]\nwall_scheme = \"" +
         setup.wall_scheme + "\"\ntime = \"" + setup.time +
         "\"\n[[shapes]]\nname = \"sphere\"\ntype = \"sphere\"\ndiameter = " +
         std::to_string(setup.diameter) + "\n[[bodies]]\nshape = \"sphere\"\ndensity = 1.2\npositions = [" +
         centres(setup, n) + "]\n[run]\nsteps = 1000\n";
}

/// A scene, and the seconds a step of it took: all, and stage by stage.
class Scene {
 public:
  Scene(const Setup& setup, int n)
      : setup_(setup), simulation_(coupler::read_case_text(case_text(setup, n), "bench"), MPI_COMM_SELF) {
    for (int t = 0; t < 4; ++t) step();
  }
  void take_turn() {
    const coupler::StageSeconds before = simulation_.stage_seconds();
    for (int t = 0; t < steps_a_turn; ++t) step();
    coupler::StageSeconds stages;
    double all = 0;
    for (std::size_t k = 0; k < stages.size(); ++k)
      all += stages[k] = (simulation_.stage_seconds()[k] - before[k]) / steps_a_turn;
    seconds.push_back(all);
    for (std::size_t k = 0; k < stages.size(); ++k) stage_seconds[k].push_back(stages[k]);
  }
  const Setup& setup() const { return setup_; }
  coupler::Simulation& simulation() { return simulation_; }

  std::vector<double> seconds;
  std::array<std::vector<double>, int(coupler::Stage::count)> stage_seconds;

 private:
  /// The fluid would slow the spheres down: they are set going again before every step (not timed).
  void step() {
    rigid::BodySet& bodies = simulation_.bodies();
    for (std::size_t row = 0; row < bodies.owned; ++row)
      bodies.set_velocity(row, setup_.speed * course, rigid::Vec3::Zero());
    simulation_.step();
  }
  Setup setup_;
  coupler::Simulation simulation_;
};

class FluidAlone {
 public:
  explicit FluidAlone(int n)
      : fluid_(lbm::Domain({n, n, n}, {}, std::nullopt, 1), {1.2, 1. / 6, false, {}}, MPI_COMM_SELF) {
    take_turn();
    seconds.clear();
  }
  void take_turn() {
    seconds.push_back(bench::seconds([&] {
                        for (int t = 0; t < steps_a_turn; ++t) fluid_.stream_collide(), fluid_.exchange();
                      }) /
                      steps_a_turn);
  }
  std::vector<double> seconds;

 private:
  lbm::Fluid<float> fluid_;
};

void report(Scene& scene, const FluidAlone& fluid, int n, bench::Figures& figures) {
  const double cells = double(n) * n * n, alone = bench::median(fluid.seconds);
  const double links = double(scene.simulation().links());
  const double solid = 1 - double(scene.simulation().look_at_flow().fluid_cells) / cells;
  std::vector<double> ratios;
  for (std::size_t t = 0; t < scene.seconds.size(); ++t)
    ratios.push_back(scene.seconds[t] / fluid.seconds[t]);
  const double ratio = bench::median(ratios), all = bench::median(scene.seconds);
  const double link_ns = (all - alone) / links * 1e9;
  const std::string key = scene.setup().key();
  printf("%-34s %.3f of the fluid (%.0f MLUPS alone); %.1f %% solid, %.2f links a cell, %.1f ns a link\n",
         key.c_str(), ratio, cells / alone * 1e-6, 100 * solid, links / cells, link_ns);
  figures.figures[key + ".over_fluid"] = ratio;
  adapters::Json row = adapters::Json::object(
      {{"scene", key}, {"over_fluid", ratio}, {"links_per_cell", links / cells}, {"ns_per_link", link_ns}});
  for (std::size_t k = 0; k < scene.stage_seconds.size(); ++k) {
    const double share = bench::median(scene.stage_seconds[k]) / alone;
    printf("    %-22s %.3f\n", std::string(coupler::stage_names[k]).c_str(), share);
    row[std::string(coupler::stage_names[k])] = share;
  }
  figures.table.push_back(row);
  fflush(stdout);
}

std::vector<Setup> all_setups() {
  std::vector<Setup> setups;
  for (const char name : {'a', 'b'})
    for (const int diameter : {6, 10})
      for (const char* scheme : {"cli", "bounce-back"})
        for (const char* time : {"explicit", "implicit"})
          for (const double speed : {0.01, 0.0005})
            if (scheme == std::string("cli") || (diameter == 6 && speed > 0.001))
              setups.push_back({name, diameter, scheme, time, speed});
  return setups;
}

/// Scenes of one case and diameter take turns; together they must fit into memory.
void measure(const std::vector<Setup>& setups, const Size& size, bench::Figures& figures) {
  FluidAlone fluid(size.cells);
  std::vector<std::unique_ptr<Scene>> scenes;
  for (const Setup& s : setups) scenes.push_back(std::make_unique<Scene>(s, size.cells));
  for (int turn = 0; turn < size.turns; ++turn) {
    fluid.take_turn();
    for (auto& scene : scenes) scene->take_turn();
  }
  for (auto& scene : scenes) report(*scene, fluid, size.cells, figures);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  bench::Options options = bench::options_of(argc, argv);
  std::string only;
  if (options.others.size() == 2 && options.others[0] == "--only")
    only = options.others[1], options.others.clear();
  bench::require_no_others(options);
  const Size size = options.quick ? Size{96, 5} : Size{160, 9};
  bench::Figures figures;
  std::vector<Setup> group;
  const auto flush = [&] {
    if (!group.empty()) measure(group, size, figures);
    group.clear();
  };
  for (const Setup& s : all_setups()) {
    if (only.ends_with("$") ? s.key() + "$" != only : s.key().find(only) == std::string::npos) continue;
    if (!group.empty() && (s.name != group[0].name || s.diameter != group[0].diameter)) flush();
    group.push_back(s);
  }
  flush();
  figures.write(options.json);
  MPI_Finalize();
}
