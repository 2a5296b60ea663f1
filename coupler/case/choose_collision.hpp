#pragma once
// Which collision model lasts in a scene, by what was measured (scripts/stability).
#include <string>

#include "coupler/case/case.hpp"

namespace silt::coupler {

/// Returns the largest speed that a case gives anything: sides, bodies, the fluid at the start; lattice
/// units.
double fastest_given(const Case&);

/// Returns the cell Reynolds number u / nu at that speed.
double cell_reynolds(const Case&);

/// Returns the largest u / nu up to which a model lasted in every scene of the map, at up to 0.1 cells a
/// step.
double measured_reynolds(lbm::Collision);

/// Resolves `fluid.collision = "auto"`: trt, the cheapest, up to what was measured, regularised above.
void choose_collision(Case&);

/// Returns why the case has its collision model: "given", or what "auto" compared.
std::string collision_reason(const Case&);

}  // namespace silt::coupler
