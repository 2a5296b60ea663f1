// Bytes a cell, everything included: by how much the resident set grows when a coupled scene is built and has
// run for some steps (6 % of the volume in spheres of 6 cells, single precision), over its cells.
//   scripts/bench memory [--quick] [--json FILE]
#include <mpi.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "coupler/case_file.hpp"
#include "coupler/simulation.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/layers_of_spheres.hpp"

namespace silt::bench {
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

void run(const Options& o) {
  require_no_others(o);
  const int n = o.quick ? 64 : 160;
  const double cells = double(n) * n * n, before = resident("VmRSS:");
  coupler::Simulation s(coupler::read_case_text(layers_of_spheres(16, n, "cli", "implicit"), "memory"),
                        MPI_COMM_SELF);
  for (int t = 0; t < 10; ++t) s.step();
  const double bytes = (resident("VmRSS:") - before) / cells, peak = (resident("VmHWM:") - before) / cells;
  const double populations = double(s.scene().flow->bytes()) / cells;
  printf(
      "%d^3 cells, %llu bodies: %.1f bytes a cell (populations %.1f, of them padding and ghosts %.1f); at "
      "most %.1f\n",
      n, static_cast<unsigned long long>(s.scene().body_count), bytes, populations,
      populations - 4 * lbm::directions, peak);
  Figures out;
  out.figures["memory.bytes_per_cell"] = bytes;
  out.figures["memory.peak_bytes_per_cell"] = peak;
  out.figures["memory.population_bytes_per_cell"] = populations;
  out.write(o.json);
}

}  // namespace
}  // namespace silt::bench

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int code = 0;
  try {
    silt::bench::run(silt::bench::options_of(argc, argv));
  } catch (const std::exception& e) {
    fprintf(stderr, "%s\n", e.what());
    code = 2;
  }
  MPI_Finalize();
  return code;
}
