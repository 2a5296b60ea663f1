#pragma once
// A scene's work is shared among the ranks: how evenly, and how it could be shared, is found here.
#include <cstdint>

#include "coupler/balance/weighted_cut.hpp"

namespace silt {

class Scene;

/// The cut that there is and one by weighted work.
struct CutComparison {
  coupler::WeightedCut present, better;

  /// Says whether the better one is worth a move, if it stays for so many steps: the rank with most work has
  /// to save more than moving costs.
  bool worth_moving(std::int64_t steps) const;
};

/// Collective. Compares by the work of the cells, links, mapped cells, bodies and contacts that there are;
/// before there is a flow by an estimate from volumes and surfaces of the bodies.
CutComparison compare_cuts(const Scene&);

/// Largest over mean of the predicted work of the ranks.
struct Evenness {
  double before = 1, after = 1;
};

/// A record of how a simulation has shared the work.
struct BalanceRecord {
  std::uint64_t looks = 0, moves = 0;  // between steps
  Evenness at_start, last;             // of the equal cut and the one taken at the start; of the last look
  double seconds = 0;                  // between steps, on this rank
};

}  // namespace silt
