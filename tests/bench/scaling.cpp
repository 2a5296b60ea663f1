// The paper's scaling study on the ranks there are: the fluid alone (Table II) and layers of moving bodies,
// cases A and B (Figures 8, 9 and 12), boxes of 40 and 80 cells an edge a rank (weak), and one box for all
// ranks (strong: Table IV, Figures 10 and 11), with the stages of a step (Figure 7).
//
// Where there is a core for each rank, all ranks and the first one alone take turns, with the bandwidth bound
// (bound.hpp) of as many cores; where there is not, nothing is timed. Either way what the ranks sent is
// compared with what they should have by step_traffic.hpp, exactly.
//   mpirun -n P build/release/tests/benchmarks scaling [--quick] [--json FILE]      (scripts/bench scaling:
//   all P)
#include <sys/resource.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "lbm/walls/cut_links.hpp"
#include "silt/case/case.hpp"
#include "tests/bench/bound.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/layers.hpp"
#include "tests/bench/step_traffic.hpp"
#include "tests/bench/wait_asleep.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::bench::scaling {
namespace {

using coupler::Stage, coupler::stage_names;

int rank_in(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

double sum_over(MPI_Comm comm, double x) {
  MPI_Allreduce(MPI_IN_PLACE, &x, 1, MPI_DOUBLE, MPI_SUM, comm);
  return x;
}

/// So many ranks side by side, as near to a cube as their number allows; the longest along z.
std::array<int, 3> side_by_side(int ranks) {
  std::array<int, 3> best = {1, 1, ranks};
  for (int x = 1; x * x * x <= ranks; ++x)
    for (int y = x; x * y * y <= ranks; ++y)
      if (ranks % (x * y) == 0) best = {x, y, ranks / (x * y)};
  return best;
}

struct Study {
  std::string scene;  // fluid, a, b
  int edge;           // cells, of a rank's box
  bool strong;        // edge is that of the box of all

  std::string key() const { return (strong ? "strong." : "weak.") + scene + ".n" + std::to_string(edge); }
  std::string text(int ranks) const {
    Layers layers{scene == "b" ? 'b' : 'a', "d6", edge, "multireflection"};
    if (!strong) layers.boxes = side_by_side(ranks);
    const std::string all = layers.text();
    if (scene != "fluid") return all;
    const auto bodies = all.find("[coupling]"), run = all.find("[run]");
    return all.substr(0, bodies) + all.substr(run);
  }
};

/// A study's scene on the ranks of a communicator.
class Side {
 public:
  Side(const Study& study, MPI_Comm comm, int ranks)
      : comm_(comm), simulation_(silt::testing::simulation_of(study.text(ranks), comm)) {
    for (int t = 0; t < 2; ++t) step();
  }
  /// Seconds a step.
  void take_turn(int steps) {
    const auto before = simulation_.stage_seconds();
    MPI_Barrier(comm_);
    whole_.add(seconds([&] {
                 for (int t = 0; t < steps; ++t) step();
                 MPI_Barrier(comm_);
               }) /
               steps);
    for (std::size_t s = 0; s < stages_.size(); ++s) stages_[s] += simulation_.stage_seconds()[s] - before[s];
  }
  void forget() { whole_ = {}; }
  /// The fluid would slow the bodies down: they are set going again before every step.
  void set_going() {
    const auto v = Layers{}.velocity();
    rigid::BodySet& bodies = simulation_.bodies();
    for (std::size_t row = 0; row < bodies.first_wall(); ++row)
      bodies.set_velocity(row, {v[0], v[1], v[2]}, rigid::Vec3::Zero());
  }
  void step() {
    set_going();
    simulation_.step();
  }
  Simulation& simulation() { return simulation_; }
  const Spread& whole() const { return whole_; }
  const std::array<double, std::size_t(Stage::count)>& stages() const { return stages_; }

 private:
  MPI_Comm comm_;
  Simulation simulation_;
  Spread whole_;
  std::array<double, std::size_t(Stage::count)> stages_{};
};

/// The messages that the ranks should send in the next step, in those stages where the paper tells it: not
/// the moments for refilled cells, nor the sweeps.
struct Expected {
  Sent fluid;
  double forces = 0, bodies = 0;  // messages
};

Expected expected_of(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  constexpr int number = sizeof(float);
  Expected e;
  e.fluid = halo_sent(scene.domain, scene.rank(), number);
  if (!scene.setup.has_surfaces() || scene.ranks() == 1) return e;
  if (lbm::reads_beyond(scene.setup.coupling.wall_scheme)) e.fluid += pairs_sent(simulation, number);
  e.forces = 2.0 * double(copied_from(simulation).size());  // sums to owners, changes of velocity from them
  const int around = ranks_within(scene.domain, scene.rank(), scene.exchange->reach());
  for (int sub = 0; sub < scene.setup.contacts.substeps; ++sub) {
    const double begin = double(sub) / scene.setup.contacts.substeps;
    e.bodies += around + double(copied_to(simulation, begin).size());
  }
  return e;
}

/// Sums over the ranks, of several steps.
struct Compared {
  double expected[4] = {}, sent[4] = {};  // messages, bytes of the fluid; messages of forces, of bodies

  bool exact() const { return std::equal(expected, expected + 4, sent); }
  double error() const {  // of messages and bytes, relative, the worst
    double worst = 0;
    for (int k = 0; k < 4; ++k)
      if (expected[k] != sent[k]) worst = std::max(worst, std::abs(sent[k] / expected[k] - 1));
    return worst;
  }
};

Compared compare(Side& side, MPI_Comm comm, int steps) {
  Compared all;
  const auto at = [](Stage s) { return std::size_t(s); };
  const auto before = side.simulation().stage_traffic();
  for (int t = 0; t < steps; ++t) {
    side.set_going();
    const Expected e = expected_of(side.simulation());
    const double now[4] = {e.fluid.messages, e.fluid.bytes, e.forces, e.bodies};
    for (int k = 0; k < 4; ++k) all.expected[k] += now[k];
    side.step();
  }
  const auto after = side.simulation().stage_traffic();
  const auto sent = [&](Stage s) { return after[at(s)] - before[at(s)]; };
  const parallel::Traffic pass = sent(Stage::stream_collide), halo = sent(Stage::lbm_communication);
  all.sent[0] = double(pass.messages + halo.messages);
  all.sent[1] = double(pass.bytes + halo.bytes);
  all.sent[2] = double(sent(Stage::force_evaluation).messages);
  all.sent[3] = double(sent(Stage::body_synchronisation).messages);
  for (double* x : {all.expected, all.sent})
    for (int k = 0; k < 4; ++k) x[k] = sum_over(comm, x[k]);
  return all;
}

double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * double(usage.ru_maxrss);
}

class Ranks {
 public:
  Ranks(const Options& options, Figures& out) : options_(options), out_(out) {
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    timed_ = ranks_ <= int(std::thread::hardware_concurrency());
  }
  void run(const Study& study) {
    const bool loud = rank_in(MPI_COMM_WORLD) == 0;
    Side all(study, MPI_COMM_WORLD, ranks_);
    const Compared traffic = compare(all, MPI_COMM_WORLD, 4);
    worst_ = std::max(worst_, traffic.error());
    const double cells = double(all.simulation().scene().domain.cells().x) *
                         all.simulation().scene().domain.cells().y *
                         all.simulation().scene().domain.cells().z;
    const double bodies = double(all.simulation().body_count());
    const double links = double(all.simulation().links());
    const double memory = sum_over(MPI_COMM_WORLD, peak_memory()) / ranks_;
    Json row = Json::object({{"study", study.key()},
                             {"ranks", ranks_},
                             {"cells", cells},
                             {"bodies", bodies},
                             {"links", links},
                             {"memory_a_rank", memory}});
    const double messages = add_traffic(all, traffic, row);
    if (timed_) time(study, all, cells, loud, row);
    if (!loud) return;
    printf("%-16s %2d ranks  %8.0f cells a rank  messages a rank and step %5.1f, as counted on paper: %s%s\n",
           study.key().c_str(), ranks_, cells / ranks_, messages, traffic.exact() ? "yes" : "NO",
           timed_ ? time_line_.c_str() : "");
    out_.table.push_back(row);
  }
  void finish() { out_.figures["model.message_error"] = worst_; }

 private:
  /// Returns the messages a rank and step.
  double add_traffic(Side& all, const Compared& traffic, Json& row) {
    const double steps = double(all.simulation().steps_done());
    const parallel::Traffic& sent = all.simulation().traffic_in_steps();
    const double messages = sum_over(MPI_COMM_WORLD, double(sent.messages)) / steps / ranks_;
    row["messages"] = messages;
    row["bytes"] = sum_over(MPI_COMM_WORLD, double(sent.bytes)) / steps / ranks_;
    row["model_error"] = traffic.error();
    Json stages = Json::object();
    for (std::size_t s = 0; s < std::size_t(Stage::count); ++s) {
      const parallel::Traffic t = all.simulation().stage_traffic()[s];
      const double messages = sum_over(MPI_COMM_WORLD, double(t.messages)) / steps / ranks_;
      if (messages > 0)
        stages[stage_names[s]] = Json::object(
            {{"messages", messages}, {"bytes", sum_over(MPI_COMM_WORLD, double(t.bytes)) / steps / ranks_}});
    }
    row["traffic"] = stages;
    return messages;
  }

  /// All ranks and the first one alone in turn; the bound of as many cores beside them.
  void time(const Study& study, Side& all, double all_cells, bool loud, Json& row) {
    std::unique_ptr<Side> one;
    if (loud && ranks_ > 1) one = std::make_unique<Side>(study, MPI_COMM_SELF, 1);
    const double cells = all_cells / ranks_;
    Bound<float> bound{std::ptrdiff_t(cells)};
    Bound<float> alone{std::ptrdiff_t(cells)};
    const int turns = options_.quick ? 1 : 9, steps = std::max(4, int((options_.quick ? 1e6 : 8e6) / cells));
    const auto together = [] { MPI_Barrier(MPI_COMM_WORLD); };
    for (int turn = 0; turn <= turns; ++turn) {
      if (turn == 1) all.forget(), bound.forget(), alone.forget();
      if (turn == 1 && one) one->forget();
      bound.sample(steps, together);
      all.take_turn(steps);
      wait_asleep();
      if (one) alone.sample(steps, [] {}), one->take_turn(steps);
      wait_asleep();
    }
    const double here = all.whole().middle(), of_all = sum_over(MPI_COMM_WORLD, bound.best().middle());
    row["seconds"] = here;
    row["bound_mlups"] = of_all;
    Json stages = Json::object();
    for (std::size_t s = 0; s < all.stages().size(); ++s)
      if (all.stages()[s] > 0) stages[stage_names[s]] = all.stages()[s] / (double(steps) * (turns + 1));
    row["stage_seconds"] = stages;
    char line[160];
    snprintf(line, sizeof line, "  %.3g ms a step", 1e3 * here);
    time_line_ = line;
    if (!one) return;
    const double work = study.strong ? ranks_ : 1;  // times as fast as one is right
    const double speed = one->whole().middle() / here / work,
                 bandwidth = of_all / ranks_ / alone.best().middle();
    row["seconds_alone"] = one->whole().middle();
    row["efficiency"] = speed;
    row["efficiency_by_bandwidth"] = speed / bandwidth;
    snprintf(line, sizeof line, "  %.3g ms a step, one alone %.3g; efficiency %.2f, by bandwidth %.2f",
             1e3 * here, 1e3 * one->whole().middle(), speed, speed / bandwidth);
    time_line_ = line;
    out_.figures["scaling." + study.key()] = speed / bandwidth;
    if (study.edge == 80 && !study.strong) out_.figures["scaling.weak." + study.scene] = speed / bandwidth;
  }

  const Options& options_;
  Figures& out_;
  int ranks_ = 1;
  bool timed_ = false;
  double worst_ = 0;
  std::string time_line_;
};

}  // namespace

void run(const Options& options) {
  require_no_others(options);
  Figures out;
  Ranks ranks(options, out);
  for (const char* scene : {"fluid", "a", "b"}) {
    ranks.run({scene, 40, false});
    if (!options.quick) ranks.run({scene, 80, false});
    ranks.run({scene, 80, true});
  }
  ranks.finish();
  if (rank_in(MPI_COMM_WORLD) == 0) out.write(options.json);
}

}  // namespace silt::bench::scaling
