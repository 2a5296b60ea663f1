// Nanoseconds a pair of shapes costs, and how often the answer was another method's: every backend,
// overlapping (1 % of the size) and apart (0.1 cells). Prints; gates nothing.
// --table N prints instead the table of docs/measurements.md: N random pairs in each of the bands of the
// conformance suite, with the worst gap against the reference.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "adapters/automatic/collision_factory.hpp"
#include "tests/adapters/collision_scenes.hpp"
#include "tests/bench/figures.hpp"

namespace silt::bench::collision_pairs {
namespace {

using namespace tests;

template <class Use>
void for_each_pair(Use use) {
  const auto kinds = all_kinds();
  for (std::size_t a = 0; a + 1 < kinds.size(); ++a)
    for (std::size_t b = a; b < kinds.size(); ++b) use(kinds[a], kinds[b]);
}

/// The work of a backend on the scenes of one pair of kinds.
struct Row {
  double ns_shallow = 0, ns_deep = 0, worst = 0;
  int fallbacks = 0, asked = 0;
};

double nanoseconds(rigid::CollisionBackend& backend, const Pair& pair) {
  constexpr int times = 20;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < times; ++i) collide(backend, pair);  // a virtual call, which nothing optimises away
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / times;
}

Row measure(std::string_view name, Kind a, Kind b) {
  auto backend = adapters::make_backend(name), timed = adapters::make_backend(name);
  Row row;
  int shallow = 0;
  for (const tests::Scene& s : random_scenes()) {
    if (s.a != a || s.b != b) continue;
    const auto before = backend->counters().fallbacks;
    row.worst = std::max(row.worst, std::abs(deepest(collide(*backend, s.pair)).gap - s.reference.gap));
    row.fallbacks += backend->counters().fallbacks > before;
    ++row.asked;
    const bool deep = s.band[0] == 'd';
    shallow += !deep;
    (deep ? row.ns_deep : row.ns_shallow) += nanoseconds(*timed, s.pair);
  }
  row.ns_shallow /= shallow;
  row.ns_deep /= row.asked - shallow;
  return row;
}

void print_table() {
  std::printf(
      "| pair | N | auto ns | fallb. | error | bullet ns | fallb. | error | fcl ns | fallb. | error |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for_each_pair([](Kind a, Kind b) {
    std::printf("| %s–%s |", std::string(a).c_str(), std::string(b).c_str());
    for (const char* name : {"auto", "bullet", "fcl"}) {
      const Row r = measure(name, a, b);
      if (!std::strcmp(name, "auto")) std::printf(" %d |", r.asked);
      std::printf(" %.0f / %.0f | %d | %.0e |", r.ns_shallow, r.ns_deep, r.fallbacks, r.worst);
    }
    std::printf("\n");
  });
}

}  // namespace

void run(const Options& options) {
  if (options.others.size() != 1) throw std::invalid_argument("usage: benchmarks collision_pairs N");
  setenv("SILT_SCENES", options.others[0].c_str(), 1);
  print_table();
}

}  // namespace silt::bench::collision_pairs
