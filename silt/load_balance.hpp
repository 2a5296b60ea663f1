#pragma once
// Measures how evenly ranks share the work of a scene, and finds better cuts.
#include <cstdint>

#include "coupler/balance/weighted_cut.hpp"

namespace silt {

class Scene;

/// The present cut, and one by weighted work.
struct CutComparison {
  coupler::WeightedCut present, better;

  /// Returns whether moving to the better cut pays within `steps` steps: the rank with most work must save
  /// more than the move costs.
  bool worth_moving(std::int64_t steps) const;
};

/// Compares cuts by the present work of cells, links, mapped cells, bodies and contacts; without a flow, by
/// an estimate from volumes and surfaces of the bodies. Collective.
CutComparison compare_cuts(const Scene&);

/// The largest predicted work of a rank over the mean.
struct Evenness {
  double before = 1, after = 1;
};

/// How a simulation has balanced its work.
struct BalanceRecord {
  std::uint64_t looks = 0, moves = 0;  // comparisons and moves between steps
  Evenness at_start, last;             // equal cut and cut at the start; last comparison
  double seconds = 0;                  // spent between steps, on this rank
};

}  // namespace silt
