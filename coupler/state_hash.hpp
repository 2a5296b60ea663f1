#pragma once
// One number for the whole state: the same on any number of ranks, any block layout, across a restart.
#include <mpi.h>

#include <cstdint>
#include <string>

#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

class Flow;

/// Wrapping sum over this rank's owned bodies of XXH3 of id, position, image, orientation, velocity, angular
/// momentum, what the fluid still owes the body, and stored impulses.
std::uint64_t hash_bodies(const rigid::BodySet&);

/// Collective: wrapping sum over all ranks of hash_bodies and FluidFields::hash (flow may be null).
std::uint64_t state_hash(MPI_Comm, const Flow*, const rigid::BodySet&);

/// 16 hexadecimal digits.
std::string hex(std::uint64_t);

}  // namespace silt::coupler
