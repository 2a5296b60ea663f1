// Whole coupled steps against the fluid's passes in them, on one core: medians of repetitions. The fluid
// itself: fluid.cpp.
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "coupler/case_file.hpp"
#include "coupler/simulation.hpp"
#include "lbm/fluid.hpp"

using namespace silt;

namespace {

constexpr int repetitions = 5;

double seconds(auto&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}
double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

/// Layers of spheres of 6 cells, moving at 0.01: case A (6 % solid, spacing 16) and case B (19 %, spacing 9).
std::string spheres(int spacing, int n, const char* scheme, const char* time) {
  std::string text = R"(
title = "bench"
[units]
system = "lattice"
[domain]
size = [)" + std::to_string(n) +
                     ", " + std::to_string(n) + ", " + std::to_string(n) + R"(]
boundary = "periodic"
[fluid]
relaxation_time = 1.2
[coupling]
wall_scheme = ")" + scheme +
                     "\"\ntime = \"" + time + R"("
[[shapes]]
name = "sphere"
type = "sphere"
diameter = 6
[[bodies]]
shape = "sphere"
density = 1.2
velocity = [0.006, 0.005, 0.0062]
positions = [)";
  unsigned random = 1;
  const auto shift = [&] {
    return random = random * 1664525u + 1013904223u, (random >> 8) / double(1 << 24);
  };
  for (double z = 4; z + 3.5 < n; z += 7)
    for (double y = spacing / 2.0; y + spacing / 2.0 <= n; y += spacing)
      for (double x = spacing / 2.0; x + spacing / 2.0 <= n; x += spacing)
        text += "[" + std::to_string(x + shift()) + ", " + std::to_string(y + shift()) + ", " +
                std::to_string(z + 0.5 * shift()) + "], ";
  return text + "]\n[run]\nsteps = 1000\n";
}

void coupled_over_fluid(const char* name, int spacing, int n, const char* scheme, const char* time) {
  coupler::Simulation s(coupler::read_case_text(spheres(spacing, n, scheme, time), name), MPI_COMM_SELF);
  for (int t = 0; t < 4; ++t) s.step();
  std::vector<double> ratio;
  const double cells = double(n) * n * n;
  double solid = 1 - double(s.look_at_flow().fluid_cells) / cells;
  for (int r = 0; r < repetitions; ++r) {
    const auto before = s.stage_seconds();
    for (int t = 0; t < 10; ++t) s.step();
    const auto after = s.stage_seconds();
    double all = 0;
    for (std::size_t k = 0; k < after.size(); ++k) all += after[k] - before[k];
    const auto stage = [&](coupler::Stage k) { return after[int(k)] - before[int(k)]; };
    ratio.push_back(all / (stage(coupler::Stage::stream_collide) + stage(coupler::Stage::lbm_communication)));
  }
  printf("coupled case %s (%.1f %% solid, %.2f links a cell) %s %s: %.2f of the fluid's passes\n", name,
         100 * solid, double(s.links()) / cells, scheme, time, median(ratio));
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const int n = argc > 1 ? std::stoi(argv[1]) : 160;
  printf("instruction set %s\n", lbm::instruction_set());
  for (const char* time : {"explicit", "implicit"})
    for (const char* scheme : {"bounce-back", "cli"}) {
      coupled_over_fluid("A", 16, n, scheme, time);
      coupled_over_fluid("B", 9, n, scheme, time);
    }
  MPI_Finalize();
}
