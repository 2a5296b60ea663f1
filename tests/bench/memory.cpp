// Bytes a cell, everything included: by how much the resident set grows when a coupled scene is built and has
// run for some steps (6 % of the volume in spheres of 6 cells, single precision), over its cells.
//   scripts/bench memory [--quick] [--json FILE]
#include <cstdio>
#include <string>

#include "silt/simulation.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/layers.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::bench::memory {
namespace {

/// Bytes, now and at most so far (the kernel's own count).
double resident(const char* line) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == line) {
      double kib = 0;
      status >> kib;
      return 1024 * kib;
    }
  throw std::runtime_error("no /proc/self/status");
}

}  // namespace

void run(const Options& o) {
  require_no_others(o);
  const int n = o.quick ? 64 : 160;
  const Layers layers{.edge = n};
  const auto [nx, ny, nz] = layers.cells();
  const double cells = double(nx) * ny * nz, before = resident("VmRSS:");
  Simulation s = silt::testing::simulation_of(layers.text());
  for (int t = 0; t < 10; ++t) s.step();
  const double bytes = (resident("VmRSS:") - before) / cells, peak = (resident("VmHWM:") - before) / cells;
  const double populations = double(s.scene().flow->fields().bytes()) / cells;
  printf(
      "%d x %d x %d cells, %llu bodies: %.1f bytes a cell (populations %.1f, of them padding and ghosts "
      "%.1f); at most %.1f\n",
      nx, ny, nz, static_cast<unsigned long long>(s.scene().at_start.body_count), bytes, populations,
      populations - 4 * lbm::D3Q19::directions, peak);
  Figures out;
  out.figures["memory.bytes_per_cell"] = bytes;
  out.figures["memory.peak_bytes_per_cell"] = peak;
  out.figures["memory.population_bytes_per_cell"] = populations;
  out.write(o.json);
}

}  // namespace silt::bench::memory
