#pragma once
// A lubrication film between two close, smooth surfaces resists their relative motion. rigid/ knows no fluid:
// the coupler supplies a LubricationLaw, and the resolver takes its resistances as implicit in the velocity
// at the end of the step, p = -resistance dt u+, however stiff they are (method.md, L1 and L2).
//
// Three motions of a gap resist without bound as it closes: its width's change, the slip of one surface past
// the other, and their rolling, the sum of both surfaces' velocities seen from the point where they are
// closest.
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// Force per relative velocity of the surfaces; lattice units. All zero: no lubrication film.
struct LubricationResistance {
  double normal = 0, sliding = 0, rolling = 0;
  explicit operator bool() const { return normal != 0 || sliding != 0 || rolling != 0; }
};

/// The gap between two surfaces around the points where they are closest to each other.
struct LubricatedGap {
  double width;                   // there; < 0: overlap
  double travel;                  // its change over the step at the velocities before it
  Mat3 curvature_a, curvature_b;  // curvature of either surface (shapes/convex_shape.hpp); W
  Vec3 middle;                    // canonical position, W
  Vec3 normal;                    // unit, from a to b, W
  bool at_side = false;           // b is a side of the domain

  /// Sum and product of the gap's two principal curvatures.
  double curvature_sum() const { return (curvature_a + curvature_b).trace(); }
  double curvature_product() const {
    const double sum = curvature_sum();
    return 0.5 * (sum * sum - (curvature_a + curvature_b).squaredNorm());
  }
};

/// A law answers alike whoever asks: it may depend on nothing but the gap.
class LubricationLaw {
 public:
  virtual ~LubricationLaw() = default;
  /// Returns the width from which on gaps have no lubrication; lattice units.
  virtual double reach() const = 0;
  virtual LubricationResistance operator()(const LubricatedGap&) const = 0;
};

}  // namespace silt::rigid
