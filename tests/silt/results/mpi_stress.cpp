// The parts of the stress of a suspension against closed forms and against the stress on the walls.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>

#include "tests/silt/case/case_text.hpp"

namespace silt::testing {
namespace {

std::string stress(const std::string& type, const std::string& component, const std::string& more = "") {
  static int count = 0;
  return "[[quantities]]\nname = \"" + std::to_string(++count) + "\"\ntype = \"" + type +
         "\"\ncomponent = \"" + component + "\"\n" + more;
}

/// A plane shear of rate 0.04 / height across z.
CaseText shear(int height, const std::string& quantities, int steps) {
  CaseText c;
  c.domain = domain_of({20, 20, height},
                       "{ x = \"periodic\", y = \"periodic\", z = [{ type = \"moving\", velocity = [-0.02, "
                       "0, 0] }, { type = \"moving\", velocity = [0.02, 0, 0] }] }");
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = c.bodies = "";
  c.run = "[run]\nsteps = " + std::to_string(steps) + "\n" + quantities;
  return c;
}

TEST(Stress, TheFluidsInAPlaneShearIsViscosityTimesTheShear) {
  const std::string box = "box = [[3, 2, 5], [11, 14, 15]]\n";
  CaseText c = shear(16,
                     stress("viscous-stress", "xz", box) + stress("viscous-stress", "xx", box) +
                         stress("viscous-stress", "xy", box),
                     2000);  // the slowest antisymmetric mode decays as exp(-4 pi^2 nu t / h^2): to 4e-14
  c.domain.replace(c.domain.find("20, 20"), 6, "12, 16");
  const auto values = c.values(MPI_COMM_WORLD);
  const double theory = 0.1 * 0.04 / 16;
  EXPECT_NEAR(values[0], theory, 1e-6 * theory);
  EXPECT_NEAR(values[1], 0, 4e-3 * theory) << "of the square of the velocities, 4e-4";
  EXPECT_NEAR(values[2], 0, 1e-6 * theory);
}

/// Cells count by their parts in a box, which may be thinner than one, on cells of two widths and across the
/// borders between them.
TEST(Stress, AUniformShearHasTheSameStressInAnyBox) {
  const std::vector<std::string> boxes = {
      "[[0, 0, 0], [16, 16, 48]]",          "[[0, 0, 8], [16, 16, 40]]",
      "[[3.3, 2.2, 5.1], [7.7, 9.1, 9.3]]", "[[3.3, 2.2, 37.9], [7.7, 9.1, 44]]",
      "[[0, 0, 20], [16, 16, 21]]",         "[[0, 0, 20.1], [16, 16, 20.2]]",
      "[[0, 0, 0], [16, 16, 0.3]]",         "[[5.5, 0, 47.9], [5.6, 16, 48]]",
      "[[0, 0, 7.9], [0.1, 0.1, 8.1]]"};
  for (const bool levels : {true, false}) {
    std::string quantities;
    for (const std::string& box : boxes)
      for (const char* component : {"xz", "yz"})
        quantities += stress("viscous-stress", component, "box = " + box + "\n");
    CaseText c = shear(48, quantities, 3000);  // to 7e-12
    c.domain.replace(c.domain.find("20, 20"), 6, "16, 16");
    c.fluid.replace(c.fluid.find("0.8"), 3, "2.0");
    if (levels)
      c.rest =
          "[coarsening]\nlevels = 1\ndistance = 8\nfine = [{ box = [[0, 0, 0], [16, 16, 8]] }, { box = [[0, "
          "0, 40], [16, 16, 48]] }]\n";
    const auto values = c.values(MPI_COMM_WORLD);
    const double theory = 0.5 * 0.04 / 48;
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      EXPECT_NEAR(values[2 * k], theory, 1e-9 * theory) << boxes[k];
      EXPECT_NEAR(values[2 * k + 1], 0, 1e-9 * theory) << boxes[k];
    }
  }
}

/// The shear turns a sphere: the walls bear what the fluid has and what the sphere adds
/// (Batchelor 1970); a sphere alone adds 5/2 of its share of the volume (Einstein 1906), near walls more.
TEST(Stress, TheFluidsAndTheBodiesPartsAreWhatTheWallsBear) {
  CaseText c = shear(24,
                     stress("viscous-stress", "xz") + stress("particle-stress", "xz") +
                         "[[quantities]]\nname = \"wall\"\ntype = \"wall-stress\"\nside = \"z-low\"\naxis = "
                         "\"x\"\ntime = 1400\n",
                     1500);
  c.shapes = sphere_of("ball", 9);
  c.bodies = body_of("ball", 1, "position = [10.3, 9.8, 12.1]");
  const auto values = c.values(MPI_COMM_WORLD);
  const double applied = 0.1 * 0.04 / 24, share = std::numbers::pi / 6 * 9 * 9 * 9 / (20. * 20 * 24);
  EXPECT_NEAR(values[0] + values[1], std::abs(values[2]), 0.01 * std::abs(values[2]));
  EXPECT_GT(values[1] / applied, 2.3 * share);
  EXPECT_LT(values[1] / applied, 4 * share);
  const Overrides few{"run.steps=40", "quantities[2].time=1"},
      blocks{"run.steps=40", "quantities[2].time=1", "domain.blocks=[10, 10, 12]"};
  EXPECT_EQ(c.values(MPI_COMM_SELF, few), c.values(MPI_COMM_WORLD, blocks)) << "the same bits on any ranks";
}

/// If n balls lie on each other, the k-th from above is pressed by (k - 1) weights above and k below:
/// together the weight times the radius times n^2.
TEST(Stress, ContactsOfAColumnBearItsWeight) {
  constexpr int n = 4;
  constexpr double radius = 4, gravity = 1e-4;
  CaseText c;
  c.fluid = "";
  c.domain =
      domain_of({24, 24, 40}, "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }");
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  c.bodies = body_of("ball", 2, "positions = [[12, 12, 4], [12, 12, 12], [12, 12, 20], [12, 12, 28]]");
  const std::string box = "box = [[4, 4, 0], [20, 20, 32]]\n";
  c.run = "[run]\nsteps = 50\n" + stress("contact-stress", "zz", box) + stress("contact-stress", "xx", box) +
          stress("contact-stress", "zz", "box = [[4, 4, 8], [20, 20, 16]]\n");
  const double weight = 2 * 4 * std::numbers::pi / 3 * std::pow(radius, 3) * gravity;
  const auto values = c.values(MPI_COMM_WORLD, {"domain.blocks=[24, 12, 10]"});
  EXPECT_NEAR(values[0], -weight * radius * n * n / (16. * 16 * 32), 1e-6 * std::abs(values[0]));
  EXPECT_NEAR(values[1], 0, 1e-9);
  const double substeps = c.values(MPI_COMM_SELF, {"contacts.substeps=4"})[0];
  EXPECT_NEAR(substeps, values[0], 1e-3 * std::abs(values[0]));
  EXPECT_NEAR(c.values(MPI_COMM_SELF)[0], values[0], 1e-15) << "on any ranks";
}

/// While a column glides over a periodic border it stays in a box that is the domain.
TEST(Stress, ContactsOfAColumnOnAPeriodicBorderBearItsWeight) {
  constexpr int steps = 50;
  constexpr double radius = 4, speed = 0.05;
  CaseText c;
  c.fluid = "";
  c.domain =
      domain_of({24, 24, 40}, "{ x = \"periodic\", y = \"periodic\", z = [\"free-slip\", \"free-slip\"] }");
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  const double x = 24 - speed * (steps - 1) - 0.01;  // across the border in the first half of the last drift
  c.bodies = "";
  for (const double z : {4, 12})
    c.bodies +=
        body_of("ball", 2, fmt::format("position = [{}, 12, {}]\nvelocity = [{}, 0, 0]", x, z, speed));
  c.run = fmt::format("[run]\nsteps = {}\n", steps) + stress("contact-stress", "zz");
  const double weight = 2 * 4 * std::numbers::pi / 3 * std::pow(radius, 3) * 1e-4;
  const double theory = -weight * radius * 4 / (24. * 24 * 40);
  for (const int last : {steps - 1, steps, steps + 1})
    EXPECT_NEAR(c.values(MPI_COMM_WORLD, {fmt::format("run.steps={}", last)})[0], theory, 1e-6 * -theory)
        << last;
}

}  // namespace
}  // namespace silt::testing
