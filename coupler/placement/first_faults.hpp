#pragma once
// What ranks find wrong with bodies, each with those it sees: the first few of all, told on every rank.
#include <mpi.h>

#include <string>
#include <vector>

#include "rigid/bodies/contact.hpp"

namespace silt::coupler {

struct BodyFault {
  rigid::BodyId body, other = 0;  // other: 0 if there is none
  std::string text;
};

/// Collective. Returns the first `most` faults by (body, other), each once though several ranks may have
/// found it.
std::vector<BodyFault> first_faults(MPI_Comm, std::vector<BodyFault> mine, std::size_t most);

}  // namespace silt::coupler
