#include "coupler/run/cell_speed.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include "lbm/fluid.hpp"

namespace silt::coupler {

double seconds_of_a_cell() {
  constexpr int edge = 96;
  lbm::Fluid<float> fluid(lbm::Domain({edge, edge, edge}, {}, std::nullopt, 1), {}, MPI_COMM_SELF);
  const auto step = [&] {
    fluid.stream_collide();
    fluid.exchange();
  };
  step();  // memory is there from then on
  std::array<double, 5> seconds;
  for (double& one : seconds) {
    const auto begin = std::chrono::steady_clock::now();
    step();
    one = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  std::sort(seconds.begin(), seconds.end());
  return std::max(seconds[seconds.size() / 2], 1e-6) / (double(edge) * edge * edge);
}

}  // namespace silt::coupler
