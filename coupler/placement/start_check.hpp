#pragma once
// Judges where the given bodies are at the start, each rank its own and those near it: what check_case, which
// looks at the case alone, leaves open.
#include <mpi.h>

#include <vector>

#include "coupler/case/case_error.hpp"
#include "lbm/domain.hpp"

namespace silt::coupler {

struct Case;

/// Collective. Returns, the same on every rank, which given bodies have their centre outside the domain,
/// reach into a wall or, if there are none of those, overlap another: of each kind the first few, by the
/// order of the case. The case must have passed check_case.
std::vector<Diagnostic> find_start_faults(const Case&, const lbm::Domain&, MPI_Comm);

/// Collective. Judges so; CaseError on every rank if something is wrong.
void require_sound_start(const Case&, const lbm::Domain&, MPI_Comm);

}  // namespace silt::coupler
