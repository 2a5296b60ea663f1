// A block that a body fills takes no part in the passes, and the fluid beside it does not notice.
#include <gtest/gtest.h>

#include "coupler/simulation.hpp"
#include "tests/coupler/case/case_text.hpp"

namespace silt::coupler::testing {
namespace {

/// A box that leaves a channel of 16 cells, driven along x; cut across y into `blocks` cells.
Simulation channel_beside_a_box(const std::string& motion, const std::string& blocks) {
  CaseText c;
  c.domain = domain_of({16, 32, 64}, R"({ x = "periodic", y = ["no-slip", "no-slip"], z = "periodic" })");
  c.fluid = "[fluid]\nrelaxation_time = 0.7\nbody_force = [1e-4, 0, 0]\n";
  c.shapes = shape_of("box", "box", "edges = [15.9, 15.9, 63.9]");
  c.bodies = body_of("box", 2, "position = [8, 24, 32]\n" + motion);
  return c.start(MPI_COMM_WORLD, {"domain.blocks=" + blocks});
}

constexpr const char* whole = "[16, 32, 8]";   // fluid in every block
constexpr const char* halves = "[16, 16, 8]";  // the upper ones are full

TEST(IdleBlock, FluidBesideItIsTheSame) {
  const std::string fixed = "motion = \"fixed\"",
                    moving = "motion = \"prescribed\"\nvelocity = [0, -0.03, 0]";
  for (const std::string& motion : {fixed, moving}) {  // moving: cells come free, the blocks wake up
    Simulation a = channel_beside_a_box(motion, whole), b = channel_beside_a_box(motion, halves);
    for (int t = 0; t < 40; ++t) a.step(), b.step();
    EXPECT_EQ(a.hash(), b.hash()) << motion;
    EXPECT_GT(a.look_at_flow().max_speed, 1e-3);
  }
}

TEST(IdleBlock, KeepsWhatItHolds) {
  Simulation s = channel_beside_a_box("motion = \"fixed\"", halves);
  Flow& flow = *s.scene().flow;
  const lbm::Int3 middle{8, 8, 4};  // far enough from its neighbours' links
  for (int t = 0; t < 4; ++t) s.step();
  for (int b = 0; b < flow.blocks(); ++b) {
    if (flow.is_fluid(b, middle)) continue;
    flow.set_arriving(b, middle, 0, 0.25);  // a cell that collided would spread it
    const double there = flow.arriving(b, middle, 0);
    s.step();
    EXPECT_EQ(flow.arriving(b, middle, 0), there);
  }
}

}  // namespace
}  // namespace silt::coupler::testing
