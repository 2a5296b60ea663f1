// Runs that begin with the end of another run, with other parameters.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <tuple>

#include "rigid/shapes/shape.hpp"
#include "silt/case/case_file.hpp"
#include "silt/results/checkpoint.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/coupled_scenes.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using namespace coupler;

/// The checkpoint with which a run of a case has ended after some steps.
struct Ended {
  std::unique_ptr<Saved> saved;
  std::uint64_t fluid = 0;
  std::vector<double> bodies;  // velocities along x of bodies 1 and 2, on every rank

  Ended(const CaseText& text, int steps) {
    Simulation simulation = text.start(MPI_COMM_WORLD);
    simulation.run(steps);
    saved = std::make_unique<Saved>(simulation);
    if (simulation.setup().fluid) fluid = hash_of_fluid(simulation);
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
  static double temperature(const Simulation& simulation, rigid::BodyId id) {
    const std::size_t row = simulation.bodies().row_of(id);
    const bool is_mine = row < simulation.bodies().owned;
    return tests::sum_over_ranks(is_mine ? coupling_of(simulation.bodies(), row).temperature.numbers[0] : 0);
  }
  std::unique_ptr<Simulation> start(CaseText text, MPI_Comm comm = MPI_COMM_WORLD,
                                    const Overrides& overrides = {}) const {
    text.rest += "[initial]\nfrom = \"other\"\n";
    return simulation_from(saved->reader(comm), text.read(overrides), comm);
  }
};

/// Returns a case with these bodies, whose positions come from there.
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

const std::string warm = "temperature = 3\nheat_capacity = 800\n";

/// A vortex, and two warm balls in it.
CaseText fluid_of_a_vortex(bool with_bodies) {
  CaseText c;
  c.units = "[units]\nsystem = \"si\"\ncell_size = 1e-3\ntime_step = 1e-3\n";
  c.domain = "[domain]\nsize = [0.016, 0.016, 0.016]\nboundary = \"periodic\"\n";
  c.fluid =
      "[fluid]\ndensity = 1000\nkinematic_viscosity = 1e-4\nprecision = \"double\"\n"
      "initial = { type = \"taylor-green-3d\", velocity = [0.02, 0, 0] }\n";
  c.shapes = c.bodies = "";
  if (!with_bodies) return c;
  c.rest = "[heat]\nthermal_diffusivity = 2e-4\nheat_capacity = 4000\n";
  c.shapes = shape_of("ball", "sphere", "diameter = 6e-3");
  c.bodies =
      body_of("ball", 1200,
              "positions = [[0.004, 0.004, 0.004], [0.012, 0.011, 0.012]]\nvelocity = [0.01, 0, 0]\n" + warm);
  return c;
}

double mean_temperature(const Simulation& simulation) {
  double heat = 0, cells = 0;
  const FluidFields& fields = simulation.scene().flow->fields();
  for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3) {
    if (fields.is_fluid(b, x)) heat += fields.temperature(b, x), ++cells;
  });
  return tests::sum_over_ranks(heat) / tests::sum_over_ranks(cells);
}

/// Half as long steps, another density of the fluid, another viscosity.
TEST(StartFrom, OtherUnitsKeepVelocityPressureAndRateOfStrain) {
  const CaseText c = fluid_of_a_vortex(true);
  const Ended other(c, 60);
  const auto before = other.saved->go_on(c.read());
  CaseText next = c;
  next.units = "[units]\nsystem = \"si\"\ncell_size = 1e-3\ntime_step = 5e-4\n";
  next.fluid = "[fluid]\ndensity = 800\nkinematic_viscosity = 3e-4\nprecision = \"double\"\n";
  next.bodies = body_of("ball", 2000, "");
  const auto after = other.start(next);
  const FlowTotals was = before->scene().flow->totals(), is = after->scene().flow->totals();
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

/// Cells half as wide, and two thirds: mean energy and pressure of the vortex, and the bodies and their
/// temperatures, are what they were, and so are the bits on any ranks.
TEST(StartFrom, NarrowerCellsKeepTheFlow) {
  for (const bool with_bodies : {false, true}) {
    const CaseText c = fluid_of_a_vortex(with_bodies);
    const Ended other(c, 20);
    const auto before = other.saved->go_on(c.read());
    const FlowTotals was = before->scene().flow->totals();
    for (const auto& [size, step, factor] :
         {std::tuple("5e-4", "2.5e-4", 0.5), {"0.66666666666666667e-3", "5e-4", 0.75}}) {
      CaseText next = c;
      next.units =
          std::string("[units]\nsystem = \"si\"\ncell_size = ") + size + "\ntime_step = " + step + "\n";
      next.fluid = "[fluid]\ndensity = 1000\nkinematic_viscosity = 1e-4\n";  // single precision
      if (with_bodies) next.bodies = body_of("ball", 1200, warm);
      const auto hash = [&](MPI_Comm comm, const std::string& blocks) {
        const auto start = other.start(next, comm, {"domain.blocks=" + blocks});
        const FlowTotals is = start->scene().flow->totals();
        EXPECT_NEAR(is.energy / double(is.fluid_cells) / (was.energy / double(was.fluid_cells)),
                    factor * factor, with_bodies ? 0.1 : 0.005);
        if (!with_bodies) {
          EXPECT_NEAR((is.max_density - 1) / (was.max_density - 1), factor * factor, 0.1 * factor * factor);
        }
        if (with_bodies && comm == MPI_COMM_WORLD) {
          EXPECT_NEAR(Ended::speed(*start, 1), factor * other.bodies[0], 1e-12);
          EXPECT_EQ(Ended::temperature(*start, 1), Ended::temperature(*before, 1));
          EXPECT_NEAR(mean_temperature(*start) / mean_temperature(*before), 1, 0.1);
        }
        start->run(4);
        return start->hash();
      };
      const std::uint64_t alone = tests::alone([&] { return hash(MPI_COMM_SELF, "\"auto\""); });
      EXPECT_EQ(hash(MPI_COMM_WORLD, "[6, 12, 8]"), alone);
      expect_goes_on(*other.start(next), 3);
    }
  }
}

/// Fluid at rest between sides of 1 and 5 K.
CaseText conduction(const std::string& units, const std::string& heat) {
  CaseText c;
  c.units = "[units]\nsystem = \"si\"\n" + units;
  c.domain =
      "[domain]\nsize = [0.004, 0.004, 0.016]\nboundary = { x = \"periodic\", y = \"periodic\", "
      "z = [{ type = \"no-slip\", temperature = 1 }, { type = \"no-slip\", temperature = 5 }] }\n";
  c.fluid = "[fluid]\ndensity = 1000\nkinematic_viscosity = 1e-4\nprecision = \"double\"\n";
  c.rest = "[heat]\nheat_capacity = 4000\n" + heat;
  c.shapes = c.bodies = "";
  return c;
}

/// Temperatures along a line, and the flux of heat that the populations have at such a gradient, whatever the
/// reference, the diffusivity, the step and the width of cells.
TEST(StartFrom, TheTemperatureKeepsItsGradient) {
  const std::string wide = "cell_size = 1e-3\ntime_step = 1e-3\n";
  const Ended other(conduction(wide, "thermal_diffusivity = 2e-4\ntemperature = 3\n"), 3000);
  for (const auto& [units, heat] :
       {std::pair(wide, "thermal_diffusivity = 2e-4\ntemperature = 2\n"),
        {"cell_size = 1e-3\ntime_step = 5e-4\n", "thermal_diffusivity = 3e-4\ntemperature = 3\n"},
        {"cell_size = 5e-4\ntime_step = 5e-4\n", "thermal_diffusivity = 5e-5\ntemperature = 0\n"}}) {
    const auto start = other.start(conduction(units, heat));
    const FluidFields& fields = start->scene().flow->fields();
    const int height = start->setup().cells[2];
    const double gradient = 4. / height, lag = start->setup().heat->relaxation_time() / 4;
    for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3 global) {
      if (4 * global.z < height || 4 * global.z >= 3 * height) return;  // sides need some steps
      const auto g = [&](int i) { return arriving(fields, b, x, lbm::D3Q19::directions + i); };
      EXPECT_NEAR(fields.temperature(b, x), 1 + gradient * (global.z + 0.5), 1e-8);
      EXPECT_NEAR(g(5) - g(6), -lag * gradient, 1e-8);
    });
  }
}

/// Where the other run has no temperature, the fluid has that of the case; one that the case does not ask for
/// is left behind.
TEST(StartFrom, ATemperatureComesOrIsLeft) {
  CaseText cold = free_spheres(), hot = cold, next = followers();
  const std::string heat = "[heat]\nthermal_diffusivity = 0.1\ninitial = 2\n";
  hot.rest += heat;
  const Ended without(cold, 20), with(hot, 20);
  EXPECT_EQ(Ended::hash_of_fluid(*with.start(next)), without.fluid);
  next.rest += heat;
  EXPECT_EQ(Ended::hash_of_fluid(*with.start(next)), with.fluid);
  const auto start = without.start(next);
  EXPECT_NEAR(mean_temperature(*start), 2, 1e-12);
  start->run(5);
  EXPECT_NEAR(mean_temperature(*start), 2, 1e-3);
  expect_goes_on(*start, 5);
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
    const auto start = other.start(arrivals(), comm, {"domain.blocks=" + blocks});
    EXPECT_EQ(start->body_count(), 9u);
    EXPECT_EQ(start->next_id(), 10u);
    start->run(20);
    return start->hash();
  };
  const std::uint64_t alone = tests::alone([&] { return hash(MPI_COMM_SELF, "[24, 24, 24]"); });
  EXPECT_EQ(hash(MPI_COMM_WORLD, "[12, 12, 12]"), alone);
  EXPECT_EQ(Ended::speed(*other.start(arrivals()), 2), other.bodies[1]);
}

TEST(StartFrom, ADryPackingIsFloodedAndTheRunGoesOnToTheSameBits) {
  CaseText dry = crowd();
  dry.fluid = "";
  const Ended other(dry, 50);
  CaseText wet = crowd();
  wet.bodies = body_of("sphere", 1.4, "") + body_of("star", 3, "") + body_of("box", 4, "motion = \"fixed\"");
  const auto start = other.start(wet);
  start->run(15);
  expect_goes_on(*start, 15);
}

/// A bed finds room before it: the fluid of a longer domain knows it at its new place.
TEST(StartFrom, ADryPackingIsShifted) {
  CaseText dry = free_spheres();
  dry.fluid = "", dry.rest = "";
  const Ended other(dry, 5);
  CaseText wet = followers();
  wet.domain = domain_of({24, 24, 36});
  const auto start = other.start(wet, MPI_COMM_WORLD, {"initial.position=[0, 0, 7]"});
  const auto height = [](const Simulation& s) {
    const std::size_t row = s.bodies().row_of(1);
    return tests::sum_over_ranks(row < s.bodies().owned ? s.bodies().position[row][2] : 0);
  };
  const auto there = other.saved->go_on(dry.read());
  EXPECT_EQ(height(*start), height(*there) + 7);
  start->run(10);
  expect_goes_on(*start, 10);
  EXPECT_TEXT(tests::error_of<std::runtime_error>(
                  [&] { other.start(wet, MPI_COMM_WORLD, {"initial.position=[0, 0, 30]"}); }),
              "outside of the 24 x 24 x 36 cells");
  EXPECT_TEXT(tests::error_of<std::runtime_error>([&] {
                Ended(free_spheres(), 5).start(followers(), MPI_COMM_WORLD, {"initial.position=[0, 0, 1]"});
              }),
              "it has a fluid, which initial.position cannot shift");
}

/// The bodies of a fill keep their sizes under another viscosity, and the shape of the case, which no body
/// has, may be of any size.
TEST(StartFrom, BodiesOfManySizesGoOn) {
  const std::string sizes = "diameter = { smallest = 4, largest = 7 }\n";
  CaseText first = crowd();
  first.shapes = sphere_of("bead", 5);
  first.bodies = fill_of("bead", 2, 12, "gap = 0.2\n" + sizes);
  const Ended other(first, 20);
  CaseText next = first;
  next.fluid = "[fluid]\nrelaxation_time = 0.9\n";
  next.shapes = sphere_of("bead", 3);
  next.bodies = body_of("bead", 2, sizes);
  const auto volume = [](const Simulation& s) {
    double sum = 0;
    for (std::size_t row = 0; row < s.bodies().owned; ++row)
      sum += rigid::mass_properties(s.setup().shapes[s.bodies().shape[row]]).volume;
    return tests::sum_over_ranks(sum);
  };
  const auto start = other.start(next);
  EXPECT_EQ(start->body_count(), 12u);
  EXPECT_NEAR(volume(*start), volume(*other.saved->go_on(first.read())), 1e-9);
  start->run(10);
  expect_goes_on(*start, 10);
  next.bodies = body_of("bead", 2, "diameter = { smallest = 4, largest = 6 }");
  EXPECT_TEXT(tests::error_of<std::runtime_error>([&] { other.start(next); }),
              "has not the shape that the case gives 'bead', nor one of its sizes");
}

TEST(StartFrom, WhatDoesNotFitIsRefused) {
  const Ended other(free_spheres(), 10);
  const auto error = [&](const std::function<void(CaseText&)>& change) -> std::string {
    CaseText c = followers();
    change(c);
    return tests::error_of<std::runtime_error>([&] { other.start(c); });
  };
  EXPECT_TEXT(error([](CaseText& c) { c.bodies = body_of("sphere", 2, "name = \"ball\""); }),
              "it has bodies 'sphere', of which the case has no entry; give [[bodies]] of that name without "
              "positions");
  EXPECT_TEXT(error([](CaseText& c) { c.shapes = sphere_of("sphere", 6); }),
              "has not the shape that the case gives 'sphere'");
  EXPECT_TEXT(error([](CaseText& c) {
                c.domain = domain_of({24, 24, 28});
              }),
              "of another lattice than the case's");
  EXPECT_TEXT(error([](CaseText& c) {
                c.fluid = c.rest = "";
                c.domain = domain_of({24, 24, 12});
              }),
              "outside of the 24 x 24 x 12 cells of the case; enlarge domain.size");
  EXPECT_TEXT(error([](CaseText& c) {
                c.units = "[units]\nsystem = \"si\"\ncell_size = 0.5\ntime_step = 1\n";
                c.domain = domain_of({12, 12, 12});
                c.shapes = sphere_of("sphere", 3.5);
                c.fluid = "[fluid]\ndensity = 1\nkinematic_viscosity = 0.1\nprecision = \"double\"\n";
              }),
              "its domain has 24 x 24 x 24 cells, each as wide as 2 of the case, which has 24 x 24 x 24; the "
              "domains must be of one size");
  EXPECT_TEXT(followers().fault({"initial.from=other", "coarsening.levels=1"}),
              "initial.from gives all cells of one level");
}

}  // namespace
}  // namespace silt::testing
