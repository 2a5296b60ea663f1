#pragma once
// The default broad phase: uniform grids, one for each power of two of the radius, so that a few large bodies
// among many small ones cost the small ones nothing.
#include "rigid/broad_phase.hpp"

namespace silt::rigid {

class UniformGrid : public BroadPhase {
 public:
  std::string_view name() const override { return "grid"; }

 private:
  struct Level;
  void find_pairs(const Surroundings&, std::vector<CandidatePair>& found) override;
  void build_levels(const Surroundings&);
  static void search(const Surroundings&, std::size_t row, const Level&, bool same_level,
                     std::vector<CandidatePair>& found);

  struct Entry {
    std::array<std::int32_t, 3> cell;
    std::uint32_t row;
  };
  struct Level {
    std::array<double, 3> width;        // of a cell
    std::array<std::int32_t, 3> cells;  // along periodic axes; 0 along others: unbounded
    std::uint32_t mask = 0;             // buckets - 1
    std::vector<std::uint32_t> first;   // of each bucket in entries, one more at the end
    std::vector<Entry> entries;         // by bucket
    std::vector<std::uint32_t> rows;    // of this size
  };
  std::vector<Level> levels_;  // small bodies first
};

}  // namespace silt::rigid
