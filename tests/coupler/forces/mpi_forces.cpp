// What acts on bodies besides their weight, on any number of ranks: links in one pass or two, springs, and
// contacts, which give walls and fixed bodies what they take from the free ones.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include "silt/case/case.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/forces/spring_scenes.hpp"
#include "tests/coupler/forces/two_spheres.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

std::uint64_t hash_of(double first, double second, const Overrides& coupling, MPI_Comm comm) {
  Simulation s = two_spheres(first, second, coupling, comm);
  for (int t = 0; t < 40; ++t) s.step();
  return s.hash();
}

TEST(OnePass, MovesHeavyBodiesAsUnderExplicitCouplingWhereMomentumIsExact) {
  EXPECT_EQ(hash_of(heavy, heavy, {implicit, exact, pieces}, MPI_COMM_WORLD),
            hash_of(heavy, heavy, {explicit_, exact, pieces}, MPI_COMM_WORLD));
  for (const double other : {nearly_heavy, light})
    EXPECT_NE(hash_of(heavy, other, {implicit, exact, pieces}, MPI_COMM_WORLD),
              hash_of(heavy, other, {explicit_, exact, pieces}, MPI_COMM_WORLD));
}

TEST(OnePass, SameBitsBesideTwoPassesOnAnyRanksAndBlocks) {
  EXPECT_EQ(hash_of(heavy, light, {implicit, pieces}, MPI_COMM_WORLD), tests::alone([] {
              return hash_of(heavy, light, {implicit, whole}, MPI_COMM_SELF);
            }));
}

TEST(Springs, SameBitsOnAnyRanksAndInARunThatGoesOn) {
  CaseText c = two_balls(0.1);
  c.fluid = "[fluid]\nrelaxation_time = 0.8\n";
  c.rest +=
      "[[springs]]\nbody = \"a\"\nends = [[61, 30, 33], [50, 30, 30]]\nlength = 0\nstiffness = 0.2\ndamping "
      "= 1\n";
  expect_one_hash(c, 60, {"[16, 64, 32]"});
  Simulation simulation = c.start(MPI_COMM_WORLD);
  simulation.run(23);
  expect_goes_on(simulation, 37);
}

struct Total {
  Vec3 momentum = Vec3::Zero(), impulse = Vec3::Zero();
};

/// The momentum of free bodies, and what contacts gave all else in the last step; of all ranks.
Total total(const Simulation& simulation) {
  Total all;
  const rigid::BodySet& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (bodies.is_dynamic(row)) all.momentum += bodies.mass[row] * bodies.velocity[row];
  for (const ContactLoad& load : simulation.contact_loads()) all.impulse += load.impulse;
  for (int d = 0; d < 3; ++d) {
    all.momentum[d] = tests::sum_over_ranks(all.momentum[d]);
    all.impulse[d] = tests::sum_over_ranks(all.impulse[d]);
  }
  return all;
}

/// Balls and bricks that fall past a fixed ball into a box and jump in it, dry.
void expect_momentum_to_be_kept(const std::string& contacts) {
  constexpr double gravity = 2e-4;
  CaseText c;
  c.fluid = "";
  c.domain = domain_of({32, 32, 48}, "\"no-slip\"");
  c.shapes += shape_of("brick", "box", "edges = [5, 3, 3]");
  c.bodies = body_of("ball", 2, "name = \"post\"\nposition = [16, 16, 8]\nmotion = \"fixed\"") +
             fill_of("ball", 2, 12, "gap = 0.5") + fill_of("brick", 1, 12, "gap = 0.5");
  c.rest = fmt::format("[gravity]\nacceleration = [0, 0, -{}]\n[contacts]\n{}", gravity, contacts);
  c.run =
      "[run]\nsteps = 600\n[[quantities]]\nname = \"f\"\ntype = \"contact-force\"\naxis = \"z\"\nbody = "
      "\"post\"\n";
  Simulation simulation = c.start(MPI_COMM_WORLD);
  double mass = 0;
  for (std::size_t row = 0; row < simulation.bodies().owned; ++row)
    if (simulation.bodies().is_dynamic(row)) mass += simulation.bodies().mass[row];
  mass = tests::sum_over_ranks(mass);
  double largest = 0;
  for (int step = 0; step < 600; ++step) {
    const Vec3 before = total(simulation).momentum;
    simulation.step();
    const Total after = total(simulation);
    const Vec3 lost = before + Vec3(0, 0, -mass * gravity) - after.momentum;
    ASSERT_LT((lost - after.impulse).norm(), 1e-12 * mass) << contacts << step;
    largest = std::max(largest, after.impulse.norm());
  }
  EXPECT_GT(largest, 10 * mass * gravity) << "there are impacts";
}

TEST(ContactLoads, AreWhatFreeBodiesLose) {
  for (const char* contacts : {"restitution = 0.3\nfriction = 0.3\n", "restitution = 1\nfriction = 0.2\n",
                               "restitution = 0.8\nfriction = 0.3\nimpact_sweeps = 50\nsubsteps = 3\n",
                               "restitution = 0.5\nsubsteps = 2\n"})
    expect_momentum_to_be_kept(contacts);
}

}  // namespace
}  // namespace silt::coupler::testing
