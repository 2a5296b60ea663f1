#pragma once
// What the machine can do. The bound of every in-place kernel: cells a second whose 19 populations can be
// read once and written once, for the best of several ways to walk through them (which one is best depends on
// the machine and on the size). And operations a second without memory.
#include <algorithm>
#include <array>

#include "lbm/blocks/large_memory.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/fluid_kernels.hpp"

namespace silt::bench {

template <class T>
class Bound {
 public:
  /// Measures the bound of a working set of so many cells.
  explicit Bound(std::ptrdiff_t cells)
      : cells_((cells + line - 1) / line * line),
        stride_(cells_ + 13 * line),
        data_(lbm::zeroed<T>(19 * stride_)) {
    std::fill_n(data_.get(), 19 * stride_, T(0));  // memory is there once it is written
  }

  /// One sample of every shape, MLUPS; `together` is called before each (a barrier, where several ranks
  /// measure).
  void sample(int passes, auto&& together) {
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      together();
      const double t = seconds([&] {
        for (int p = 0; p < passes; ++p)
          bound_kernels<T>().update_in_place(data_.get(), stride_, cells_, shapes[k]);
      });
      mlups_[k].add(passes * double(cells_) / t * 1e-6);
    }
  }
  void forget() { mlups_ = {}; }
  /// Returns the samples of the shape with the best middle one.
  const Spread& best() const {
    return *std::max_element(mlups_.begin(), mlups_.end(),
                             [](const Spread& a, const Spread& b) { return a.middle() < b.middle(); });
  }

 private:
  static constexpr int line = 64 / sizeof(T);
  static constexpr std::array<AccessShape, 7> shapes = {
      {{1, 4, 0}, {1, 16, 32}, {4, 1, 32}, {8, 1, 32}, {8, 4, 16}, {19, 1, 8}, {19, 1, 16}}};
  std::ptrdiff_t cells_, stride_;
  lbm::LargeMemory<T> data_;  // as production's
  std::array<Spread, shapes.size()> mlups_;
};

/// Additions and multiplications of one core, the best of some tries; 10^9 a second.
template <class T>
double peak_gflops() {
  Spread rate;
  T sink;
  for (int r = 0; r < 5; ++r) {
    double flops = 0;
    const double t = seconds([&] { flops = bound_kernels<T>().add_and_multiply(&sink, 2'000'000); });
    rate.add(flops / t * 1e-9);
  }
  return rate.highest();
}

}  // namespace silt::bench
