// Judging: impossible scenes are refused (see also mistakes/), doubtful ones warned of, legal ones left
// alone.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "rigid/math/types.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/placement/obstacles.hpp"
#include "silt/simulation.hpp"
#include "tests/rigid/shapes/solids.hpp"
#include "tests/silt/case/mesh_case.hpp"

namespace silt::testing {
namespace {

using rigid::Vec3;

std::string warnings(const CaseText& c) {
  return listed(judgement(c.read()));
}

const std::string gravity = "[gravity]\nacceleration = [0, 0, -1e-5]\n";

TEST(CaseCheck, ALegalSceneHasNothingToSay) {
  for (CaseText c : {CaseText{}, si_case()}) {
    c.rest = gravity;
    EXPECT_EQ(warnings(c), "");
  }
}

TEST(CaseCheck, WarnsOfDensitiesInGramsThoughTheirRatioIsRight) {
  CaseText c = si_case();
  c.fluid = "[fluid]\ndensity = 1\nkinematic_viscosity = 1e-5\n";
  c.bodies = body_of("ball", 1.2, "position = [0.016, 0.016, 0.016]");
  c.rest = gravity;
  EXPECT_TEXT(warnings(c),
              "bodies[0].density is 1.2 kg/m3; solids have 10 to 25000: if fluid.density and "
              "bodies[0].density are in g/cm3, write 1000 and 1200 (kg/m3)");
}

TEST(CaseCheck, WarnsOfDoubtfulRelaxationTimes) {
  CaseText c;
  c.fluid = "[fluid]\nrelaxation_time = 0.505\n";
  EXPECT_TEXT(warnings(c), "case.toml:7:1: warning: the relaxation time is 0.505; below 0.51");
  c.fluid = "[fluid]\nrelaxation_time = 0.5001\n";  // less 0.5 it is below 1e-4, by rounding
  EXPECT_TEXT(warnings(c), "the relaxation time is 0.5001; below 0.51");
  c.fluid = "[fluid]\nrelaxation_time = 0.5000999\n";
  EXPECT_TEXT(warnings(c),
              "0.5 + 9.99e-05; no collision model was measured below 0.5 + 0.0001: the viscosity is too "
              "small for these cells by a factor of 1.1");
  c.fluid = "[fluid]\nrelaxation_time = 2.5\n";
  EXPECT_TEXT(warnings(c), "above 2 walls and slow flow lose accuracy");
}

TEST(CaseCheck, WarnsOfOtherModelsThanTrtBetweenBodiesWhereThatLasts) {
  const auto of = [](const std::string& model, double tau, const std::string& velocity) {
    CaseText c;
    c.fluid = "[fluid]\nrelaxation_time = " + std::to_string(tau) + "\ncollision = \"" + model + "\"\n";
    c.bodies += "velocity = [" + velocity + ", 0, 0]\n";
    return warnings(c);
  };
  EXPECT_TEXT(
      of("regularised", 0.55, "0.01"),
      "flow between bodies has too much drag under regularised, in a packed bed with 12 cells a diameter");
  EXPECT_TEXT(of("bgk", 0.55, "0.01"), "too much drag under bgk");
  for (const auto& [model, tau] : {std::pair("regularised", 0.6), {"trt", 0.55}, {"auto", 0.55}})
    EXPECT_EQ(of(model, tau, "0.01"), "") << model;
  EXPECT_FALSE(tests::has_part(of("regularised", 0.51, "0.1"), "too much drag"));  // where trt does not last
}

TEST(CaseCheck, WarnsOfSizesThatAreMostOfTheMassAndOfNoBody) {
  const auto of = [](int count) {
    CaseText c;
    c.domain = domain_of({200, 200, 200});
    c.rest = gravity;
    c.bodies = fill_of("ball", 1.2, count, "diameter = { by = \"mass\", table = [[6, 0.5], [24, 0.5]] }");
    return warnings(c);
  };
  // one in 65 bodies is a large one
  EXPECT_TEXT(of(3),
              "fill[0].count is 3, too few for every size: there is none with a diameter of 24, although "
              "sizes that are missing have 50 % of the mass: use 65 or more");
  EXPECT_FALSE(tests::has_part(of(130), "too few for every size"));
}

TEST(CaseCheck, WarnsOfCoarserCellsWithinTheFlowAroundABody) {
  CaseText c;
  c.domain = domain_of({96, 96, 96});
  c.rest = "[coarsening]\nlevels = 1\ndistance = 6\n";
  c.shapes = shape_of("ball", "sphere", "radius = 12");
  c.bodies = body_of("ball", 1, "position = [48, 48, 48]\nvelocity = [0.05, 0, 0]");
  EXPECT_TEXT(warnings(c),
              "coarsening.distance is 6 cells, but the flow around bodies[0] changes over about 7 cells "
              "(Reynolds number 12): use 7 or more");
  c.rest = "[coarsening]\nlevels = 1\n";
  EXPECT_FALSE(tests::has_part(warnings(c), "coarsening.distance is")) << warnings(c);
}

TEST(CaseCheck, WarnsOfHighSpeedsAndSmallBodies) {
  CaseText c;
  c.bodies += "velocity = [0.15, 0, 0]\n";
  EXPECT_TEXT(warnings(c), "bodies[0].velocity is 0.15 cells a step; above 0.1");
  c = CaseText{};
  c.shapes = "[[shapes]]\nname = \"ball\"\ntype = \"sphere\"\nradius = 2\n";
  EXPECT_TEXT(warnings(c), "shape 'ball' is 4 cells across; below 6");
  c.fluid = "";  // a dry body needs no resolution
  EXPECT_EQ(warnings(c), "");
}

TEST(CaseCheck, WarnsOfBodiesThatDoNotComeOrGo) {
  CaseText c;
  c.rest = gravity;
  const std::string fixed = c.bodies + "motion = \"fixed\"\n";
  c.bodies = fill_of("ball", 1.2, 2, "every = 100\nbox = [[0, 0, 16], [32, 32, 32]]");
  EXPECT_TEXT(warnings(c), "fill[0].every is 100, but the run has 100 steps: bodies enter");
  c.bodies = fill_of("ball", 1.2, 2, "every = 10\nbox = [[0, 0, 16], [32, 32, 32]]");
  EXPECT_EQ(warnings(c), "");
  c.bodies = fixed;
  c.rest = "[[outflow]]\nbox = [[0, 0, 0], [32, 32, 4]]\n";
  EXPECT_TEXT(warnings(c), "the case has no free bodies, and only free bodies can leave");
}

/// A spring from the ball to the lid.
const std::string spring =
    "[[springs]]\nbody = \"ball\"\nends = [[16, 16, 16], [16, 16, 32]]\nlength = 8\nstiffness = 10\n";

/// A ball between two plates along x.
CaseText ball_in_stream(const std::string& fluid, double density) {
  CaseText c;
  c.fluid = "[fluid]\nrelaxation_time = 0.55\n" + fluid;
  c.bodies = body_of("ball", density, "position = [16, 16, 12]");
  c.rest = gravity, c.run = "[run]\nsteps = 10000\n";
  return c;
}

TEST(CaseCheck, WarnsOfABodyForceThatPerhapsBodiesShouldFeel) {
  for (const std::string key : {"body_force = [1e-7, 0, 0]\n", "superficial_velocity = [1e-3, 0, 0]\n"}) {
    CaseText c = ball_in_stream(key, 1.5);
    EXPECT_TEXT(warnings(c), "free bodies do not feel the body force that drives the fluid");
    for (const std::string choice : {"true", "false"})
      EXPECT_EQ(warnings(ball_in_stream(key + "body_force_on_bodies = " + choice + "\n", 1.5)), "");
    c.bodies += "motion = \"fixed\"\n", c.rest = "";
    EXPECT_EQ(warnings(c), "");
  }
}

/// With the galilean form a sphere in a pipe goes to 0.78 of the radius, not to 0.6 (scripts/accuracy).
TEST(CaseCheck, WarnsOfBodiesThatLiftCarriesInTheGalileanForm) {
  const std::string felt = "body_force_on_bodies = true\n", fast = "superficial_velocity = [0.03, 0, 0]\n";
  for (const std::string& drive : {fast + felt, "body_force = [4e-6, 0, 0]\n" + felt}) {
    CaseText c = ball_in_stream(drive, 1.0001);
    EXPECT_TEXT(warnings(c), "bodies[0] hardly falls or rises");
    c.rest += "[coupling]\nforce = \"galilean\"\n";
    EXPECT_EQ(warnings(c), "");
  }
  EXPECT_EQ(warnings(ball_in_stream(fast + felt, 1.5)), "");
  EXPECT_EQ(warnings(ball_in_stream("superficial_velocity = [1e-3, 0, 0]\n" + felt, 1.0001)), "");
}

TEST(CaseCheck, WarnsOfEndlessFall) {
  CaseText c;
  c.domain = "[domain]\nsize = [32, 32, 32]\nboundary = \"periodic\"\n";
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  EXPECT_TEXT(warnings(c), "gravity acts, but nothing holds");
  c.bodies += "locked = [\"z\"]\n";
  EXPECT_EQ(warnings(c), "");  // nothing moves it along z
  c.bodies.resize(c.bodies.size() - std::string("locked = [\"z\"]\n").size());
  c.rest += spring;
  EXPECT_EQ(warnings(c), "");
}

TEST(CaseCheck, SaysThatAllStaysAtRestOnlyWhereItDoes) {
  CaseText c;
  const std::string said = "nothing else moves: all stays at rest";
  EXPECT_TEXT(warnings(c), said);
  for (const std::string& moves :
       {gravity, spring, std::string("[contacts]\ncohesion = 1e-3\n"),
        std::string("[[walls]]\ntype = \"tube\"\nname = \"drum\"\naxis = \"y\"\nradius = 14\npoint = [16, "
                    "16, 16]\nangular_velocity = 0.001\n")}) {
    c.rest = moves;
    EXPECT_FALSE(tests::has_part(warnings(c), said)) << moves;
  }
}

TEST(CaseCheck, WhatSpringsOrLocksHoldDoesNotFall) {
  CaseText c;
  c.bodies = body_of("ball", 8, "position = [16, 16, 16]");
  c.rest = "[gravity]\nacceleration = [0, 0, -4e-3]\n";
  const std::string falls = "bodies[0] comes to ";
  EXPECT_TEXT(warnings(c), falls);
  const std::string alone = c.rest, free = c.bodies;
  c.rest = alone + spring;
  EXPECT_FALSE(tests::has_part(warnings(c), falls)) << warnings(c);
  c.rest = alone, c.bodies = free + "locked = [\"z\"]\n";
  EXPECT_FALSE(tests::has_part(warnings(c), falls));
  c.bodies = free + "locked = [\"x\"]\n";
  EXPECT_TEXT(warnings(c), falls);
}

TEST(CaseCheck, AControlledFlowIsNotWarnedOfItsFirstForce) {
  CaseText c;
  c.domain = domain_of({32, 32, 32}, "{ x = \"periodic\", y = \"periodic\", z = \"no-slip\" }");
  c.shapes = c.bodies = "";
  c.fluid += "body_force = [1e-3, 0, 0]\n";
  c.run = "[run]\nsteps = 1000\n";
  EXPECT_TEXT(warnings(c), "drives laminar flow at up to");
  c.fluid += "superficial_velocity = [0.01, 0, 0]\n";
  EXPECT_EQ(warnings(c), "");
}

TEST(CaseCheck, WarnsOfBodiesFasterThanTheContactMargin) {
  CaseText c;
  c.fluid = "";
  c.bodies += "velocity = [3, 0, 0]\n";
  EXPECT_TEXT(warnings(c), "moves 3 cells in a sub-step, but contacts.margin is 1");
}

TEST(CaseCheck, RequireRunnableKeepsWarningsAndThrowsErrors) {
  CaseText c;
  c.rest = gravity;
  c.fluid = "[fluid]\nrelaxation_time = 0.505\n";
  Case setup = c.read();
  EXPECT_EQ(require_runnable(setup).size(), 1u);
  setup.steps = 0;
  EXPECT_THROW(require_runnable(setup), CaseError);
}

TEST(CaseCheck, FixedBodiesMayReachIntoWallsAndEachOther) {
  CaseText c;
  c.bodies = body_of("ball", 1, "motion = \"fixed\"\npositions = [[16, 16, 2], [16, 16, 6], [16, 0, 2]]");
  EXPECT_EQ(warnings(c), "");
}

TEST(CaseCheck, TouchingBodiesAreLegal) {
  CaseText c;
  c.bodies = body_of("ball", 1, "positions = [[16, 16, 4], [16, 16, 12], [24, 16, 12]]");
  EXPECT_EQ(warnings(c), "");
  c.shapes = "[[shapes]]\nname = \"ball\"\ntype = \"box\"\nedges = [8, 8, 8]\n";
  EXPECT_EQ(warnings(c), "");
}

TEST(CaseCheck, ASimulationRefusesBodiesThatOverlap) {
  CaseText c;
  c.bodies = body_of("ball", 1, "positions = [[16, 16, 4], [16, 16, 11.9]]");
  EXPECT_THROW(c.start(MPI_COMM_SELF), CaseError);
}

TEST(CaseCheck, ProgrammedCasesAreJudgedToo) {  // what a file cannot say, a Case made by a program can
  Case setup = CaseText{}.read();
  setup.fluid->relaxation_time = 0.5;
  setup.fluid->magic = 0;
  setup.pair_materials[0].restitution = 1.5;
  setup.pair_materials[0].friction = -0.1;
  setup.contacts.margin = -1;
  setup.steps = 0;
  setup.bodies[0].density = -1;
  const std::string text = listed(judgement(setup));
  for (const char* part :
       {"must be above 0.5", "fluid.magic is 0", "a restitution is 1.5", "a friction is -0.1",
        "contacts.margin is -1 cells", "the run has 0 steps", "density is -1"})
    EXPECT_TEXT(text, part);
}

/// A regular prism.
rigid::Polyhedron prism(int corners) {
  std::vector<Vec3> vertices;
  std::vector<std::vector<int>> faces(2);
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    for (const double z : {-4.0, 4.0}) vertices.emplace_back(4 * std::cos(angle), 4 * std::sin(angle), z);
    faces[0].push_back(2 * (corners - 1 - k));
    faces[1].push_back(2 * k + 1);
    const int next = (k + 1) % corners;
    faces.push_back({2 * k, 2 * next, 2 * next + 1, 2 * k + 1});
  }
  return {rigid::make_polyhedron_mesh(vertices, faces)};
}

TEST(CaseCheck, AShapeThatTheBackendCannotAnswerForIsRefused) {
  Case setup = CaseText{}.read();
  setup.bodies[0].density = 1;
  setup.shapes[0] = prism(8);
  EXPECT_EQ(listed(judgement(setup)), "");
  setup.shapes[0] = prism(11000);  // more vertices, edges and faces than 16 bits count
  const std::string text = listed(judgement(setup));
  EXPECT_TEXT(text,
              "contacts.backend is \"auto\"; it cannot compute contacts of shape 'ball' (polyhedron) with a "
              "wall: use another backend, or a simpler shape (polyhedra of at most some 10000 vertices)");
  setup.bodies[0].motion = rigid::Motion::fixed;  // meets nothing
  EXPECT_FALSE(tests::has_part(listed(judgement(setup)), "cannot answer"));
}

// Legal scenes must never be refused: the depth found is never above the true one.
TEST(Overlap, FindsOverlapsAndNeverInventsThem) {
  const rigid::Shape ball = rigid::Sphere{2}, box = rigid::Box{{2, 2, 2}}, rod = rigid::Capsule{1, 3};
  const auto at = [](double x, double y = 0, double z = 0) {
    return rigid::Pose{{x, y, z}, rigid::Quat::Identity()};
  };
  EXPECT_NEAR(overlap_depth(ball, at(0), ball, at(3)), 1, 1e-12);
  EXPECT_NEAR(overlap_depth(ball, at(0), ball, at(5)), -1, 1e-12);
  EXPECT_NEAR(overlap_depth(ball, at(0), box, at(3.5)), 0.5, 1e-12);
  EXPECT_LE(overlap_depth(box, at(0), box, at(4)), 1e-12) << "face to face";
  EXPECT_GT(overlap_depth(box, at(0), box, at(3.5)), 0.4);
  EXPECT_GT(overlap_depth(box, at(0), box, at(0)), 1) << "one inside the other";
  EXPECT_LE(overlap_depth(rod, at(0), rod, at(2)), 1e-12) << "side by side";
  EXPECT_GT(overlap_depth(rod, at(0), rod, at(1.5)), 0.4);
  const rigid::Pose lying{{2, 0, 0}, rigid::rotation_between(Vec3::UnitZ(), Vec3::UnitX()).normalized()};
  EXPECT_GT(overlap_depth(rod, at(0), rod, lying), 1) << "a rod through another";
}

TEST(Overlap, SeesPeriodicImages) {
  rigid::Extent extent;
  extent.size = Vec3(20, 20, 20);
  extent.periodic = {true, false, false};
  const rigid::Shape ball = rigid::Sphere{2};
  const auto at = [](double x, double y) { return rigid::Pose{{x, y, 0}, rigid::Quat::Identity()}; };
  EXPECT_NEAR(overlap_depth(ball, at(1, 5), ball, at(18, 5), extent), 1, 1e-12);
  EXPECT_LT(overlap_depth(ball, at(5, 1), ball, at(5, 18), extent), 0);
}

/// The widest gap that a plane leaves between two shapes, out of many planes; negative if none parts them.
double widest_gap(const rigid::ConvexShape& a, const rigid::Pose& pose_a, const rigid::ConvexShape& b,
                  const rigid::Pose& pose_b) {
  const auto furthest = [](const rigid::ConvexShape& s, const rigid::Pose& pose, const rigid::Vec3& n) {
    return n.dot(pose.to_world(rigid::support(s, pose.orientation.conjugate() * n)));
  };
  std::mt19937_64 generator(4);
  std::normal_distribution<> normal;
  double gap = -1e9;
  for (int i = 0; i < 2000; ++i) {
    const rigid::Vec3 n = rigid::Vec3(normal(generator), normal(generator), normal(generator)).normalized();
    gap = std::max(gap, -furthest(b, pose_b, -n) - furthest(a, pose_a, n));
  }
  return gap;
}

TEST(Overlap, IsNeverOverstatedAndDeepOnesAreFound) {
  const std::vector<rigid::ConvexShape> shapes = {
      rigid::Cylinder{3, 4},     rigid::Cylinder{5, 1}, rigid::Ellipsoid{{5, 3, 2}},
      rigid::testing::frustum(), rigid::Box{{2, 3, 4}}, rigid::testing::octahedron({4, 3, 5}),
      rigid::Capsule{1, 4}};
  std::mt19937_64 generator(9);
  std::uniform_real_distribution<> uniform(-1, 1);
  const auto any = [&] { return uniform(generator); };
  int apart = 0, deep = 0;
  for (const auto& a : shapes)
    for (const auto& b : shapes)
      for (int i = 0; i < 20; ++i) {
        const rigid::Pose pose_a{rigid::Vec3::Zero(), rigid::Quat(any(), any(), any(), any()).normalized()};
        const rigid::Pose pose_b{6 * rigid::Vec3(any(), any(), any()),
                                 rigid::Quat(any(), any(), any(), any()).normalized()};
        const auto whole = [](const auto& s) -> rigid::Shape { return s; };
        const double depth = overlap_depth(std::visit(whole, a), pose_a, std::visit(whole, b), pose_b);
        const double gap = widest_gap(a, pose_a, b, pose_b);
        EXPECT_LE(depth, -gap + 1e-9) << a.index() << " and " << b.index();
        apart += gap > 0;
        deep += gap < -1.5;
        if (gap < -1.5) {
          EXPECT_GT(depth, 0) << a.index() << " and " << b.index();
        }
      }
  EXPECT_GT(apart, 50);
  EXPECT_GT(deep, 50);
}

TEST(BodyCheck, LeastWidths) {
  EXPECT_EQ(rigid::least_width(rigid::Cylinder{3, 2}), 4);
  EXPECT_EQ(rigid::least_width(rigid::Cylinder{3, 5}), 6);
  EXPECT_EQ(rigid::least_width(rigid::Ellipsoid{{3, 5, 4}}), 6);
  EXPECT_DOUBLE_EQ(rigid::least_width(rigid::testing::cuboid({0, 0, 0}, {4, 2, 3})), 2);
  // a regular tetrahedron is narrowest between two opposite edges: a / sqrt 2
  EXPECT_DOUBLE_EQ(
      rigid::least_width(rigid::testing::tetrahedron({1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1})), 2);
}

/// A tetrahedron, one triangle of which is turned inward and one there twice, is mended alike as body and
/// wall.
TEST(CaseCheck, SaysWhatWasMendedInAFile) {
  const std::string tetrahedron =
      "v 0 0 0\nv 8 0 0\nv 0 8 0\nv 0 0 8\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 1 4 3\nf 2 4 3\n";
  CaseText c = mesh_case("a.obj", "solid = \"inside\"\nposition = [2, 2, 2]");
  c.shapes = "[[shapes]]\nname = \"chip\"\ntype = \"mesh\"\nfile = \"b.obj\"\n";
  c.bodies = body_of("chip", 1.2, "position = [16, 16, 16]\n");
  const std::string table = derived_table(read_with(c, {{"a.obj", tetrahedron}, {"b.obj", tetrahedron}}));
  for (const char* file : {"a.obj", "b.obj"})
    EXPECT_TEXT(table, file +
                           std::string("                4 triangles in 1 shell, 1 duplicate triangle left ") +
                           "out, 1 triangle turned over");
}

}  // namespace
}  // namespace silt::testing
