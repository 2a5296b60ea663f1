#pragma once
// Every body of a case: the [[bodies]] as given, then the [[fill]]s placed at random without overlap.
#include <vector>

#include "coupler/case/body_spec.hpp"
#include "rigid/bodies/body_exchange.hpp"

namespace silt::coupler {

struct Case;

/// Returns the domain as the bodies see it.
rigid::Extent extent_of(const Case&);

/// Returns the bodies of [[bodies]] in the order of the file, then those of each [[fill]]. A pure function of
/// the case: the same on every rank. Each body of a fill is put where its bounding sphere (about its centre
/// of mass), grown by the fill's gap, meets no wall, no given body and no bounding sphere of another filled
/// body, and lies in the fill's box; places are drawn one by one, those of the largest bodies first (random
/// sequential addition, which jams near 38 % of the box in bounding spheres). The seeds of two fills may be
/// equal. Throws CaseError, saying how many fitted, if one does not fit.
std::vector<BodySpec> place_bodies(const Case&);

}  // namespace silt::coupler
