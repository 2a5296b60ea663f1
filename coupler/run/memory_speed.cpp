#include "coupler/run/memory_speed.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

namespace silt::coupler {

double memory_speed() {
  constexpr std::size_t numbers = 16u << 20;
  std::vector<float> field(numbers, 1.f);
  std::array<double, 5> seconds;
  for (double& pass : seconds) {
    const auto begin = std::chrono::steady_clock::now();
    for (float& x : field) x = 0.5f * x + 1.f;
    pass = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  volatile float used = field[numbers / 2];  // so that the passes are not left out
  static_cast<void>(used);
  std::sort(seconds.begin(), seconds.end());
  return 2 * numbers * sizeof(float) / std::max(seconds[seconds.size() / 2], 1e-6);
}

}  // namespace silt::coupler
