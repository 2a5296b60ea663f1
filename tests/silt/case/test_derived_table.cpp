// The table of `silt check`: what follows from a case.
#include <gtest/gtest.h>

#include <numbers>

#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::testing {
namespace {

TEST(DerivedTable, GivesBothSystemsOfUnits) {
  CaseText c = si_case();
  c.rest = "[gravity]\nacceleration = [0, 0, -9.81]\n";
  const std::string table = derived_table(c.read());
  for (const char* part : {"0.032 x 0.032 x 0.032 m", "32 x 32 x 32 cells", "1e-05 m2/s", "0.1 cells2/step",
                           "0.8", "8 cells", "terminal velocity", "2.5 MB", "55.4256 steps"})
    EXPECT_TEXT(table, part) << part << " is not in\n" << table;
}

TEST(DerivedTable, ColumnsStandApartHoweverLongTheyAre) {
  CaseText c = si_case();
  c.rest =
      "[gravity]\nacceleration = [0, 0, -9.81]\n[[fill]]\nname = \"grains that have a rather long name\"\n"
      "shape = \"ball\"\ndensity = 1100\ncount = 1\n[[outflow]]\n"
      "box = [[0.00123456, 0.00123456, 0.00123456], [0.0123456, 0.0123456, 0.0123456]]\n";
  const std::string table = derived_table(c.read());
  EXPECT_TEXT(table, "fill[0] grains that have a rather long name  1 of shape");
  c.rest =
      "[[walls]]\nname = \"rock\"\ntype = \"tube\"\npoint = [0.016, 0.016, 0]\naxis = \"z\"\nradius = "
      "0.0151234567\n";
  c.rest.replace(c.rest.find("rock"), 4, "a pipe of some length");
  const std::string tube = derived_table(c.read());
  EXPECT_TEXT(tube, "tube 'a pipe of some length', radius  0.0151");
}

/// Walls across z leave centres of balls of radius 4 the middle 24 of 32 cells; a gap, and faces of a box,
/// less.
TEST(DerivedTable, SaysWhatSidesAndFacesLeaveOfABox) {
  for (const auto& [lines, percent] : {std::pair{"", 75},
                                       {"gap = 1", 69},
                                       {"box = [[0, 0, 0], [32, 32, 16]]", 50},
                                       {"box = [[0, 0, -9], [32, 32, 99]]", 75},
                                       {"box = [[8, 0, 0], [24, 32, 32]]", 38}}) {
    CaseText c;
    c.bodies = fill_of("ball", 1.2, 1, std::string(lines) + "\n");
    const std::string table = derived_table(c.read());
    EXPECT_TEXT(table, " " + std::to_string(percent) + " % of the box") << lines << table;
  }
}

TEST(DerivedTable, OfManySizesTheSmallestIsMeasuredInCells) {
  CaseText c;
  c.bodies = fill_of("ball", 1.2, 2, "diameter = { table = [[6, 1], [8, 1]] }");
  EXPECT_TEXT(derived_table(c.read()), "  cells across, smallest  6 cells");
}

/// Bodies of another run are as well described as those of the fill that they came from.
TEST(DerivedTable, OfManySizesFromAnotherRunTheLargestFallsFastest) {
  const std::string sizes = "diameter = { table = [[6, 1], [8, 1]] }\n";
  CaseText fill, continued;
  fill.rest = continued.rest = "[gravity]\nacceleration = [0, 0, -1e-5]\n";
  fill.bodies = fill_of("ball", 1.2, 2, sizes);
  continued.bodies = "[[bodies]]\nshape = \"ball\"\ndensity = 1.2\n" + sizes;
  continued.rest += "[initial]\nfrom = \"elsewhere\"\n";
  const std::string expected = derived_table(fill.read()), table = derived_table(continued.read());
  for (const std::string line : {"  cells across, smallest", "  terminal velocity", "  its Reynolds, Mach"}) {
    const auto from = expected.find(line);
    ASSERT_NE(from, std::string::npos);
    EXPECT_TEXT(table, expected.substr(from, expected.find('\n', from) - from));
  }
}

/// What moves as the case says sets the pace of the fluid, whatever it is.
TEST(DerivedTable, TheLargestGivenSpeedIsThatOfAnythingThatMoves) {
  const double pi = std::numbers::pi;
  CaseText c;
  const auto of = [&](const std::string& motion) {
    c.bodies = body_of("ball", 1.2, "position = [16, 16, 16]\n" + motion + "\n");
    return fastest_given(c.read());
  };
  EXPECT_EQ(of(""), 0);
  EXPECT_NEAR(of("velocity = [0, 0.01, 0]\nmotion = \"prescribed\""), 0.01, 1e-12);
  EXPECT_NEAR(of("angular_velocity = [0, 0.01, 0]"), 0.04, 1e-12);  // the radius is 4
  EXPECT_NEAR(of("motion = { amplitude = [0, 2, 0], frequency = 1e-3 }"), 2 * 2 * pi * 1e-3, 1e-12);
  c.rest =
      "[[walls]]\ntype = \"tube\"\naxis = \"y\"\nradius = 15\npoint = [16, 0, 16]\n"
      "angular_velocity = -0.002\n";
  EXPECT_NEAR(of(""), 0.03, 1e-12);
  c.fluid = "[fluid]\nrelaxation_time = 0.503\ncollision = \"auto\"\n";  // u / nu = 30
  EXPECT_EQ(c.read().fluid->collision, lbm::Collision::regularised);
}

/// In the units of cells four times as wide the viscosity is a quarter, and a speed is the same.
TEST(DerivedTable, CellReynoldsNumberIsThatOfTheWidestCellsForAStreamAndOfTheFinestForABody) {
  const auto of = [](const std::string& stream, const std::string& velocity) {
    CaseText c;
    c.domain = domain_of({96, 96, 96});
    c.fluid = "[fluid]\nkinematic_viscosity = 0.008\ncollision = \"auto\"\n" + stream;
    c.rest = "[coarsening]\nlevels = 2\ndistance = 16\n";
    c.bodies = body_of("ball", 1, "position = [48, 48, 48]\n" + velocity);
    return c.read();
  };
  const Case stream = of("initial = { type = \"uniform\", velocity = [0.05, 0, 0] }\n", "");
  EXPECT_NEAR(cell_reynolds(stream), 25, 1e-9);
  EXPECT_EQ(stream.fluid->collision, lbm::Collision::regularised);
  const Case body = of("", "velocity = [0.05, 0, 0]\n");
  EXPECT_NEAR(cell_reynolds(body), 6.25, 1e-9);
  EXPECT_EQ(body.fluid->collision, lbm::Collision::trt);
}

/// In fluid at rest the Nusselt number is 2, and of a sphere h (V/A)/k is its sixth times the conductivity of
/// the fluid over that of the body.
TEST(DerivedTable, SaysWhatABodyOfOneTemperatureMustConduct) {
  CaseText c;
  c.bodies = body_of("ball", 2, "position = [16, 16, 16]\ntemperature = 1\nheat_capacity = 1\n");
  c.rest = "[heat]\nthermal_diffusivity = 0.1\n";
  EXPECT_TEXT(derived_table(c.read()), "it conducts 3.33");
  c.bodies = body_of("ball", 2, "position = [16, 16, 16]\ntemperature = 1\n");
  EXPECT_FALSE(tests::has_part(derived_table(c.read()), "it conducts"));
}

TEST(DerivedTable, TerminalVelocityFollowsStokesWhenSlow) {
  const double diameter = 2, density = 1.01, gravity = 1e-6, nu = 1;
  const double stokes = (density - 1) * gravity * diameter * diameter / (18 * nu);
  EXPECT_NEAR(terminal_velocity(diameter, density, gravity, nu) / stokes, 1, 1e-4);
  EXPECT_EQ(terminal_velocity(diameter, 1, gravity, nu), 0);
}

}  // namespace
}  // namespace silt::testing
