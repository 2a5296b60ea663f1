#pragma once
// A rotor of triangles in a fluid.
#include <array>
#include <cstdint>
#include <span>

#include "coupler/flow.hpp"
#include "parallel/collectives.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/mesh_case.hpp"

namespace silt::coupler::testing {

inline CaseText rotor_case(const std::string& motion) {
  CaseText c =
      mesh_case("gear.ply",
                "scale = 9\nsolid = \"inside\"\nposition = [15.7, 16.2, 16.4]\norientation = [0.2, 0.1, 1]\n"
                "motion = " +
                    motion);
  c.fluid = "[fluid]\nrelaxation_time = 0.7\n";
  return c;
}

inline Files gear() {
  return {{"gear.ply", ply_of(rigid::testing::gear_mesh(7, 3))}};
}

using WallLoad = std::array<std::int64_t, 6>;  // force and torque, in lbm::link_quantum

/// What the fluid did to the last wall in the last step, over the ranks.
inline WallLoad load_on_wall(const Simulation& simulation) {
  WallLoad load = simulation.scene().flow->account().wall_load(simulation.bodies().walls - 1);
  parallel::sum_over_ranks(simulation.scene().comm, std::span(load));
  return load;
}

}  // namespace silt::coupler::testing
