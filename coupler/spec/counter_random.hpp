#pragma once
// Random numbers as a function of a key, equal on every rank (Salmon, Moraes, Dror, Shaw, SC11). The C++
// standard specifies its engines but not its distributions, so the distributions are implemented here.
#include <cmath>
#include <cstdint>
#include <numbers>

#include "rigid/math/elementary.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

/// The output function of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): a bijection of 64 bits.
constexpr std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

/// The sequence of SplitMix64 from a key on.
class CounterRandom {
 public:
  explicit CounterRandom(std::uint64_t key) : state_(key) {}
  std::uint64_t next() { return mixed(state_ += 0x9e3779b97f4a7c15u); }
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }  // [0, 1)
  rigid::Vec3 point() {                                                     // of the unit cube
    const double x = uniform(), y = uniform(), z = uniform();
    return {x, y, z};
  }
  /// Returns an orientation uniform over all rotations (Shoemake 1992, Graphics Gems III, p. 124).
  rigid::Quat orientation() {
    const double u = uniform(), a = 2 * std::numbers::pi * uniform(), b = 2 * std::numbers::pi * uniform();
    const double r = std::sqrt(1 - u), s = std::sqrt(u);
    return rigid::Quat(s * rigid::elementary::cos(b), r * rigid::elementary::sin(a),
                       r * rigid::elementary::cos(a), s * rigid::elementary::sin(b))
        .normalized();
  }

 private:
  std::uint64_t state_;
};

}  // namespace silt::coupler
