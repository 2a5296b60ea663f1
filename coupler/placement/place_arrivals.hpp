#pragma once
// The bodies that fills place while a run goes on.
#include <mpi.h>

#include "coupler/placement/apply_fills.hpp"
#include "lbm/domain.hpp"

namespace silt::coupler {

/// Returns the fills that are applied again before the step that follows so many.
std::vector<FillApplication> fills_due(const Case&, std::int64_t steps_done);

/// Collective. Places the bodies of these applications among those of all ranks, of which `bodies` has this
/// rank's, so that bounding spheres with their gaps meet no body, wall or each other: the same bodies, to the
/// bit, on any number of ranks. Of the random numbers of an application no other has any.
std::vector<AppliedFill> place_arrivals(const Case&, const std::vector<FillApplication>&, const lbm::Domain&,
                                        MPI_Comm, const rigid::BodySet& bodies, rigid::BodyId& next_id);

}  // namespace silt::coupler
