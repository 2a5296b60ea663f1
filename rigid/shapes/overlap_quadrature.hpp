#pragma once
// By how much the parts of a compound, added up one by one, count their overlaps too often.
#include <span>

#include "rigid/shapes/compound.hpp"

namespace silt::rigid {

/// Sum of the parts' moments minus the moments of their union, in the body frame. Along parallel rays the
/// intervals are exact; across them adaptive Gauss cubature. The rays have a direction in general position,
/// so that no flat face lies along them and the integrand is continuous. Relative error about 1e-5.
SolidMoments overlap_moments(std::span<const Part> parts);

}  // namespace silt::rigid
