#pragma once
// The mass that bodies owe the fluid. Over all links of a body the mass that its motion carries sums to zero,
// because every line of cells that enters the body leaves it. Where bodies touch with no cell between them,
// and where one touches a wall, links are missing, and what the others carry too much is the volume of the
// gap that closes or opens. The body gives it back through all its links in the next step.
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/row_sums.hpp"
#include "lbm/blocks/domain.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

/// Returns whether a ball crosses a side through which fluid passes. There the domain ends, not the body, and
/// links that are missing are nobody's.
bool crosses_open_side(const lbm::Domain&, const rigid::Vec3& centre, double radius);

/// Settles the mass that an owned body owes after a step in which its links moved like this (velocity,
/// angular velocity), and says what each of them gives in the next one. The first quantum is that of the
/// resistance and the exponent its own (lbm::ResistanceSums); the other one is that of the mass.
void owe_mass(rigid::BodySet&, std::size_t row, const RowSums&, const Vec6& motion, double resistance_quantum,
              int exponent, double mass_quantum);

}  // namespace silt::coupler
