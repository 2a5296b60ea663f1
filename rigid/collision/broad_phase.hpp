#pragma once
// A broad phase finds the bodies that come close enough to be looked at: pairs of bodies whose bounding
// spheres nearly touch, and bodies near a wall. Positions are canonical; through a periodic side a body meets
// the images of others (but never its own), through each side separately. This file decides bitwise which
// bodies are a pair, so that the ways to find them (rigid/collision/uniform_grid, the trees of the engines in
// adapters/) can be swapped freely; how often they are asked does not show (rigid/collision/kept_pairs).
#include <string_view>
#include <vector>

#include "rigid/collision/kept_pairs.hpp"

namespace silt::rigid {

class BroadPhase {
 public:
  virtual ~BroadPhase() = default;
  virtual std::string_view name() const = 0;
  /// Fills pairs with every (a, b, image) that meet; sorted by (id a, id b, image), each once. A wall
  /// is near if the distance of a free body's bounding sphere to it is within the margin. reach: one a row
  /// (unused for walls). walls: one a wall row. A function of its arguments alone, whatever is kept from call
  /// to call.
  void operator()(const BodySet&, const Extent&, std::span<const Reach> reach,
                  std::span<const WallSurface> walls, std::vector<CandidatePair>& pairs);

 private:
  void look(const Surroundings&, std::span<const WallSurface>);
  /// Appends the pairs of bodies that meet, each once, in any order. Called with one body at least.
  virtual void find_pairs(const Surroundings&, std::vector<CandidatePair>& found) = 0;
  void sort_into(const BodySet&, std::vector<CandidatePair>& pairs);

  KeptPairs kept_;
  std::vector<Reach> wider_;
  std::vector<CandidatePair> found_;
  std::vector<std::uint32_t> order_, rank_, start_;
};

}  // namespace silt::rigid
