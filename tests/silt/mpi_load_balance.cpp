// Moving to another cut changes no bit, and what is predicted is what there is.
#include "silt/load_balance.hpp"

#include <gtest/gtest.h>

#include "coupler/balance/body_work.hpp"
#include "coupler/regions/level_views.hpp"
#include "lbm/blocks/equal_cut.hpp"
#include "silt/case/case.hpp"
#include "silt/simulation.hpp"
#include "tests/odd_cut.hpp"
#include "tests/silt/coupled_scenes.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using namespace coupler;

using rigid::Vec3;
using tests::odd_cut;
using tests::ranks;

void throw_about(Simulation& s) {
  for (rigid::BodyId id = 1; id <= s.scene().at_start.body_count; ++id)
    s.set_velocity(
        id, 0.05 * Vec3(std::cos(1.7 * double(id)), std::sin(1.7 * double(id)), std::sin(3.4 * double(id))),
        0.01 * Vec3(std::sin(1.7 * double(id)), 0.3, -0.5));
}

/// The crowd with a force on one of them in every third step, moved to another cut before each step in
/// `moves`.
std::uint64_t hash_of_crowd(MPI_Comm comm, const Overrides& overrides, int every) {
  Simulation s = crowd().start(comm, overrides);
  throw_about(s);
  for (int t = 0; t < 100; ++t) {
    if (t % 3 == 0) s.add_force(1 + t % 14, {0.01, -0.02, 0.01}, {0, 0.01, 0});
    if (every > 0 && t % every == 2) s.repartition(odd_cut(s.scene().domain.cells(), ranks(), 2, t));
    s.step();
  }
  EXPECT_EQ(s.body_count(), 14u);
  return s.hash();
}

TEST(LoadBalance, AMoveChangesNoBit) {
  for (const Overrides& overrides :
       {Overrides{},
        {"fluid.precision=double"},
        {"coupling.force=exact"},
        {"coupling.wall_scheme=parabolic"},
        {"coupling.wall_scheme=cli", "coupling.time=explicit", "fill[0].density=2"}})
    EXPECT_EQ(hash_of_crowd(MPI_COMM_WORLD, overrides, 7),
              tests::alone([&] { return hash_of_crowd(MPI_COMM_SELF, overrides, 0); }))
        << ::testing::PrintToString(overrides);
}

/// An owned body's partners in films have rows on ranks of any cut: the coupling in time asks for their
/// velocities.
TEST(LoadBalance, BodiesBeyondFilmsAreKnown) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Simulation s = crowd().start(MPI_COMM_WORLD);
    throw_about(s);
    s.repartition(odd_cut(s.scene().domain.cells(), ranks(), 2, seed));
    double films = 0;
    for (int t = 0; t < 60; ++t) {
      s.step();
      const rigid::BodySet& bodies = s.bodies();
      for (std::size_t row = 0; row < bodies.owned; ++row)
        for (const rigid::StoredImpulse& impulse : bodies.stored_impulses[row]) {
          if (!(impulse.feature & rigid::lubrication_feature)) continue;
          ++films;
          ASSERT_LT(bodies.row_of(impulse.partner), bodies.size());
        }
    }
    EXPECT_GT(tests::sum_over_ranks(films), 0);
  }
}

/// Spheres in the lowest quarter of a box of 48 cells between two walls.
CaseText bottom() {
  CaseText c;
  c.domain = domain_of({48, 48, 64}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] })");
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  c.shapes = sphere_of("sphere", 6);
  c.bodies = fill_of("sphere", 1.5, 60, "seed = 1\nbox = [[0, 0, 0], [48, 48, 16]]");
  return c;
}

TEST(LoadBalance, BodiesAtTheBottomAreSharedOut) {
  Simulation s = bottom().start(MPI_COMM_WORLD);
  const Evenness start = s.balance_record().at_start;
  EXPECT_LE(start.after, 1.05);
  EXPECT_GE(start.before, ranks() > 1 ? 1.3 : 1.0);
  const CutComparison cuts = compare_cuts(s.scene());
  EXPECT_LE(cuts.better.largest_over_mean(), 1.05);
  EXPECT_NEAR(cuts.present.mean, cuts.better.mean, 1e-9 * cuts.better.mean);
  EXPECT_LE(cuts.present.largest_over_mean(), 1.25);  // the estimate was not far off
}

/// Under the equal cut a look finds the better one and goes there; a second one finds nothing to gain.
TEST(LoadBalance, ALookMovesWhereThatPays) {
  const auto run = [](MPI_Comm comm, std::int64_t every) {
    Case scene = bottom().read();
    scene.balance_every = every;
    Simulation s(scene, comm);
    int here = 1;
    MPI_Comm_size(comm, &here);
    if (here > 1) s.repartition(lbm::equal_cut(s.scene().domain.cells(), here));
    const bool looks = every > 0 && here > 1;
    for (int t = 0; t < 65; ++t) s.step();
    EXPECT_GE(s.balance_record().last.before, looks ? 1.3 : 1.0);
    EXPECT_LE(s.balance_record().last.after, 1.05);
    for (int t = 65; t < 125; ++t) s.step();
    EXPECT_EQ(s.balance_record().looks, looks ? 2u : 0u);
    EXPECT_EQ(s.balance_record().moves, looks ? 1u : 0u);
    return s.hash();
  };
  EXPECT_EQ(run(MPI_COMM_WORLD, 60), tests::alone([&] { return run(MPI_COMM_SELF, 0); }));
}

/// Balls in a corner of a tank whose cells are of three levels.
CaseText corner() {
  CaseText c;
  c.domain = domain_of({64, 96, 128}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] })");
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n[coarsening]\nlevels = 2\ndistance = 6\n";
  c.shapes = sphere_of("sphere", 6);
  c.bodies = body_of("sphere", 1.5, "positions = [[8, 8, 20], [20, 14, 24], [30, 10, 15], [12, 22, 12]]");
  return c;
}

TEST(LoadBalance, AMoveChangesNoBitOfLevels) {
  const auto run = [](MPI_Comm comm, bool moves) {
    Simulation s = corner().start(comm);
    throw_about(s);
    for (int t = 0; t < 64; ++t) {
      if (moves && t % 32 == 0)
        s.repartition(of_cells(odd_cut(tiles_of(s.setup()), ranks(), 2, 1 + t / 32), s.setup()));
      s.step();
    }
    return s.hash();
  };
  EXPECT_EQ(run(MPI_COMM_WORLD, true), tests::alone([&] { return run(MPI_COMM_SELF, false); }));
}

TEST(LoadBalance, CellsOfLevelsAreSharedOut) {
  const auto share_out = [](MPI_Comm comm) {
    const Evenness start = corner().start(comm).balance_record().at_start;
    EXPECT_LE(start.after, start.before);
    return start.after;
  };
  share_out(MPI_COMM_WORLD);
  if (ranks() == 1) return;
  MPI_Comm two;
  MPI_Comm_split(MPI_COMM_WORLD, tests::rank() < 2 ? 0 : MPI_UNDEFINED, tests::rank(), &two);
  if (two == MPI_COMM_NULL) return;
  EXPECT_LE(share_out(two), 1.2);
  MPI_Comm_free(&two);
}

TEST(LoadBalance, EvenScenesKeepTheEqualCut) {
  CaseText c;
  c.domain = domain_of({32, 32, 32});
  c.shapes = c.bodies = "";
  const Simulation s = c.start(MPI_COMM_WORLD);
  const lbm::CutTree equal = lbm::equal_cut({32, 32, 32}, ranks());
  for (int k = 0; k < ranks(); ++k) EXPECT_EQ(s.scene().domain.block(k).box.lower, equal.leaf(k).box.lower);
}

/// Costs by which work counts one thing.
WorkCosts only(std::int64_t WorkCosts::*part) {
  const Case setup = bottom().read();
  WorkCosts costs(setup, setup.contacts.substeps);
  costs.cell = costs.link = costs.mapping = costs.body = costs.impulse = 0;
  costs.*part = 1;
  return costs;
}

std::uint64_t sum(const WorkMap& work) {
  double mine = 0;
  for (const WorkItem& item : work.items()) mine += double(item.work);
  return std::uint64_t(tests::sum_over_ranks(mine));
}

void add_mapped(const Scene& scene, const WorkCosts& costs, WorkMap& work) {
  for (const BlockMap& map : scene.flow->fields().maps())
    coupler::add_mapped(map, scene.bodies, scene.world, costs, work);
}

TEST(LoadBalance, LinksAndBodiesAreCounted) {
  Simulation s = bottom().start(MPI_COMM_WORLD);
  s.step();
  const Scene& scene = s.scene();
  WorkMap links(scene.domain), bodies(scene.domain), estimate(scene.domain);
  add_mapped(scene, only(&WorkCosts::link), links);
  add_bodies(scene.bodies, only(&WorkCosts::body), bodies);
  EXPECT_EQ(sum(links), s.links());
  EXPECT_EQ(sum(bodies), 60u);
  WorkCosts costs = only(&WorkCosts::link);
  costs.cell = 1;  // there is a fluid
  add_surfaces(scene.bodies, scene.world, costs, estimate);
  EXPECT_NEAR(double(sum(estimate)), double(s.links()), 0.05 * double(s.links()));
}

/// Returns the cost of mapping in a step if a link costs 1000 each time, over the number of links.
double mapping_of_a_link(double speed) {
  Simulation s = bottom().start(MPI_COMM_WORLD);
  for (int t = 0; t < 10; ++t) {  // past the first common one of nine
    for (rigid::BodyId id = 1; id <= s.scene().at_start.body_count; ++id)
      s.set_velocity(id, {0, 0, speed}, {0, 0, 0});
    s.step();
  }
  WorkCosts costs = only(&WorkCosts::mapping);
  costs.mapping = 1000;
  WorkMap work(s.scene().domain);
  add_mapped(s.scene(), costs, work);
  return double(sum(work)) / double(s.links());
}

TEST(LoadBalance, MappingIsCountedAsOftenAsItComes) {
  EXPECT_NEAR(mapping_of_a_link(0.15), 1000, 50);
  EXPECT_NEAR(mapping_of_a_link(0.05), 1000. / 3, 50. / 3);
  EXPECT_NEAR(mapping_of_a_link(0.01), 1000. / 9, 50. / 9);
}

}  // namespace
}  // namespace silt::testing
