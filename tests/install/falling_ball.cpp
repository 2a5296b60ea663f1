#include <cstdio>

#include "silt/case/case_file.hpp"
#include "silt/simulation.hpp"

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    silt::Simulation simulation(silt::read_case(argv[1]), MPI_COMM_SELF);
    simulation.run(1000);
    std::printf("at height %.4f cells\n", simulation.bodies().position[0].z());
  }
  MPI_Finalize();
}
