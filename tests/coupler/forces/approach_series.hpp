#pragma once
// Stokes flow: the force on a sphere that moves straight towards a wall, or towards its mirror image.
#include <cmath>

namespace silt::testing {

/// Sums either series, whose terms fall as exp(-2 n alpha), cosh(alpha) = height / radius.
template <class Term>
double approach_series(double height_over_radius, Term&& term) {
  const double alpha = std::acosh(height_over_radius);
  double sum = 0;
  for (int n = 1; n < 20 + 20 / alpha; ++n)
    sum += n * (n + 1.0) / ((2 * n - 1.0) * (2 * n + 3.0)) * term(n, alpha);
  return 4.0 / 3 * std::sinh(alpha) * sum;
}

/// Force / (6 pi mu a U) at a no-slip wall. Brenner, Chem. Eng. Sci. 16 (1961) 242, equation 2.19.
inline double approach_to_wall(double height_over_radius) {
  return approach_series(height_over_radius, [](int n, double alpha) {
    const double m = 2 * n + 1, s = std::sinh(0.5 * m * alpha), t = std::sinh(alpha);
    return (2 * std::sinh(m * alpha) + m * std::sinh(2 * alpha)) / (4 * s * s - m * m * t * t) - 1;
  });
}

/// Returns this resistance for each of two equal spheres that approach at U each, `height` from the plane
/// between them. Brenner (1961), the free surface.
inline double approach_of_two(double height_over_radius) {
  return approach_series(height_over_radius, [](int n, double alpha) {
    const double m = 2 * n + 1, c = std::cosh(0.5 * m * alpha), t = std::sinh(alpha);
    return (4 * c * c + m * m * t * t) / (2 * std::sinh(m * alpha) - m * std::sinh(2 * alpha)) - 1;
  });
}

/// Returns, for a sphere that slides along a no-slip wall without turning, force / (6 pi mu a U) and torque /
/// (8 pi mu a^2 U), the latter as if the wall held its foot back. eps: gap / radius; to 1 % below 0.05.
/// Goldman, Cox, Brenner, Chem. Eng. Sci. 22 (1967) 637, with the terms in eps ln eps of O'Neill, Stewartson,
/// J. Fluid Mech. 27 (1967) 705. Beyond 0.4, where a gap of a few cells is, the value at 0.5 (their table).
inline double slide_force(double eps) {
  if (eps > 0.4) return 1.595707;
  return 8. / 15 * std::log(1 / eps) + 0.9588 + 64. / 375 * eps * std::log(1 / eps);
}
inline double slide_torque(double eps) {
  if (eps > 0.4) return 0.016574;
  return 0.1 * std::log(1 / eps) - 0.1895 + 43. / 250 * eps * std::log(1 / eps);
}

}  // namespace silt::testing
