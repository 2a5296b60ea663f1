#pragma once
// A hash of the whole state that does not depend on ranks, blocks or restarts.
#include <mpi.h>

#include <cstdint>
#include <string>

#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

class Flow;

/// Returns the wrapping sum over this rank's owned bodies of XXH3 of id, position, image, orientation,
/// velocity, angular momentum, impulse debt of the fluid, and stored impulses.
std::uint64_t hash_bodies(const rigid::BodySet&);

/// Returns the wrapping sum over ranks of hash_bodies and FluidFields::hash (flow may be null). Collective.
std::uint64_t state_hash(MPI_Comm, const Flow*, const rigid::BodySet&);

/// Returns 16 hexadecimal digits.
std::string hex(std::uint64_t);

}  // namespace silt::coupler
