#pragma once
// Judges how bodies touch: materials, the contact margin and films of lubrication.
#include "coupler/case/body_check.hpp"

namespace silt::coupler {

/// Reports coefficients out of range, a friction that can only be an angle, a margin beyond the domain or the
/// bodies' sizes, and films that the resolver does not know or that begin as wide as a body.
void find_contact_faults(const Case&, Findings&);

}  // namespace silt::coupler
