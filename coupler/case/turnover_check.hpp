#pragma once
// Judges what a case says of bodies that come and go.
#include "coupler/case/body_check.hpp"

namespace silt::coupler {

/// Reports outflows beyond the domain, or where bodies come in; fills that end before they are applied again;
/// an outflow that nothing can leave by; bodies whose prescribed motion takes them out of the domain.
void find_turnover_faults(const Case&, Findings&);

}  // namespace silt::coupler
