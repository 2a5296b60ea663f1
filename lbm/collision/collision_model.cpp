#include "lbm/collision/collision_model.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace silt::lbm {

namespace {

/// Rounds a rate to the nearest multiple of 2^-(digits + 2).
template <class T>
T on_grid(double rate) {
  const int bits = std::numeric_limits<T>::digits + 2;
  return T(std::ldexp(std::nearbyint(std::ldexp(rate, bits)), -bits));
}

}  // namespace

template <class T>
CollisionRates<T>::CollisionRates(const CollisionSpec& s) : model(s.model) {
  if (!(s.relaxation_time > 0.5)) throw std::invalid_argument("the relaxation time must be above 1/2");
  const double tau_odd = s.odd_relaxation_time();
  density = on_grid<T>(1 / s.relaxation_time / 36);
  momentum = on_grid<T>(1 / tau_odd / 12);
  square = T(1.5 * density);
  keep_even_twice = T(1 - 36 * double(density));
  keep_even = keep_even_twice / 2;
  keep_third = T(1 - 1 / tau_odd);
  keep_fourth = T((1 - 1 / s.relaxation_time) * s.ghosts_as_trt());
  eddy = T(9 * s.smagorinsky * s.smagorinsky);
  const double resolved = s.relaxation_time * s.excess() / double(eddy);
  resolved_square = T(resolved * resolved);
  keep_odd = T(1 - 12 * double(momentum)) / 2;
  for (int d = 0; d < 3; ++d) {
    half_force[d] = T(s.force[d] / 2);
    even_force[d] = T((1 - 0.5 / s.relaxation_time) / 12 * s.force[d]);
    odd_force[d] = T((1 - 0.5 / tau_odd) / 12 * s.force[d]);
  }
}

template struct CollisionRates<float>;
template struct CollisionRates<double>;

}  // namespace silt::lbm
