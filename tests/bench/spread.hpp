#pragma once
// Samples of one figure, taken in turn with others: the middle one and how far they scatter.
#include <algorithm>
#include <vector>

#include "tests/bench/figures.hpp"

namespace silt::bench {

struct Spread {
  std::vector<double> samples;
  void add(double x) { samples.push_back(x); }
  double middle() const { return median(samples); }
  double lowest() const { return *std::min_element(samples.begin(), samples.end()); }
  double highest() const { return *std::max_element(samples.begin(), samples.end()); }
};

/// Sample by sample.
inline Spread ratio(const Spread& a, const Spread& b) {
  Spread r;
  for (std::size_t k = 0; k < std::min(a.samples.size(), b.samples.size()); ++k)
    r.add(a.samples[k] / b.samples[k]);
  return r;
}

}  // namespace silt::bench
