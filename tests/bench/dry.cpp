// Dry beds on one core: a step of Silt against a step of Bullet, and how the cost of a body grows with their
// number.
//
// What makes the comparison fair:
// - The same bed, from the same start, dropped and settled by each code for itself, in one process; timed in
//   windows taken in turn, while and after the bed comes to rest. Figures are medians over the windows.
// - Overlap is measured by the same means in both: Silt's closed forms on the poses each code has at the end
//   of a window. Silt takes the fewest sweeps (of those tried, smallest first) with which neither its deepest
//   nor its mean overlap over all windows is worse than Bullet's; figures named ".deepest" ask that of the
//   deepest alone.
// - Bullet: 3.24 as Debian ships it in double precision (which rules out its SIMD rows), its default solver
//   with its default 10 iterations, warm starting and split impulse, dynamic AABB trees. It gets large enough
//   pools, sizes it is tuned for (about 1 m), and boxes as walls (planes would be candidates of every body).
//   Its bodies are never deactivated.
// - Not the same: Bullet meets its 10 iterations in one order of contacts (Gauss-Seidel); Silt's sweeps give
//   the same bits in any order and on any number of ranks.
#include <cstdio>

#include "tests/bench/figures.hpp"
#include "tests/bench/silt_world.hpp"

namespace silt::bench::dry {
namespace {

constexpr double dt = 1e-3;  // s

struct Plan {
  int drop;            // steps before the first window
  int windows, steps;  // of a window
};

/// The record of one code in its windows.
struct Record {
  std::vector<double> ms;  // a step, by window
  double contacts = 0;     // a step, mean
  Overlap overlap;         // the deepest, and the mean over windows
  rigid::RigidClock::Seconds stages{};

  void add_overlap(const Overlap& o, int windows) {
    overlap.deepest = std::max(overlap.deepest, o.deepest);
    overlap.mean += o.mean / windows;
  }
};

void run_window(SiltWorld& world, const Plan& plan, Record& record) {
  const auto before = world.seconds();
  const double share = 1.0 / (plan.steps * plan.windows);
  record.ms.push_back(1e3 / plan.steps * seconds([&] {
                        for (int i = 0; i < plan.steps; ++i)
                          record.contacts += share * double(world.step(dt).resolver.contacts);
                      }));
  for (std::size_t k = 0; k < before.size(); ++k)
    record.stages[k] += share * (world.seconds()[k] - before[k]);
}

void run_window(BulletWorld& world, const Plan& plan, Record& record) {
  record.ms.push_back(1e3 / plan.steps * seconds([&] {
                        for (int i = 0; i < plan.steps; ++i) world.step(dt);
                      }));
  record.contacts += double(world.contacts()) / plan.windows;
}

template <class World>
void drop(World& world, const Plan& plan) {
  for (int i = 0; i < plan.drop; ++i) world.step(dt);
}

/// Both codes from the start to the end of the last window.
std::pair<Record, Record> side_by_side(const Bed& bed, const Plan& plan, int sweeps) {
  SiltWorld silt(bed, sweeps);
  BulletWorld bullet(bed);
  MeasureOverlap overlap(bed);
  Record ours, theirs;
  drop(silt, plan);
  drop(bullet, plan);
  for (int w = 0; w < plan.windows; ++w) {
    run_window(silt, plan, ours);
    run_window(bullet, plan, theirs);
    ours.add_overlap(overlap(silt.poses()), plan.windows);
    theirs.add_overlap(overlap(bullet.poses()), plan.windows);
  }
  return {ours, theirs};
}

/// The overlap alone, in the same steps.
template <class World>
Overlap overlap_of(World world, const Bed& bed, const Plan& plan) {
  MeasureOverlap measure(bed);
  Record record;
  drop(world, plan);
  for (int w = 0; w < plan.windows; ++w) {
    for (int i = 0; i < plan.steps; ++i) world.step(dt);
    record.add_overlap(measure(world.poses()), plan.windows);
  }
  return record.overlap;
}

/// The overlap that is not to be worse than Bullet's.
enum class By { deepest_and_mean, deepest };

bool no_worse(const Overlap& a, const Overlap& b, By by) {
  return a.deepest <= b.deepest && (by == By::deepest || a.mean <= b.mean);
}

int fewest_sweeps(const char* name, const Bed& bed, const Plan& plan, By by) {
  const Overlap theirs = overlap_of(BulletWorld(bed), bed, plan);
  printf("%s: overlap of Bullet: deepest %.2e m, mean %.2e m\n", name, theirs.deepest, theirs.mean);
  constexpr int tried[] = {1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 16, 24, 32};
  for (const int sweeps : tried) {
    const Overlap ours = overlap_of(SiltWorld(bed, sweeps), bed, plan);
    printf("%s: overlap with %d sweeps: deepest %.2e m, mean %.2e m\n", name, sweeps, ours.deepest,
           ours.mean);
    if (no_worse(ours, theirs, by)) return sweeps;
  }
  throw std::runtime_error(std::string(name) + ": no number of sweeps reaches Bullet's overlap");
}

void against_bullet(const char* name, const Bed& bed, const Plan& plan, int sweeps, By by, Figures& out) {
  const auto [ours, theirs] = side_by_side(bed, plan, sweeps);
  std::vector<double> ratios;
  for (int w = 0; w < plan.windows; ++w) ratios.push_back(ours.ms[w] / theirs.ms[w]);
  const double ratio = median(ratios);
  out.figures[std::string("dry.") + name + ".over_bullet" + (by == By::deepest ? ".deepest" : "")] = ratio;

  const auto row = [&](const char* code, const Record& r, int iterations) {
    const double ms = median(r.ms), rate = r.contacts / ms * 1e-3;
    printf(
        "%-8s %-7s %6zu bodies %8.2f ms a step %8.0f contacts %6.2f M contacts/s  overlap %.2e m, mean %.2e m"
        "  iterations %d\n",
        name, code, bed.bodies.size(), ms, r.contacts, rate, r.overlap.deepest, r.overlap.mean, iterations);
    out.table.push_back(Json::object({{"scene", name},
                                      {"code", code},
                                      {"bodies", bed.bodies.size()},
                                      {"ms_per_step", ms},
                                      {"contacts", r.contacts},
                                      {"million_contacts_per_second", rate},
                                      {"deepest_overlap", r.overlap.deepest},
                                      {"mean_overlap", r.overlap.mean},
                                      {"iterations", iterations}}));
  };
  row("silt", ours, sweeps);
  row("bullet", theirs, 10);
  const auto ms = [&](rigid::RigidStage stage) { return 1e3 * ours.stages[int(stage)]; };
  using enum rigid::RigidStage;
  printf(
      "%-8s silt/bullet %.2f (%.2f to %.2f); silt's ms: integrate %.2f, collision detection %.2f, contact "
      "response %.2f, synchronisation %.2f\n",
      name, ratio, *std::min_element(ratios.begin(), ratios.end()),
      *std::max_element(ratios.begin(), ratios.end()), ms(integrate), ms(collision_detection),
      ms(contact_response), ms(synchronisation));
  if (!no_worse(ours.overlap, theirs.overlap, by)) printf("%-8s OVERLAP IS WORSE THAN BULLET'S\n", name);
}

/// Microseconds a body and step in beds of ten layers, all of them kept at hand and timed in turn.
void cost_growth(const std::vector<int>& counts, int settle, int sweeps, Figures& out) {
  constexpr int layers = 10, rounds = 5;
  constexpr double coarse_dt = 4e-3;  // s, to settle in fewer steps
  std::vector<std::unique_ptr<SiltWorld>> worlds;
  for (const int count : counts) {
    const Bed bed = loose_spheres(count, int(std::lround(std::sqrt(count / double(layers)))), 0.005, 0.03);
    worlds.push_back(std::make_unique<SiltWorld>(bed, sweeps));
    for (int i = 0; i < settle; ++i) worlds.back()->step(coarse_dt);
    for (int i = 0; i < 20; ++i) worlds.back()->step(dt);
  }
  std::vector<std::vector<double>> cost(counts.size());
  std::vector<double> contacts(counts.size());
  for (int r = 0; r < rounds; ++r)
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const int steps = std::max(2, 50000 / counts[k]);
      cost[k].push_back(1e6 / (double(steps) * counts[k]) * seconds([&] {
                          for (int i = 0; i < steps; ++i)
                            contacts[k] = double(worlds[k]->step(dt).resolver.contacts);
                        }));
    }
  for (std::size_t k = 0; k < counts.size(); ++k) {
    printf("cost     %6d spheres %6.2f us a body and step, %.2f contacts a body\n", counts[k],
           median(cost[k]), contacts[k] / counts[k]);
    out.table.push_back(Json::object({{"scene", "cost"},
                                      {"bodies", counts[k]},
                                      {"us_per_body_and_step", median(cost[k])},
                                      {"contacts", contacts[k]}}));
  }
  std::vector<double> growth;
  const std::size_t from = std::find(counts.begin(), counts.end(), 10000) - counts.begin();
  for (int r = 0; r < rounds; ++r) growth.push_back(cost.back()[r] / cost[from][r]);
  printf("cost     a body at %d over one at 10000: %.2f\n", counts.back(), median(growth));
  if (counts.back() == 100000) out.figures["dry.cost_growth"] = median(growth);
}

/// Sweeps that overlap no more than Bullet (found by --scan; the run says if that is so no longer). Bullet
/// rounds its cylinders, so that one would do for them: they get as many as boxes.
struct Sweeps {
  int spheres = 5, boxes = 5, cylinders = 5;
  int spheres_deepest = 4, boxes_deepest = 2;
};

}  // namespace

void run(const Options& o) {
  const bool scan = o.others == std::vector<std::string>{"--scan"};
  if (!scan && !o.others.empty())
    throw std::invalid_argument("unknown option " + o.others[0] +
                                "; known: --quick, --json FILE, and --scan, which "
                                "looks for the fewest sweeps that overlap no more than Bullet");
  Sweeps sweeps;
  const Bed spheres = loose_spheres(o.quick ? 2000 : 10000, o.quick ? 12 : 22, 0.04, 0.06);
  const Bed boxes = loose_boxes(o.quick ? 400 : 2000, o.quick ? 9 : 20);
  const Bed cylinders = loose_cylinders(o.quick ? 400 : 2000, o.quick ? 9 : 20);
  const Plan sphere_plan{o.quick ? 400 : 700, o.quick ? 5 : 11, 10},
      box_plan{o.quick ? 400 : 500, o.quick ? 5 : 11, 10},
      cylinder_plan{o.quick ? 400 : 1000, o.quick ? 5 : 11, 10};
  if (scan) {
    sweeps.spheres = fewest_sweeps("spheres", spheres, sphere_plan, By::deepest_and_mean);
    sweeps.boxes = fewest_sweeps("boxes", boxes, box_plan, By::deepest_and_mean);
    sweeps.spheres_deepest = fewest_sweeps("spheres", spheres, sphere_plan, By::deepest);
    sweeps.boxes_deepest = fewest_sweeps("boxes", boxes, box_plan, By::deepest);
  }
  Figures out;
  against_bullet("spheres", spheres, sphere_plan, sweeps.spheres, By::deepest_and_mean, out);
  against_bullet("boxes", boxes, box_plan, sweeps.boxes, By::deepest_and_mean, out);
  against_bullet("cylinders", cylinders, cylinder_plan, sweeps.cylinders, By::deepest_and_mean, out);
  against_bullet("spheres", spheres, sphere_plan, sweeps.spheres_deepest, By::deepest, out);
  against_bullet("boxes", boxes, box_plan, sweeps.boxes_deepest, By::deepest, out);
  const std::vector<int> counts =
      o.quick ? std::vector{1000, 3000, 10000} : std::vector{1000, 3000, 10000, 30000, 100000};
  cost_growth(counts, 150, sweeps.spheres, out);
  out.write(o.json);
}

}  // namespace silt::bench::dry
