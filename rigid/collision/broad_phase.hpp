#pragma once
// The broad phase: finds pairs of bodies whose bounding spheres nearly touch, and bodies near walls.
// Positions are canonical; through a periodic side a body meets the images of other bodies (never its own),
// through each side separately. The criterion is defined here, bitwise, so that the searches
// (rigid/collision/uniform_grid, the trees of engines in adapters/) are interchangeable, and the Verlet list
// (rigid/collision/verlet_list) does not change results.
#include <string_view>
#include <vector>

#include "rigid/collision/verlet_list.hpp"

namespace silt::rigid {

class BroadPhase {
 public:
  virtual ~BroadPhase() = default;
  virtual std::string_view name() const = 0;
  /// Fills pairs with every (a, b, image) within reach, each once, sorted by (id a, id b, image). A wall is
  /// within reach if the bounding sphere of a free body is no further from it than the body's margin. reach:
  /// one per row (unused for walls). walls: one per wall row. The result depends on the arguments only.
  void operator()(const BodySet&, const Extent&, std::span<const Reach> reach,
                  std::span<const WallSurface> walls, std::vector<CandidatePair>& pairs);

 private:
  void find_candidates(const Surroundings&, std::span<const WallSurface>);
  /// Appends the pairs of bodies within reach, each once, in any order. Called with at least one body.
  virtual void find_pairs(const Surroundings&, std::vector<CandidatePair>& found) = 0;
  void sort_into(const BodySet&, std::vector<CandidatePair>& pairs);

  VerletList list_;
  std::vector<Reach> wider_;
  std::vector<CandidatePair> found_;
  std::vector<std::uint32_t> order_, rank_, start_;
};

}  // namespace silt::rigid
