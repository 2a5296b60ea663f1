#pragma once
// Where bodies were at the start, asked by whoever has them now: the case tells, not memory.
#include <mpi.h>

#include <span>
#include <vector>

#include "lbm/domain.hpp"
#include "rigid/bodies/contact.hpp"

namespace silt::coupler {

struct Case;

/// Collective. Returns the centres of mass at the start, not wrapped, of bodies by their ids; NaN for one
/// that was not there. Ranks that placed bodies and those that ask meet at the rank id modulo ranks: none
/// holds more than its share.
std::vector<rigid::Vec3> start_positions(const Case&, const lbm::Domain&, MPI_Comm,
                                         std::span<const rigid::BodyId>);

}  // namespace silt::coupler
