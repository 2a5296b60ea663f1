#pragma once
// Sums and extremes over ranks; sums in fixed point, so that they are the same on any number of ranks.
#include <mpi.h>

#include <cstdint>
#include <span>

#include "rigid/math/fixed_point.hpp"

namespace silt::coupler {

/// Collective, in place on every rank.
void sum_over_ranks(MPI_Comm, std::span<rigid::FixedSum>);
void sum_over_ranks(MPI_Comm, std::span<std::uint64_t>);
void max_over_ranks(MPI_Comm, std::span<double>);
double max_over_ranks(MPI_Comm, double);

}  // namespace silt::coupler
