#pragma once
// Which bodies are too light for `coupling.time = "explicit"`.
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

struct Case;

/// Returns the density, over the fluid's, from which on the explicit step is stable for a free body, within a
/// fifth for spheres: where the largest eigenvalue of M^-1 H, 5.13 / (D rho) for a sphere of D cells, is 0.40
/// sqrt(tau - 1/2) (scripts/accuracy/coupling_in_time.md; bounce-back bears twice as much). Of other shapes D
/// is the least width. 0 without a fluid, and where the coupling is implicit.
double least_explicit_density(const Case&, const rigid::Shape&);

/// Whether any free body of the case is lighter than that.
bool has_bodies_too_light(const Case&);

}  // namespace silt::coupler
