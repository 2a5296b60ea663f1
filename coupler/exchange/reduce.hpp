#pragma once
// Sums and extremes over ranks; sums in fixed point, so that they are the same on any number of ranks.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "rigid/math/exact_sum.hpp"
#include "rigid/math/fixed_point.hpp"

namespace silt::coupler {

/// A 128-bit sum in parts of 32 bits, lowest first, which can be added each for itself: they have room for
/// the carries of 2^32 ranks (2^31 as signed numbers).
using Limbs = std::array<std::uint64_t, 4>;
Limbs limbs_of(rigid::FixedSum);
rigid::FixedSum sum_of(const Limbs&);

/// Collective, in place on every rank.
void sum_over_ranks(MPI_Comm, std::span<rigid::FixedSum>);
void sum_over_ranks(MPI_Comm, std::span<std::uint64_t>);
void sum_over_ranks(MPI_Comm, std::span<rigid::ExactSum>);
void max_over_ranks(MPI_Comm, std::span<double>);
double max_over_ranks(MPI_Comm, double);
std::uint64_t least_over_ranks(MPI_Comm, std::uint64_t);
std::uint64_t most_over_ranks(MPI_Comm, std::uint64_t);
/// Collective. Returns the text of the first rank that has one; "" if none has.
std::string text_of_one(MPI_Comm, std::string);

}  // namespace silt::coupler
