// Nanoseconds a pair of shapes costs, and how often the answer was another method's: every backend,
// overlapping (1 % of the size) and apart (0.1 cells). Prints; gates nothing.
#include <benchmark/benchmark.h>

#include "adapters/automatic/collision_factory.hpp"
#include "tests/adapters/pair_scenes.hpp"

namespace silt::tests {
namespace {

void collide_pairs(benchmark::State& state, std::string backend_name, Kind a, Kind b, double gap) {
  std::mt19937_64 random(1);
  std::vector<Pair> pairs;
  for (int i = 0; i < 64; ++i) pairs.push_back(random_pair(a, b, gap, random));
  auto backend = adapters::make_backend(backend_name);
  std::vector<rigid::ContactPoint> points;
  for (auto _ : state) {
    for (const Pair& p : pairs) {
      points.clear();
      backend->collide(p.a, p.pose_a, p.b, p.pose_b, 0.5, points);
      benchmark::DoNotOptimize(points.data());
    }
  }
  const double queries = double(backend->counters().queries);
  state.counters["ns_pair"] =
      benchmark::Counter(queries * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["fallbacks_percent"] = 100 * double(backend->counters().fallbacks) / queries;
}

void register_all() {
  constexpr std::pair<Kind, Kind> pairs[] = {
      {Kind::sphere, Kind::sphere},     {Kind::sphere, Kind::box},     {Kind::sphere, Kind::capsule},
      {Kind::box, Kind::box},           {Kind::capsule, Kind::box},    {Kind::capsule, Kind::capsule},
      {Kind::sphere, Kind::half_space}, {Kind::box, Kind::half_space}, {Kind::capsule, Kind::half_space}};
  for (const auto& [a, b] : pairs)
    for (const auto& [what, gap] : {std::pair("overlap", -0.1), std::pair("gap", 0.1)})
      for (const auto backend : adapters::backend_names()) {
        const std::string name = kind_name(a) + "." + kind_name(b) + "." + what + "." + std::string(backend);
        benchmark::RegisterBenchmark(name.c_str(), collide_pairs, std::string(backend), a, b, gap);
      }
}

}  // namespace
}  // namespace silt::tests

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  silt::tests::register_all();
  benchmark::RunSpecifiedBenchmarks();
}
