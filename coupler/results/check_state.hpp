#pragma once
// Whether what a checkpoint holds can be the state of a run of its case: a file may have every checksum right
// and still not be one that a run wrote.
#include <cstdint>

#include "adapters/hdf5/checkpoint_file.hpp"

namespace silt::coupler {

struct Case;

/// Throws std::runtime_error for the first number of this rank's slice of the bodies and of their stored
/// impulses that no run can go on from: the dataset, the row, what was found and what may be. next_id: the
/// first that no body has had.
void require_possible(const Case&, const adapters::CheckpointReader::Bodies&, rigid::BodyId next_id);

/// No population that a run can go on from is above it, in the mass of a cell at its reference density.
inline constexpr double largest_population = 1024;

}  // namespace silt::coupler
