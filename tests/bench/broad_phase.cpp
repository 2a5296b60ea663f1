// Milliseconds a step of each broad phase takes, on one core, in the mean and where it searches (in the
// others it goes through the pairs it has kept): spheres that fill a fifth of a periodic box, spheres of very
// different sizes, and the bounding spheres of fibres 20 times as long as thick that fill a twentieth of it,
// so many times overlapping. Bodies move by a hundredth of their radius a step. The broad phases take their
// steps in turn, on the same positions, and must find the same number of pairs.
#include <algorithm>
#include <cstdio>
#include <numeric>
#include <random>

#include "adapters/automatic/collision_factory.hpp"
#include "tests/bench/figures.hpp"

namespace silt::bench::broad_phase {
namespace {

using namespace rigid;

struct Moving {
  const char* name;
  BodySet bodies;
  std::vector<Reach> reach;
  std::vector<Vec3> velocity;
  Extent extent;
};

/// At random, overlaps or not. Every `large_every`-th is `ratio` times as large; the others have radii 4
/// to 5.
Moving cloud(const char* name, int count, double volume_fraction, int large_every, double ratio) {
  Moving m;
  m.name = name;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<> u(0, 1);
  std::normal_distribution<> normal;
  double volume = 0;
  for (int i = 0; i < count; ++i) {
    const double radius = (4 + u(random)) * (large_every && i % large_every == 0 ? ratio : 1);
    m.reach.push_back({radius, 0.02 * radius});
    m.velocity.push_back(0.01 * radius / std::sqrt(3) * Vec3(normal(random), normal(random), normal(random)));
    volume += 4. / 3 * M_PI * radius * radius * radius;
  }
  m.extent = {Vec3::Constant(std::cbrt(volume / volume_fraction)), {true, true, true}};
  for (int i = 0; i < count; ++i) {
    BodyRecord r;
    r.id = i;
    for (double& x : r.position) x = m.extent.size[0] * u(random);
    m.bodies.add(r);
  }
  m.bodies.reindex();
  return m;
}

void move(Moving& m) {
  for (std::size_t row = 0; row < m.bodies.size(); ++row) {
    m.bodies.position[row] += m.velocity[row];
    m.extent.wrap(m.bodies.position[row], m.bodies.image[row]);
  }
}

void compare(Moving scene, Figures& out) {
  constexpr int warm_up = 2, steps = 39;  // as many as some lists of kept pairs serve
  std::vector<std::unique_ptr<BroadPhase>> all;
  for (const char* name : {"grid", "fcl", "bullet"}) all.push_back(adapters::make_broad_phase(name));
  std::vector<std::vector<double>> ms(all.size());
  std::vector<CandidatePair> pairs;
  for (int step = 0; step < warm_up + steps; ++step) {
    move(scene);
    std::size_t found = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const double t = seconds([&] { (*all[k])(scene.bodies, scene.extent, scene.reach, {}, pairs); });
      if (step >= warm_up) ms[k].push_back(1e3 * t);
      if (k > 0 && pairs.size() != found) throw std::runtime_error("the broad phases disagree");
      found = pairs.size();
    }
  }
  printf("%-22s %6zu bodies, %7zu pairs, ms a step (a search):", scene.name, scene.bodies.size(),
         pairs.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double mean = std::accumulate(ms[k].begin(), ms[k].end(), 0.0) / double(ms[k].size());
    const double search = *std::max_element(ms[k].begin(), ms[k].end());
    printf("  %s %.2f (%.2f)", std::string(all[k]->name()).c_str(), mean, search);
    out.table.push_back(Json::object({{"scene", scene.name},
                                      {"bodies", scene.bodies.size()},
                                      {"pairs", pairs.size()},
                                      {"broad_phase", all[k]->name()},
                                      {"ms_per_step", mean},
                                      {"ms_of_a_search", search}}));
  }
  printf("\n");
}

}  // namespace

void run(const Options& options) {
  require_no_others(options);
  Figures out;
  compare(cloud("a fifth full", 10000, 0.2, 0, 1), out);
  if (!options.quick) compare(cloud("a fifth full", 100000, 0.2, 0, 1), out);
  compare(cloud("one in 500 30 x larger", 10000, 0.4, 500, 30), out);
  if (!options.quick) compare(cloud("one in 500 30 x larger", 100000, 0.4, 500, 30), out);
  constexpr double aspect = 20, bounding_over_fibre = 2. / 3 * aspect * aspect;  // volumes
  compare(cloud("fibres, 20 to 1", 10000, 0.05 * bounding_over_fibre, 0, 1), out);
  out.write(options.json);
}

}  // namespace silt::bench::broad_phase
