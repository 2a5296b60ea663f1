// Instructions a cell of the dense kernel, a link of a coupled step and a pair of cylinders take (256-bit
// build): what a change costs, without a clock. tests/bench/instructions.py compares them with those on
// record.
//   scripts/bench instructions [--json FILE]
#include <algorithm>
#include <cstdio>
#include <random>
#include <string>

#include "lbm/fluid.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/simulation.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/instruction_count.hpp"
#include "tests/bench/layers.hpp"
#include "tests/bench/periodic_box.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::bench::instructions {
namespace {

const lbm::Int3 box = Layers{}.cells();
const double cells = double(box.x) * box.y * box.z;
constexpr int kernel_steps = 2, steps = 9;  // bodies are mapped in one of them, under `bounce-back` in three

template <class T>
void count_kernel(const std::string& name, const std::array<double, 3>& force) {
  auto fluid = periodic_box<T>(box, {0.8, 1. / 6, lbm::Collision::trt, force});
  count_piece(name, [&] { step(fluid, kernel_steps); });
}

void count_step(const std::string& name, Simulation& s) {
  for (int t = 0; t < 2 * steps; ++t) s.step();
  count_piece(name, [&] {
    for (int t = 0; t < steps; ++t) s.step();
  });
}

Simulation scene(const std::string& scheme, const std::string& time) {
  return silt::testing::simulation_of(Layers{.scheme = scheme, .time = time}.text());
}

constexpr std::pair<const char*, const char*> couplings[] = {{"bounce-back", "explicit"},
                                                             {"cli", "explicit"},
                                                             {"cli", "implicit"},
                                                             {"parabolic", "implicit"},
                                                             {"multireflection", "implicit"}};

/// Cylinders turned anyhow, 1e-3 of a cell apart.
struct NearPair {
  rigid::Pose a, b;
};
constexpr int near_pairs = 64;
const rigid::ConvexShape cylinder = rigid::Cylinder{3, 4};

std::vector<NearPair> make_near_pairs() {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto turn = [&] {
    return rigid::Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
  };
  rigid::AnalyticBackend backend;
  std::vector<NearPair> pairs;
  while (pairs.size() < near_pairs) {
    NearPair p{{rigid::Vec3::Zero(), turn()}, {12 * (turn() * rigid::Vec3::UnitZ()), turn()}};
    std::vector<rigid::ContactPoint> points;
    backend.collide(cylinder, p.a, cylinder, p.b, 12, points);
    const auto nearest = std::min_element(points.begin(), points.end(),
                                          [](const auto& x, const auto& y) { return x.gap < y.gap; });
    p.b.position -= (nearest->gap - 1e-3) * nearest->normal;
    pairs.push_back(p);
  }
  return pairs;
}

void count_pairs() {
  const std::vector<NearPair> pairs = make_near_pairs();
  rigid::AnalyticBackend backend;
  std::vector<rigid::ContactPoint> points;
  count_piece("pairs.cylinders", [&] {
    for (const NearPair& p : pairs) {
      points.clear();
      backend.collide(cylinder, p.a, cylinder, p.b, 0.1, points);
    }
  });
}

void pieces() {
  count_pairs();
  count_kernel<float>("cell.single", {});
  count_kernel<float>("cell.single.force", {1e-6, 0, 0});
  count_kernel<double>("cell.double", {});
  for (const auto& [scheme, time] : couplings) {
    Simulation s = scene(scheme, time);
    count_step(std::string("step.") + scheme + "." + time, s);
  }
}

}  // namespace

void run(const Options& o) {
  if (o.others == std::vector<std::string>{"--pieces"}) return pieces();
  require_no_others(o);
  const auto counts = count_instructions("instructions --pieces");
  Figures out;
  const auto add = [&](const std::string& key, double value) {
    printf("%-32s %8.2f\n", key.c_str(), value);
    out.figures["instructions." + key] = value;
  };
  for (const std::string name : {"cell.single", "cell.single.force", "cell.double"})
    add(name, counts.at(name) / (kernel_steps * cells));
  add("pair.cylinders", counts.at("pairs.cylinders") / near_pairs);
  for (const auto& [scheme, time] : couplings) {
    Simulation s = scene(scheme, time);
    const std::string key = std::string(scheme) + "." + time;
    const double fluid = counts.at("cell.single.force") / kernel_steps;
    add("link." + key, (counts.at("step." + key) / steps - fluid) / double(s.links()));
  }
  out.write(o.json);
}

}  // namespace silt::bench::instructions
