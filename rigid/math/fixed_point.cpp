#include "rigid/math/fixed_point.hpp"

#include <cmath>
#include <stdexcept>

namespace silt::rigid {

namespace {
constexpr double quanta_per_unit = 0x1p64;
constexpr double largest = 0x1p62;
}  // namespace

FixedSum to_fixed(double x) {
  if (!(std::abs(x) < largest)) throw std::overflow_error("a force or torque is not finite or above 2^62");
  return static_cast<FixedSum>(x * quanta_per_unit);
}

double from_fixed(FixedSum q) {
  return static_cast<double>(q) / quanta_per_unit;
}

}  // namespace silt::rigid
