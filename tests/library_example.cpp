#include <mpi.h>
#include <cstdio>
#include "silt/case/case_file.hpp"
#include "silt/simulation.hpp"

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    silt::Simulation simulation(silt::read_case("cases/settling-sphere"), MPI_COMM_WORLD);
    while (simulation.steps_done() < 50) {
      simulation.add_force(1, {0, 0, 0.1});  // of body 1, in the next step, in lattice units
      simulation.step();
    }
    std::printf("at height %g cells\n", simulation.bodies().position[0].z());
  }
  MPI_Finalize();
}
