// A run that begins where another one has ended, with other parameters.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>

#include "coupler/results/build_info.hpp"
#include "coupler/results/checkpoint.hpp"
#include "tests/adapters/hdf5/scratch.hpp"
#include "tests/coupler/coupled_scenes.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

/// Where a run of a case has ended after some steps: its checkpoint.
struct Ended {
  tests::Scratch scratch;
  std::filesystem::path path;
  std::uint64_t fluid = 0;
  std::vector<double> bodies;  // velocities along x of bodies 1 and 2, on every rank

  Ended(const CaseText& text, int steps) {
    const Case scene = text.read();
    Simulation simulation(scene, MPI_COMM_WORLD);
    simulation.run(steps);
    path = write_checkpoint(simulation, Quantities(scene), scratch.path(),
                            provenance_of(scene, tests::ranks(), "auto"), {});
    if (scene.fluid) fluid = hash_of_fluid(simulation);
    for (const rigid::BodyId id : {1, 2}) bodies.push_back(speed(simulation, id));
  }
  static std::uint64_t hash_of_fluid(const Simulation& simulation) {
    std::uint64_t all = 0;
    const std::uint64_t mine = simulation.scene().flow->fields().hash();
    MPI_Allreduce(&mine, &all, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    return all;
  }
  static double speed(const Simulation& simulation, rigid::BodyId id) {
    const std::size_t row = simulation.bodies().row_of(id);
    return tests::sum_over_ranks(row < simulation.bodies().owned ? simulation.bodies().velocity[row][0] : 0);
  }
  std::unique_ptr<Simulation> start(CaseText text, MPI_Comm comm = MPI_COMM_WORLD,
                                    const Overrides& overrides = {}) const {
    text.rest += "[initial]\nfrom = \"other\"\n";
    const adapters::CheckpointReader reader(comm, path);
    return simulation_from(reader, text.read(overrides), comm);
  }
};

/// The same bodies, from there.
CaseText followers() {
  CaseText c = free_spheres();
  c.bodies = body_of("sphere", 2, "");
  return c;
}

TEST(StartFrom, TheSameParametersTakeTheSameFluidAndBodies) {
  const Ended other(free_spheres(), 40);
  const auto start = other.start(followers());
  EXPECT_EQ(start->steps_done(), 0);
  EXPECT_EQ(Ended::hash_of_fluid(*start), other.fluid);
  EXPECT_EQ(Ended::speed(*start, 1), other.bodies[0]);
  EXPECT_EQ(start->body_count(), 3u);
}

/// Half as long steps, another density of the fluid, another viscosity.
TEST(StartFrom, OtherUnitsKeepVelocityPressureAndRateOfStrain) {
  CaseText c;
  c.units = "[units]\nsystem = \"si\"\ncell_size = 1e-3\ntime_step = 1e-3\n";
  c.domain = "[domain]\nsize = [0.016, 0.016, 0.016]\nboundary = \"periodic\"\n";
  c.fluid =
      "[fluid]\ndensity = 1000\nkinematic_viscosity = 1e-4\nprecision = \"double\"\ninitial = { type = "
      "\"taylor-green-3d\", "
      "velocity = [0.02, 0, 0] }\n";
  c.shapes = "[[shapes]]\nname = \"ball\"\ntype = \"sphere\"\ndiameter = 6e-3\n";
  c.bodies = body_of("ball", 1200,
                     "positions = [[0.004, 0.004, 0.004], [0.012, 0.011, 0.012]]\nvelocity = [0.01, 0, 0]");
  const Ended other(c, 60);
  const Case before_case = c.read();
  const adapters::CheckpointReader reader(MPI_COMM_WORLD, other.path);
  const auto before = resumed_simulation(reader, before_case, MPI_COMM_WORLD);
  CaseText next = c;
  next.units = "[units]\nsystem = \"si\"\ncell_size = 1e-3\ntime_step = 5e-4\n";
  next.fluid = "[fluid]\ndensity = 800\nkinematic_viscosity = 3e-4\nprecision = \"double\"\n";
  next.bodies = body_of("ball", 2000, "");
  const auto after = other.start(next);
  const FlowTotals was = before->scene().flow->account().totals(),
                   is = after->scene().flow->account().totals();
  EXPECT_EQ(was.fluid_cells, is.fluid_cells);
  EXPECT_NEAR(is.energy, was.energy / 4, 1e-9 * was.energy);
  EXPECT_NEAR(is.max_density - 1, (was.max_density - 1) / 4 / 0.8, 1e-9);
  EXPECT_NEAR(Ended::speed(*after, 1), other.bodies[0] / 2, 1e-15);
  const auto stress = [](const Simulation& simulation) {  // twice the viscosity times the rate of strain
    double sum = 0;
    const FluidFields& fields = simulation.scene().flow->fields();
    for_each_fluid_cell(fields, [&](lbm::Int3, const lbm::Moments& m) {
      const auto u = fields.velocity(m);
      const double off = m.flux[3] - u[0] * u[1];
      sum += off * off;
    });
    return std::sqrt(tests::sum_over_ranks(sum)) / fields.spec().relaxation_time;
  };
  EXPECT_NEAR(stress(*after), stress(*before) / 2, 1e-9 * stress(*before));
}

CaseText arrivals() {
  CaseText c = followers();
  c.fluid = "[fluid]\nrelaxation_time = 0.7\nprecision = \"double\"\n";
  c.shapes += sphere_of("small", 4);
  c.bodies += fill_of("small", 1.5, 6, "gap = 0.2");
  return c;
}

TEST(StartFrom, AddedBodiesFindRoomAndAllIsTheSameOnAnyRanks) {
  const Ended other(free_spheres(), 30);
  const auto hash = [&](MPI_Comm comm, const std::string& blocks) {
    const auto start =
        other.start(arrivals(), comm, {"domain.blocks=" + blocks, "initial.random_velocity=0.01"});
    EXPECT_EQ(start->body_count(), 9u);
    EXPECT_EQ(start->next_id(), 10u);
    start->run(20);
    return start->hash();
  };
  const std::uint64_t alone = tests::alone([&] { return hash(MPI_COMM_SELF, "[24, 24, 24]"); });
  EXPECT_EQ(hash(MPI_COMM_WORLD, "[12, 12, 12]"), alone);
  const auto still = other.start(arrivals()),
             stirred = other.start(arrivals(), MPI_COMM_WORLD, {"initial.random_velocity=0.01"});
  EXPECT_EQ(Ended::speed(*still, 2), other.bodies[1]);
  EXPECT_NE(Ended::speed(*stirred, 2), other.bodies[1]);
  EXPECT_NEAR(Ended::speed(*stirred, 2), other.bodies[1], 0.01);
}

TEST(StartFrom, ADryPackingIsFloodedAndTheRunGoesOnToTheSameBits) {
  CaseText dry = crowd();
  dry.fluid = "";
  const Ended other(dry, 50);
  CaseText wet = crowd();
  wet.bodies = body_of("sphere", 1.4, "") + body_of("star", 3, "") + body_of("box", 4, "motion = \"fixed\"");
  const auto start = other.start(wet);
  start->run(15);
  const tests::Scratch scratch;
  const Case scene = start->setup();
  const auto path = write_checkpoint(*start, Quantities(scene), scratch.path(),
                                     provenance_of(scene, tests::ranks(), "auto"), {});
  start->run(15);
  const adapters::CheckpointReader reader(MPI_COMM_WORLD, path);
  const auto again = resumed_simulation(reader, scene, MPI_COMM_WORLD);
  again->run(15);
  EXPECT_EQ(again->hash(), start->hash());
}

TEST(StartFrom, WhatDoesNotFitIsRefused) {
  const Ended other(free_spheres(), 10);
  const auto error = [&](const std::function<void(CaseText&)>& change) -> std::string {
    CaseText c = followers();
    change(c);
    try {
      other.start(c);
    } catch (const std::runtime_error& found) {
      return found.what();
    }
    return "";
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(error([](CaseText& c) { c.bodies = body_of("sphere", 2, "name = \"ball\""); }),
      "it has bodies 'sphere', of which the case has no entry; give [[bodies]] of that name without "
      "positions");
  has(error([](CaseText& c) { c.shapes = sphere_of("sphere", 6); }),
      "has not the shape that the case gives 'sphere'");
  has(error([](CaseText& c) { c.domain = domain_of({24, 24, 28}); }), "of another lattice than the case's");
  has(error([](CaseText& c) {
        c.units = "[units]\nsystem = \"si\"\ncell_size = 0.5\ntime_step = 1\n";
        c.domain = "[domain]\nsize = [12, 12, 12]\nboundary = \"periodic\"\n";
        c.shapes = sphere_of("sphere", 3.5);
        c.fluid = "[fluid]\ndensity = 1\nkinematic_viscosity = 0.1\nprecision = \"double\"\n";
      }),
      "its cells are 1 wide, those of the case 0.5; they must be of one size");
  EXPECT_NE(followers()
                .fault({"initial.from=other", "coarsening.levels=1"})
                .find("initial.from gives all cells of one level"),
            std::string::npos);
}

}  // namespace
}  // namespace silt::coupler::testing
