#pragma once
// The start of a run from the end of another one: its bodies and its fluid, with other parameters
// (`[initial]` of a case; cases/README.md says what may differ).
#include <memory>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// Writes what a start from a checkpoint asks of the run that wrote it, besides its state.
void write_origin_of_start(adapters::CheckpointWriter&, const Case&, std::int64_t step);

/// Collective. Makes the simulation that begins, at step 0, with what the checkpoint holds.
/// std::runtime_error on every rank for one that the case cannot begin with.
std::unique_ptr<Simulation> simulation_from(const adapters::CheckpointReader&, Case, MPI_Comm);

}  // namespace silt::coupler
