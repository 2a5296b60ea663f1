// The temperature on any number of ranks: in cells of several levels, what passes a border, how exactly, and
// that no heat is lost; in cells of one width the same bits for every cut into blocks.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "lbm/blocks/equal_cut.hpp"
#include "tests/lbm/bent_levels.hpp"
#include "tests/lbm/heat/stirred_heat.hpp"
#include "tests/lbm/levelled_cut.hpp"
#include "tests/odd_cut.hpp"
#include "tests/world.hpp"

namespace silt::lbm::testing {
namespace {

using tests::ranks;

constexpr Int3 cells{64, 64, 64};

CutTree bent_tree(int coarser, int ranks, int shift = 0) {
  return LevelledCut(
             cells, 8,
             [&](Int3 x) {
               return bent({(x.x + shift) % 64, (x.y + 2 * shift) % 64, x.z}, coarser);
             },
             ranks, 24, [&](Int3 x) { return (x.x / 8 + x.z / 16) % ranks; })
      .tree();
}

/// Sets a temperature with its flux, steady in fluid at rest: t(middle), gradient per finest cell.
template <class T, class Heat>
void set_heat(LevelledFlow<T>& flow, Heat&& t, const Vector& gradient = {}) {
  flow.for_all([&](Fluid<T>& fluid, int b, Int3 x, const Vector& at, int level) {
    Temperature<T>& heat = *flow.levels.heat(level);
    heat.set(b, x, t(at), fluid.velocity(fluid.moments(b, x)));
    const double lag = (0.5 + heat.spec().excess()) * (1 << level);
    for (int i = 0; i < D3Q7::directions; ++i)
      for (int d = 0; d < 3; ++d) heat.arriving(b, x, i) -= T(D3Q7::w(i) * lag * D3Q7::c[i][d] * gradient[d]);
  });
}

/// Calls f(temperature, middle, volume in finest cells).
template <class T, class F>
void for_temperatures(LevelledFlow<T>& flow, F&& f) {
  flow.for_all([&](Fluid<T>&, int b, Int3 x, const Vector& at, int level) {
    f(flow.levels.heat(level)->at(b, x), at, double(1 << 3 * level));
  });
}

template <class T>
double heat_of(LevelledFlow<T>& flow) {
  double mine = 0, all = 0;
  for_temperatures(flow, [&](double t, const Vector&, double volume) { mine += t * volume; });
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, flow.finest.comm());
  return all;
}

double some_heat(const Vector& x) {
  return 2 + std::sin(0.3 * x[0] + 0.2 * x[1]) * std::cos(0.4 * x[2]);
}

TEST(HeatOfLevels, IsConserved) {
  for (const int coarser : {1, 2})
    for (const bool walls : {false, true}) {
      Sides sides = all({SideKind::bounce});
      sides[2] = sides[3] = {SideKind::free_slip};
      if (!walls) sides = {};
      const HeatSpec heat{0.05, {0, 0, 1e-5}};
      LevelledFlow<double> flow(bent_tree(coarser, ranks()), sides, {0.8}, coarser, MPI_COMM_WORLD,
                                Device::cpu, &heat, sides);
      stir(flow, cells);
      set_heat(flow, some_heat);
      const double before = heat_of(flow);
      flow.step(40);
      EXPECT_NEAR(heat_of(flow) / before, 1, 1e-13) << coarser << " " << walls;
    }
}

/// Refined cells get what the coarse one held, coarsened ones the mean.
TEST(HeatOfLevels, IsConservedWhereLevelsChange) {
  const HeatSpec heat{0.05};
  const auto made = [&](int shift) {
    return std::make_unique<LevelledFlow<double>>(bent_tree(2, ranks(), shift), Sides{}, CollisionSpec{0.8},
                                                  2, MPI_COMM_WORLD, Device::cpu, &heat);
  };
  auto flow = made(0);
  stir(*flow, cells);
  set_heat(*flow, some_heat);
  const double before = heat_of(*flow);
  for (const int shift : {16, 32, 48}) {
    auto next = made(shift);
    move_populations(flow->levels, next->levels);
    flow = std::move(next);
    flow->step(4);
  }
  EXPECT_NEAR(heat_of(*flow) / before, 1, 1e-13);
}

/// Heat that is conducted between two sides: a linear temperature stays as it is, also where levels change.
TEST(HeatOfLevels, ConductionPassesABorderExactly) {
  Sides sides = all({SideKind::bounce});
  sides[4].kind = sides[5].kind = SideKind::temperature;
  sides[4].value = 1, sides[5].value = 3;
  const HeatSpec heat{0.07};
  const auto made = [&](int shift) {
    return std::make_unique<LevelledFlow<double>>(bent_tree(2, ranks(), shift), all({SideKind::bounce}),
                                                  CollisionSpec{0.8}, 2, MPI_COMM_WORLD, Device::cpu, &heat,
                                                  sides);
  };
  auto flow = made(0);
  const auto linear = [](const Vector& x) { return 1 + 2 * x[2] / cells.z; };
  set_heat(*flow, linear, {0, 0, 2. / cells.z});
  for (const int shift : {16, 32}) {
    flow->step(12);
    auto next = made(shift);
    move_populations(flow->levels, next->levels);
    flow = std::move(next);
  }
  flow->step(12);
  double off = 0;
  for_temperatures(*flow,
                   [&](double t, const Vector& x, double) { off = std::max(off, std::abs(t - linear(x))); });
  EXPECT_LT(tests::largest_of_ranks(off), 1e-12);
}

/// Fine cells in the lower half of x, coarse ones in the upper.
CutTree slabs(Int3 n) {
  return LevelledCut(
             n, 8, [&](Int3 x) { return x.x < n.x / 2 ? 0 : 1; }, ranks(), 8)
      .tree();
}

/// Returns the error of the decay of a wave through slabs, in fluid at rest, relative to D.
double decay_error(int length) {
  const Int3 n{length, 8, 8};
  const HeatSpec heat{0.1};
  LevelledFlow<double> flow(slabs(n), {}, {1.0}, 1, MPI_COMM_WORLD, Device::cpu, &heat);
  const double k = 2 * std::numbers::pi / length;
  set_heat(flow, [&](const Vector& x) { return std::cos(k * x[0]); });
  const auto amplitude = [&] {
    std::complex<double> mine = 0, all = 0;
    for_temperatures(flow, [&](double t, const Vector& x, double volume) {
      mine += t * volume * std::polar(1.0, -k * x[0]);
    });
    MPI_Allreduce(&mine, &all, 2, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    return std::abs(all);
  };
  const int first = length * length / 32, steps = length * length / 8;
  flow.step(first);
  const double before = amplitude();
  flow.step(steps);
  return std::log(before / amplitude()) / (steps * heat.diffusivity * k * k) - 1;
}

TEST(HeatOfLevels, WavesDecayByTheDiffusivityToSecondOrder) {
  const double coarse = decay_error(32), fine = decay_error(64);
  printf("errors of the diffusivity: %.5f, %.5f\n", coarse, fine);
  EXPECT_LT(std::abs(fine), 2e-4);
  EXPECT_GT(std::abs(coarse / fine), 3);
}

/// A stream carries a wave once around a periodic box, from coarse cells (32 to a wave, cell Péclet number 8)
/// to fine ones and back.
TEST(HeatOfLevels, AStreamCarriesAWaveThroughABorder) {
  const Int3 n{64, 8, 8};
  const HeatSpec heat{0.02};
  const Vector u{0.08, 0, 0};
  LevelledFlow<double> flow(slabs(n), {}, {1.0}, 1, MPI_COMM_WORLD, Device::cpu, &heat);
  const double k = 2 * std::numbers::pi / n.x;
  flow.set([&](const Vector&, double&, Vector& v, auto&) { v = u; });
  set_heat(flow, [&](const Vector& x) { return std::cos(k * x[0]); });
  const int steps = 800;  // once around
  flow.step(steps);
  const double left = std::exp(-heat.diffusivity * k * k * steps);
  double off = 0;
  for_temperatures(flow, [&](double t, const Vector& x, double) {
    off = std::max(off, std::abs(t - left * std::cos(k * (x[0] - u[0] * steps))));
  });
  off = tests::largest_of_ranks(off);
  printf("largest error of a wave of amplitude %.3f: %.5f\n", left, off);
  EXPECT_LT(off, 0.02);
}

/// Fluid that is as warm everywhere falls as under a body force.
TEST(HeatOfLevels, BuoyancyIsThatOfAllLevels) {
  const Vector force{1e-9, 2e-9, -3e-9};  // so small that stresses do not matter
  const double t = 5;
  const HeatSpec heat{0.1, {force[0] / t, force[1] / t, force[2] / t}};
  LevelledFlow<double> flow(slabs({64, 8, 8}), {}, {0.7}, 1, MPI_COMM_WORLD, Device::cpu, &heat);
  set_heat(flow, [&](const Vector&) { return t; });
  const auto of_level = [&](int level, double share) {
    Vector f = force;
    for (double& its : f) its *= share * (1 << level);
    return f;
  };
  flow.for_all([&](Fluid<double>& fluid, int b, Int3 x, const Vector&, int level) {  // at rest
    for (int i = 0; i < D3Q19::directions; ++i) fluid.arriving(b, x, i) = -half_push(of_level(level, 1), i);
  });
  constexpr int steps = 40;
  flow.step(steps);
  double off = 0;
  flow.for_all([&](Fluid<double>& fluid, int b, Int3 x, const Vector&, int level) {
    const Moments m = fluid.moments(b, x);
    for (int d = 0; d < 3; ++d)
      off = std::max(off, std::abs(m.momentum[d] + of_level(level, 0.5)[d] - steps * force[d]));
  });
  EXPECT_LT(tests::largest_of_ranks(off), 1e-6 * steps * force[0]);
}

template <class T>
std::uint64_t warm_fingerprint(int ranks, MPI_Comm comm, Device device) {
  const HeatSpec heat{0.05, {0, 0, 1e-4}};
  Sides sides = all({SideKind::bounce}), warm = sides;
  warm[0].kind = SideKind::temperature, warm[0].value = 1;
  warm[5] = heat_side(5, 0.01);
  LevelledFlow<T> flow(bent_tree(2, ranks), sides, {0.6}, 2, comm, device, &heat, warm);
  stir(flow, cells);
  set_heat(flow, some_heat);
  flow.step(12);
  Fingerprint hash;
  for_temperatures(flow, [&](double t, const Vector& x, double) { hash.add(t, x); });
  return flow.fingerprint() ^ hash.over(comm);
}

TEST(HeatOfLevels, IsTheSameOnAnyRanksAndDevice) {
  const std::uint64_t alone =
      tests::alone([] { return warm_fingerprint<float>(1, MPI_COMM_SELF, Device::cpu); });
  EXPECT_EQ(alone, warm_fingerprint<float>(ranks(), MPI_COMM_WORLD, Device::cpu));
  EXPECT_EQ(alone, warm_fingerprint<float>(ranks(), MPI_COMM_WORLD, Device::host));
}

// ---- cells of one width ----

template <class T>
std::uint64_t stirred_heat(const CutTree& tree, bool periodic_rows, MPI_Comm comm, int ranks, bool in_parts) {
  SideCondition across = periodic_rows ? periodic : no_slip, warm{SideKind::temperature},
                open{SideKind::open};
  warm.value = 2;
  Fluid<T> fluid(Domain(tree, {across, across, periodic, periodic, no_slip, no_slip}, ranks),
                 {0.6, 3. / 16, Collision::trt, {1e-5, 2e-5, 0}}, comm);
  const SideCondition low = periodic_rows ? periodic : heat_side(0, 0.01),
                      high = periodic_rows ? periodic : open;
  Temperature<T> heat(fluid, {0.03, {0, 0, 1e-4}}, {low, high, periodic, periodic, warm, heat_side(5)});
  set(
      fluid, heat, [](Int3 g) { return std::sin(g.x + 2. * g.y + g.z); },
      [](Int3 g) {
        return Vector{0.02 * std::sin(3. * g.z), 0.01, 0.01 * std::cos(2. * g.x)};
      });
  for (int t = 0; t < 21; ++t) {
    if (in_parts) {
      fluid.begin_pass();
      for (int b = 0; b < int(fluid.blocks().size()); ++b)
        for (int part = 0; part < fluid.parts(b); ++part) fluid.collide(b, part);
      fluid.end_pass();
      fluid.exchange();
    } else {
      step(fluid);
    }
  }
  Fingerprint hash;
  for_all_cells(fluid, [&](int b, Int3 x, Int3 g) {
    for (int i = 0; i < D3Q7::directions; ++i) hash.add(double(heat.arriving(b, x, i)), g, i);
  });
  return hash.over(comm);
}

template <class T>
void is_the_same_for_every_cut() {
  const Int3 cells{21, 11, 16};
  for (const bool periodic_rows : {true, false}) {
    const std::uint64_t alone =
        stirred_heat<T>(grid_cut(cells, cells), periodic_rows, MPI_COMM_SELF, 1, false);
    EXPECT_EQ(alone, stirred_heat<T>(grid_cut(cells, cells), periodic_rows, MPI_COMM_SELF, 1, true));
    for (const Int3 size : {Int3{21, 11, 2}, Int3{8, 6, 2}})
      EXPECT_EQ(alone, stirred_heat<T>(grid_cut(cells, size), periodic_rows, MPI_COMM_WORLD, ranks(), true));
    EXPECT_EQ(alone, stirred_heat<T>(tests::odd_cut(cells, 3 * ranks(), 2, ranks()), periodic_rows,
                                     MPI_COMM_WORLD, ranks(), true));
  }
}

TEST(Heat, IsTheSameForEveryCut) {
  is_the_same_for_every_cut<float>();
  is_the_same_for_every_cut<double>();
}

}  // namespace
}  // namespace silt::lbm::testing
