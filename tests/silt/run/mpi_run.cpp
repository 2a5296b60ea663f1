// The whole run as a library: the same bits on any number of ranks and block layout, across a checkpoint, and
// whatever a program does to bodies between steps; and signals, which stop all ranks after the same step.
#include <gtest/gtest.h>
#include <mpi.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "silt/case/case.hpp"
#include "silt/guard.hpp"
#include "silt/results/report.hpp"
#include "silt/run/stop_request.hpp"
#include "tests/errors.hpp"
#include "tests/silt/coupled_scenes.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using rigid::Vec3;
using tests::alone;
using Clock = std::chrono::steady_clock;

constexpr const char *small_blocks = "[6, 10, 7]", *in_small_blocks = "domain.blocks=[6, 10, 7]";

/// The crowd in one precision or the other, watched.
CaseText crowd(const std::string& precision) {
  CaseText c = silt::testing::crowd();
  c.fluid += "precision = \"" + precision + "\"\n";
  c.run =
      "[run]\nsteps = 500\n[[quantities]]\nname = \"height\"\ntype = \"mean-height\"\n"
      "[[quantities]]\nname = \"speed\"\ntype = \"max-speed\"\n";
  return c;
}

CaseText dry_crowd() {
  CaseText c = crowd("single");
  c.fluid.clear();
  return c;
}

CaseText pure_fluid() {
  CaseText c;
  c.domain = domain_of(
      {20, 16, 24},
      R"({ x = "periodic", y = ["no-slip", { type = "moving", velocity = [0.02, 0, 0] }], z = ["free-slip", "no-slip"] })");
  c.fluid =
      "[fluid]\nrelaxation_time = 0.7\nbody_force = [1e-5, 0, 2e-5]\n"
      "initial = { type = \"uniform\", velocity = [0.01, 0.02, 0] }\n";
  c.shapes.clear();
  c.bodies.clear();
  return c;
}

std::uint64_t hash_after(Simulation&& simulation, std::int64_t steps) {
  simulation.run(steps);
  return simulation.hash();
}

TEST(Run, PureFluidHasOneHash) {
  expect_one_hash(pure_fluid(), 101, {small_blocks});
}

// ---- checkpoints ----

std::uint64_t resumed_hash(const Saved& saved, const Case& scene, MPI_Comm comm, std::int64_t steps,
                           double* speed = nullptr) {
  const auto going_on = saved.go_on(scene, comm);
  Simulation& simulation = *going_on;
  Quantities quantities(scene);
  quantities.set_history(read_history(saved.reader(comm), scene));
  simulation.run(steps - simulation.steps_done());
  if (speed) *speed = quantities.evaluate(simulation)[1].second;
  return simulation.hash();
}

void expect_resume_is_exact(const CaseText& text, std::int64_t odd, std::int64_t steps) {
  Simulation simulation = text.start(MPI_COMM_WORLD, {in_small_blocks}), whole = text.start(MPI_COMM_WORLD);
  const Case &scene = simulation.setup(), &uncut = whole.setup();
  Quantities quantities(scene);
  for (int i = 0; i < odd; ++i) {
    simulation.step();
    quantities.observe(simulation);
  }
  const double speed = quantities.evaluate(simulation)[1].second;
  const Saved saved(simulation, quantities);
  simulation.run(steps - odd);
  const std::uint64_t uninterrupted = simulation.hash();

  double speed_again = 0;
  EXPECT_EQ(resumed_hash(saved, scene, MPI_COMM_WORLD, steps, &speed_again), uninterrupted);
  EXPECT_EQ(speed_again, speed);
  EXPECT_EQ(resumed_hash(saved, uncut, MPI_COMM_WORLD, steps), uninterrupted) << "other blocks";
  EXPECT_EQ(alone([&] { return resumed_hash(saved, uncut, MPI_COMM_SELF, steps); }), uninterrupted)
      << "one rank";
}

TEST(Run, ResumesToTheBit) {
  expect_resume_is_exact(crowd("single"), 151, 200);
}
TEST(Run, ResumesToTheBitInExplicitAndExactForm) {
  CaseText text = crowd("double");
  text.rest += "[coupling]\nforce = \"exact\"\ntime = \"explicit\"\nwall_scheme = \"bounce-back\"\n";
  text.bodies.replace(text.bodies.find("density = 0.7"), 13, "density = 4.0");  // would run away
  expect_resume_is_exact(text, 33, 60);
}
TEST(Run, ResumesDry) {
  expect_resume_is_exact(dry_crowd(), 151, 200);
}

// ---- what a program does between steps ----

std::uint64_t steered_hash(Simulation&& simulation) {
  for (int step = 0; step < 40; ++step) {
    simulation.add_force(3, Vec3(0.01, 0, 0.02), Vec3(0, 0.01, 0));
    if (step == 10) simulation.set_velocity(7, Vec3(0.05, -0.03, 0.02), Vec3(0, 0, 0.01));
    if (step == 20) {
      rigid::Pose pose;
      pose.position = Vec3(23, 19, 12);  // across the domain, over two of its periodic borders
      simulation.set_pose(1, pose);
    }
    simulation.step();
  }
  return simulation.hash();
}

TEST(Run, WhatAProgramDoesIsTheSameOnAnyRanks) {
  CaseText text = crowd("single");
  text.bodies.clear();  // far apart, so that body 1 finds room
  for (const char* x :
       {"5, 5, 5", "17, 5, 5", "5, 17, 5", "17, 17, 5", "5, 5, 19", "17, 5, 19", "5, 17, 19", "17, 17, 19"})
    text.bodies += std::string("[[bodies]]\nshape = \"sphere\"\ndensity = 1.5\nposition = [") + x + "]\n";
  const std::uint64_t one = alone([&] { return steered_hash(text.start(MPI_COMM_SELF)); });
  EXPECT_EQ(steered_hash(text.start(MPI_COMM_WORLD, {in_small_blocks})), one);
  const std::uint64_t unsteered = hash_after(text.start(MPI_COMM_WORLD), 40);
  EXPECT_NE(unsteered, one);
}

/// Two balls a fifth of a cell apart, one of which is put far away: the film between them is gone, on one
/// rank and where the other's rank no longer knows it.
TEST(Run, ABodyMovedAwayLeavesItsFilmsBehind) {
  CaseText text = crowd("single");
  text.bodies.clear();
  for (const char* x : {"5, 5, 5", "11.2, 5, 5"})
    text.bodies += std::string("[[bodies]]\nshape = \"sphere\"\ndensity = 1.5\nposition = [") + x + "]\n";
  const auto moved_hash = [](Simulation&& simulation, MPI_Comm comm) {
    for (int step = 0; step < 10; ++step) {
      if (step == 5) {
        double films = 0;
        const rigid::BodySet& bodies = simulation.bodies();
        for (std::size_t row = 0; row < bodies.owned; ++row)
          films += double(bodies.stored_impulses[row].size());
        MPI_Allreduce(MPI_IN_PLACE, &films, 1, MPI_DOUBLE, MPI_SUM, comm);
        EXPECT_GT(films, 0);
        simulation.set_pose(2, {Vec3(17, 17, 17), rigid::Quat::Identity()});
      }
      simulation.step();
    }
    return simulation.hash();
  };
  const std::uint64_t one = alone([&] { return moved_hash(text.start(MPI_COMM_SELF), MPI_COMM_SELF); });
  EXPECT_EQ(moved_hash(text.start(MPI_COMM_WORLD, {in_small_blocks}), MPI_COMM_WORLD), one);
}

TEST(Run, ABodyThatIsNotThereIsAnError) {
  Simulation simulation = crowd("single").start(MPI_COMM_WORLD);
  EXPECT_THROW(simulation.add_force(15, Vec3::Zero()), std::invalid_argument);
  EXPECT_THROW(simulation.set_velocity(0, Vec3::Zero(), Vec3::Zero()), std::invalid_argument);
}

TEST(Run, AFixedBodyLeavesNoForceBehind) {
  CaseText text;
  text.fluid = "[fluid]\nrelaxation_time = 0.8\nbody_force = [1e-4, 0, 0]\n";
  text.bodies = body_of("ball", 1, "motion = \"fixed\"\nposition = [16.2, 16, 16]");
  Simulation simulation = text.start(MPI_COMM_WORLD);
  simulation.run(50);
  EXPECT_EQ(simulation.scene().rigid_step, nullptr);
  double force = 0;
  for (const coupler::BodyLoad& load : simulation.last_loads()) force += load.force[0];
  force = tests::sum_over_ranks(force);
  EXPECT_GT(force, 0.01);
  EXPECT_LT(force, 1.0) << "one step's force, not the sum of all steps";
}

TEST(StopRequest, is_heard_when_steps_become_a_thousand_times_as_long) {
  catch_signals();
  std::int64_t step = 0;
  {
    StopRequest request(MPI_COMM_WORLD, 0);
    while (step < 5000) {
      std::this_thread::sleep_for(std::chrono::microseconds(20));
      ASSERT_EQ(request.why(++step), "");
    }
    if (tests::rank() == tests::ranks() - 1) std::raise(SIGUSR1);
    const auto told = Clock::now();
    std::string why;
    while (why.empty() && step < 5200) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      why = request.why(++step);
    }
    EXPECT_EQ(why, "told to stop by SIGUSR1");
    EXPECT_LT(std::chrono::duration<double>(Clock::now() - told).count(), 2);
  }
  std::int64_t first = step, last = step;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT64_T, MPI_MIN, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &last, 1, MPI_INT64_T, MPI_MAX, MPI_COMM_WORLD);
  EXPECT_EQ(first, last);
}

}  // namespace
}  // namespace silt::testing
