#pragma once
// The interface of lubrication between close, smooth surfaces. rigid/ knows no fluid: the coupler supplies a
// LubricationLaw, and the resolver applies its resistances implicitly, with the velocity at the end of the
// step: p = -resistance dt u+, stable for any stiffness (method.md, L1 and L2).
//
// Three motions have a resistance that diverges as the gap closes: squeezing (normal), sliding of one surface
// past the other, and rolling, the sum of both surfaces' velocities relative to the nearest point.
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// Force per relative velocity of the surfaces, lattice units. All zero: no lubrication film.
struct LubricationResistance {
  double normal = 0, sliding = 0, rolling = 0;
  double leaving =
      0;  // of squeezing, where the surfaces meet in the step: mean over the way back from contact
  explicit operator bool() const { return normal != 0 || sliding != 0 || rolling != 0; }
};

/// The gap between two surfaces near the points of closest approach.
struct LubricatedGap {
  double width;                   // least distance; < 0: overlap
  double travel;                  // change of the width over the step, at the velocities before it
  Mat3 curvature_a, curvature_b;  // curvature of either surface (shapes/shape.hpp); W
  Vec3 middle;                    // canonical position, W
  Vec3 normal;                    // unit, from a to b, W
  bool at_side = false;           // b is a side of the domain

  /// Return the sum and the product of the gap's two principal curvatures.
  double curvature_sum() const { return (curvature_a + curvature_b).trace(); }
  double curvature_product() const {
    const double sum = curvature_sum();
    return 0.5 * (sum * sum - (curvature_a + curvature_b).squaredNorm());
  }
};

/// A lubrication law. It may depend on the gap only, so that all ranks get the same result.
class LubricationLaw {
 public:
  virtual ~LubricationLaw() = default;
  /// Returns the width of the widest lubricated gap, lattice units.
  virtual double reach() const = 0;
  virtual LubricationResistance operator()(const LubricatedGap&) const = 0;
};

}  // namespace silt::rigid
