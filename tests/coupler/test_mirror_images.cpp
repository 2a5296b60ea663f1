// Bodies and walls at free-slip sides: the flow in half of a symmetric scene, with a free-slip side in the
// plane of symmetry, is that of the whole.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "lbm/walls/wall_scheme.hpp"
#include "silt/case/case.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/single_cells.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

constexpr int half_of_cells = 18;  // cells from one plane of symmetry, z = 0, to the next, z = 18

struct Moving {
  std::string shape;
  Vec3 position, velocity, turn;
  std::array<double, 4> orientation{1, 0, 0, 0};  // w, x, y, z

  Moving mirrored() const {
    const auto& [w, x, y, z] = orientation;
    return {shape,
            {position[0], position[1], 2 * half_of_cells - position[2]},
            {velocity[0], velocity[1], -velocity[2]},
            {-turn[0], -turn[1], turn[2]},
            {w, -x, -y, z}};
  }
  std::string text(const std::string& motion) const {
    const auto list = [](const auto& v) {
      return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v[0], v[1], v[2]);
    };
    const auto& [w, x, y, z] = orientation;
    return body_of(shape, 1.3,
                   fmt::format("motion = \"{}\"\nposition = {}\nvelocity = {}\nangular_velocity = {}\n"
                               "orientation = [{:.17g}, {:.17g}, {:.17g}, {:.17g}]",
                               motion, list(position), list(velocity), list(turn), w, x, y, z));
  }
};

const Moving free_ball{"ball", {18.2, 7.7, 3.35}, {0.002, 0.01, 0.004}, {0.01, -0.004, 0.003}};

/// Bodies closer than a cell to the plane z = 0, and their images if `whole`. They leave it, pass it closely
/// and turn there; one is free.
std::string bodies_near_plane(bool whole) {
  std::string all;
  const auto add = [&](const Moving& body, const std::string& motion) {
    all += body.text(motion);
    if (whole) all += body.mirrored().text(motion);
  };
  add({"egg", {7.3, 6.1, 3.4}, {0.004, -0.003, 0.01}, {0.004, 0.002, -0.006}, {0.96, 0.2, 0.1, 0.17}},
      "prescribed");
  add(free_ball, "free");
  return all;
}

CaseText scene(bool whole) {
  CaseText c;
  const std::string slip = "{ type = \"free-slip\", solid_for_bodies = false }";
  c.domain = domain_of(
      {26, 16, whole ? 2 * half_of_cells : half_of_cells},
      whole ? "\"periodic\"" : "{ x = \"periodic\", y = \"periodic\", z = [" + slip + ", " + slip + "] }");
  c.fluid = "[fluid]\nrelaxation_time = 0.7\nprecision = \"double\"\nbody_force = [2e-5, 1e-5, 0]\n";
  c.rest = "[coupling]\nlubrication = false\n";
  c.shapes = sphere_of("ball", 6) + sphere_of("large ball", 9) +
             shape_of("egg", "ellipsoid", "diameters = [6, 5, 7]");
  // cut in two by the other plane
  c.bodies =
      Moving{"large ball", {12.6, 9.2, half_of_cells}, Vec3::Zero(), {0, 0, 0.003}}.text("prescribed") +
      bodies_near_plane(whole);
  return c;
}

/// Velocities of the fluid by cells.
std::map<std::array<int, 3>, Vec3> velocities(const Simulation& s) {
  std::map<std::array<int, 3>, Vec3> all;
  const FluidFields& fields = s.scene().flow->fields();
  for_each_cell(fields, [&](int b, lbm::Int3 cell, lbm::Int3 g) {
    if (fields.is_fluid(b, cell)) all[{g.x, g.y, g.z}] = velocity(fields, b, cell);
  });
  return all;
}

/// Returns the root mean square of differences of velocities in one half over that of velocities.
double difference_of_flows(const Simulation& halved, const Simulation& whole) {
  const auto of_whole = velocities(whole);
  double all = 0, difference = 0;
  for (const auto& [cell, u] : velocities(halved)) {
    all += u.squaredNorm();
    difference += of_whole.count(cell) ? (u - of_whole.at(cell)).squaredNorm() : 1;
  }
  return std::sqrt(difference / all);
}

/// Returns the largest difference of the loads on the first two bodies over a load.
double difference_of_loads(const Simulation& halved, const Simulation& whole) {
  double difference = 0;
  for (const rigid::BodyId id : {1, 2}) {
    BodyLoad a = halved.last_loads()[halved.bodies().row_of(id)],
             b = whole.last_loads()[whole.bodies().row_of(id)];
    if (id == 1) {  // the side cuts it
      b.force /= 2, b.torque /= 2;
      a.force[2] = b.force[2] = 0, a.torque.head<2>().setZero(), b.torque.head<2>().setZero();
    }
    difference = std::max({difference, (a.force - b.force).norm() / b.force.norm(),
                           (a.torque - b.torque).norm() / b.torque.norm()});
  }
  return difference;
}

double difference_of_paths(const Simulation& halved, const Simulation& whole) {
  const Vec3 a = halved.bodies().position[halved.bodies().row_of(3)],
             b = whole.bodies().position[whole.bodies().row_of(4)];
  return (a - b).norm() / (a - free_ball.position).norm();
}

/// Only cells that bodies leave are filled from fewer neighbours at a side.
TEST(BodiesAtFreeSlipSides, MoveAsInTheWholeOfASymmetricScene) {
  const Overrides halfway{"coupling.wall_scheme=bounce-back"};
  Simulation halved = scene(false).start(MPI_COMM_SELF, {halfway[0], "domain.blocks=[8, 8, 9]"}),
             whole = scene(true).start(MPI_COMM_SELF, halfway);
  halved.run(4), whole.run(4);
  EXPECT_LT(difference_of_flows(halved, whole), 1e-12);
  EXPECT_LT(difference_of_loads(halved, whole), 1e-12);
  EXPECT_LT(difference_of_paths(halved, whole), 1e-12);
}

/// Links that lead away from a side have no fluid cell behind them in its row of cells.
TEST(BodiesAtFreeSlipSides, AreAsAccurateAsElsewhereWithAnyWallScheme) {
  for (const auto name : lbm::wall_scheme_names) {
    SCOPED_TRACE(name);
    const Overrides scheme{"coupling.wall_scheme=" + std::string(name)};
    Simulation halved = scene(false).start(MPI_COMM_SELF, scheme),
               whole = scene(true).start(MPI_COMM_SELF, scheme);
    halved.run(300), whole.run(300);
    EXPECT_LT(difference_of_flows(halved, whole), 0.01);
    EXPECT_LT(difference_of_loads(halved, whole), 0.005);
    EXPECT_LT(difference_of_paths(halved, whole), 0.01);
  }
}

/// A ball that turns about its way to a plane of symmetry a quarter of a cell away.
CaseText ball_close_to_plane(bool whole) {
  CaseText c;
  c.domain = domain_of({20, 20, whole ? 2 * half_of_cells : half_of_cells},
                       whole ? "\"periodic\"" : R"({ x = "periodic", y = "periodic", z = "free-slip" })");
  c.fluid = "[fluid]\nrelaxation_time = 0.7\nprecision = \"double\"\n";
  c.rest = "[coupling]\nwall_scheme = \"bounce-back\"\n";
  c.shapes = sphere_of("ball", 6);
  const Moving ball{"ball", {10.2, 9.7, 3.25}, {0.004, -0.003, -0.02}, {0, 0, 0.01}};
  c.bodies = ball.text("free") + (whole ? ball.mirrored().text("free") : "");
  return c;
}

/// Cells that the ball leaves are filled from fewer neighbours at the side, with or without the film.
TEST(BodiesAtFreeSlipSides, AreSlowedByTheFilmToTheirImage) {
  const auto velocity_after = [](bool whole, const Overrides& changes) {
    Simulation s = ball_close_to_plane(whole).start(MPI_COMM_SELF, changes);
    s.run(3);
    return Vec3(s.bodies().velocity[s.bodies().row_of(1)]);
  };
  const auto by_film = [&](bool whole) -> Vec3 {
    return velocity_after(whole, {}) - velocity_after(whole, {"coupling.lubrication=false"});
  };
  const Vec3 at_side = by_film(false), at_image = by_film(true);
  EXPECT_GT(at_image.norm(), 0.02 * 0.02);  // of a velocity of 0.02
  EXPECT_LT((at_side - at_image).norm(), 1e-3 * at_image.norm());
}

}  // namespace
}  // namespace silt::coupler::testing
