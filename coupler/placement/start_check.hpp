#pragma once
// Judges where the given bodies are at the start, each rank its own and those near it: what check_case, which
// looks at the case alone, leaves open.
#include <mpi.h>

#include "lbm/domain.hpp"

namespace silt::coupler {

struct Case;

/// Collective. CaseError on every rank says which given bodies have their centre outside the domain, reach
/// into a wall or, if there are none of those, overlap another: of each kind the first few, by the order of
/// the case. The case must have passed check_case.
void require_sound_start(const Case&, const lbm::Domain&, MPI_Comm);

}  // namespace silt::coupler
