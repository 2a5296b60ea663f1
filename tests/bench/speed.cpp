// Ratios measured in one run on one core: the fluid kernel against the bandwidth of an in-place update of 19
// arrays of the same size, and whole coupled steps against the fluid alone. Medians of repetitions taken in
// turn.
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

#if defined(__x86_64__)
#define SILT_WIDEST __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SILT_WIDEST
#endif

SILT_WIDEST void touch(float* p, int n) {
  for (int k = 0; k < n; ++k) p[k] = p[k] * 0.999f + 1e-9f;
}
SILT_WIDEST void touch(double* p, int n) {
  for (int k = 0; k < n; ++k) p[k] = p[k] * 0.999 + 1e-9;
}

/// MLUPS an in-place update of 19 arrays of n^3 would allow, `streams` of them at a time, prefetched: the
/// bound of any in-place kernel.
template <class T>
double bandwidth_bound(std::vector<T>& data, std::size_t cells, int streams) {
  const std::size_t stride = cells + 13 * 64 / sizeof(T);
  constexpr int chunk = 128 / sizeof(T) * 4, line = 64 / sizeof(T), ahead = 2048 / sizeof(T);
  const double t = seconds([&] {
    for (int first = 0; first < 19; first += streams)
      for (std::size_t x = 0; x + chunk <= cells; x += chunk)
        for (int i = first; i < std::min(first + streams, 19); ++i) {
          T* const p = data.data() + i * stride + x;
          for (int k = 0; k < chunk; k += line) __builtin_prefetch(p + ahead + k, 1);
          touch(p, chunk);
        }
  });
  return double(cells) / t * 1e-6;
}

template <class T>
void fluid_share(const char* name, int n) {
  std::array<lbm::SideCondition, 6> periodic{};
  lbm::Fluid<T> fluid(lbm::Domain({n, n, n}, periodic, std::nullopt, 1), {0.8, 3. / 16, false, {}},
                      MPI_COMM_SELF);
  const std::size_t cells = std::size_t(n) * n * n;
  std::vector<T> streams(19 * (cells + 13 * 64 / sizeof(T)), T(0));
  std::vector<double> kernel, bound, share;
  for (int r = 0; r < repetitions; ++r) {
    bound.push_back(std::max({bandwidth_bound(streams, cells, 1), bandwidth_bound(streams, cells, 8),
                              bandwidth_bound(streams, cells, 19)}));
    constexpr int steps = 10;
    kernel.push_back(steps * double(cells) * 1e-6 / seconds([&] {
                       for (int t = 0; t < steps; ++t) fluid.stream_collide(), fluid.exchange();
                     }));
    share.push_back(kernel.back() / bound.back());
  }
  printf("fluid %s %d^3: %.0f MLUPS, in-place bound %.0f MLUPS, share %.2f\n", name, n, median(kernel),
         median(bound), median(share));
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
  fluid_share<float>("single", n);
  fluid_share<double>("double", n);
  fluid_share<float>("single", n / 2);
  for (const char* time : {"explicit", "implicit"})
    for (const char* scheme : {"bounce-back", "cli"}) {
      coupled_over_fluid("A", 16, n, scheme, time);
      coupled_over_fluid("B", 9, n, scheme, time);
    }
  MPI_Finalize();
}
