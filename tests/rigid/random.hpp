#pragma once
// Random numbers and turns, the same in every run.
#include <random>

#include "rigid/math/types.hpp"

namespace silt::rigid::testing {

inline double uniform(double a, double b) {
  static std::mt19937 generator(7);
  return std::uniform_real_distribution<>(a, b)(generator);
}

inline Quat random_turn() {
  return Quat(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
}

}  // namespace silt::rigid::testing
