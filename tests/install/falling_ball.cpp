#include <cstdio>

#include "coupler/case/case_file.hpp"
#include "coupler/simulation.hpp"

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    silt::coupler::Simulation simulation(silt::coupler::read_case(argv[1]), MPI_COMM_SELF);
    simulation.run(1000);
    std::printf("at height %.4f cells\n", simulation.bodies().position[0].z());
  }
  MPI_Finalize();
}
