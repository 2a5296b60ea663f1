// The temperature far from walls: waves decay with the diffusivity that was asked for and move with the
// stream.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "tests/lbm/heat/stirred_heat.hpp"

namespace silt::lbm {
namespace {

using testing::periodic;
using testing::Velocity;

/// What is left of a wave of one period along some axes after a time in a uniform stream.
struct Wave {
  double diffusivity_error, speed_error;  // relative to D, to the stream
};

Wave wave(Int3 cells, Int3 waves, const Velocity& u, double diffusivity, int steps) {
  Fluid<double> fluid(Domain(cells, {periodic, periodic, periodic, periodic, periodic, periodic}, {}, 1),
                      {1.0}, MPI_COMM_SELF);
  Temperature<double> heat(fluid, {diffusivity}, fluid.domain().sides());
  const double k[3] = {2 * std::numbers::pi * waves.x / cells.x, 2 * std::numbers::pi * waves.y / cells.y,
                       2 * std::numbers::pi * waves.z / cells.z};
  const auto phase = [&](Int3 g) { return k[0] * g.x + k[1] * g.y + k[2] * g.z; };
  testing::set(
      fluid, heat, [&](Int3 g) { return std::cos(phase(g)); }, [&](Int3) { return u; });
  const auto amplitude = [&] {
    std::complex<double> sum = 0;
    testing::for_all_cells(fluid,
                           [&](int b, Int3 x, Int3 g) { sum += heat.at(b, x) * std::polar(1.0, -phase(g)); });
    return sum;
  };
  const int first = steps / 4;  // until what is off equilibrium has come
  for (int t = 0; t < first; ++t) testing::step(fluid);
  const std::complex<double> before = amplitude();
  for (int t = first; t < steps; ++t) testing::step(fluid);
  const std::complex<double> factor = amplitude() / before;
  const double time = steps - first, kk = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
  const double ku = k[0] * u[0] + k[1] * u[1] + k[2] * u[2];
  return {-std::log(std::abs(factor)) / (time * diffusivity * kk) - 1,
          ku == 0 ? 0 : std::remainder(-std::arg(factor) - ku * time, 2 * std::numbers::pi) / (ku * time)};
}

TEST(WavesOfHeat, DecayByTheDiffusivityInAnyStream) {
  for (const double diffusivity : {0.02, 0.05, 0.1})
    for (const Velocity& u : {Velocity{0, 0, 0}, {0.05, 0, 0}, {0.04, 0.03, -0.02}}) {
      const Wave along = wave({64, 4, 4}, {1, 0, 0}, u, diffusivity, 400);
      EXPECT_NEAR(along.diffusivity_error, 0, 1e-3) << diffusivity << " " << u[0] << " " << u[1];
      EXPECT_NEAR(along.speed_error, 0, 1.5e-3);
    }
}

/// Oblique to the axes the stream changes the flux across itself, too.
TEST(WavesOfHeat, DecayByItObliquely) {
  for (const Velocity& u : {Velocity{0.1, 0, 0}, {0.07, 0.07, 0}, {0.07, -0.07, 0}}) {
    const Wave oblique = wave({48, 48, 2}, {1, 1, 0}, u, 0.1, 200);
    EXPECT_NEAR(oblique.diffusivity_error, 0, 1e-3) << u[0] << " " << u[1];
  }
}

/// The rest of the error goes with the square of the cell, at a cell Péclet number of 5.
TEST(WavesOfHeat, ErrorsGoWithTheSquareOfTheCell) {
  const Velocity u{0.1, 0, 0};
  const double coarse = wave({24, 2, 2}, {1, 0, 0}, u, 0.02, 200).diffusivity_error,
               fine = wave({48, 2, 2}, {1, 0, 0}, u, 0.02, 400).diffusivity_error;
  EXPECT_NEAR(coarse / fine, 4, 0.8);
}

/// A temperature that is the same everywhere stays so to rounding, and sums of heat do in single precision.
TEST(WavesOfHeat, HeatIsConserved) {
  const Int3 cells{13, 10, 6};
  Fluid<float> fluid(Domain(cells, {periodic, periodic, periodic, periodic, periodic, periodic}, {}, 1),
                     {0.6}, MPI_COMM_SELF);
  Temperature<float> heat(fluid, {0.01}, fluid.domain().sides());
  testing::set(
      fluid, heat, [](Int3 g) { return 20 + std::sin(g.x + 2. * g.y); },
      [](Int3 g) {
        return Velocity{0.02 * std::sin(3. * g.z), 0, 0.01 * std::cos(2. * g.x)};
      });
  const auto sum = [&] {
    double all = 0;
    testing::for_all_cells(fluid, [&](int b, Int3 x, Int3) { all += heat.at(b, x); });
    return all;
  };
  const double before = sum();
  for (int t = 0; t < 500; ++t) testing::step(fluid);
  EXPECT_NEAR(sum() / before, 1, 2e-7);
}

/// Fluid that is as warm everywhere falls or rises as under a body force, whatever the model, at either
/// parity.
TEST(Buoyancy, AcceleratesTheFluidOfACell) {
  for (const Collision model : {Collision::trt, Collision::regularised}) {
    Fluid<double> fluid(
        Domain({19, 3, 4}, {periodic, periodic, periodic, periodic, periodic, periodic}, {}, 1),
        {0.7, 1. / 6, model, {1e-6, 0, 0}, 0.1}, MPI_COMM_SELF);
    Temperature<double> heat(fluid, {0.1, {0, 2e-6, -3e-6}}, fluid.domain().sides());
    testing::set(
        fluid, heat, [](Int3 g) { return g.z < 2 ? 5. : 5. + 1e-9; }, [](Int3) { return Velocity{}; });
    constexpr int steps = 101;
    for (int t = 0; t < steps; ++t) testing::step(fluid);
    const Moments m = fluid.moments(0, {18, 1, 1});
    EXPECT_NEAR(m.momentum[0], steps * 1e-6, 1e-12);
    EXPECT_NEAR(m.momentum[1], steps * 1e-5, 1e-10);
    EXPECT_NEAR(m.momentum[2], steps * -1.5e-5, 1e-10);
  }
}

}  // namespace
}  // namespace silt::lbm
