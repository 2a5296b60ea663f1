#pragma once
// The part that broad phases on an engine's tree of boxes share: a leaf for each body, kept from step to
// step, periodic images, and the exact choice of pairs.
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "rigid/collision/broad_phase.hpp"

namespace silt::adapters {

/// A leaf holds the cube around a body's reach, a little larger, so that it stays while the body moves inside
/// it. Two bodies whose cubes overlap in the tree are a pair if they meet (rigid/collision/broad_phase);
/// images are found by asking the tree about the cubes that stick out through a periodic side, shifted by the
/// period. So neither what the tree looks like nor how it came about shows in the pairs.
class TreeBroadPhase : public rigid::BroadPhase {
 protected:
  using Leaf = std::uint32_t;  // a number below the largest number of bodies so far
  struct Cube {
    rigid::Vec3 centre = rigid::Vec3::Zero();
    double half_edge = 0;  // < 0: empty
  };

 private:
  /// Sets a new leaf, or one whose cube is another now.
  virtual void place(Leaf, const Cube&) = 0;
  virtual void remove(Leaf) = 0;
  /// Called after the last of these in a step, before the tree is asked.
  virtual void refresh() = 0;
  /// Append all pairs of leaves whose cubes overlap, and all leaves whose cubes overlap one. More do no harm.
  virtual void overlapping_pairs(std::vector<std::pair<Leaf, Leaf>>&) = 0;
  virtual void overlapping(const Cube&, std::vector<Leaf>&) = 0;

  void find_pairs(const rigid::Surroundings&, std::vector<rigid::CandidatePair>& found) final;
  void follow(const rigid::Surroundings&);
  Leaf leaf_of(rigid::BodyId, std::size_t row);
  void drop_absent();
  void find_images(const rigid::Surroundings&, std::vector<rigid::CandidatePair>& found);

  struct Known {  // about a leaf
    rigid::BodyId id;
    std::size_t row;
    Cube cube;
    std::uint64_t seen;  // in which step last; 0: never
  };
  std::vector<Known> leaves_;
  std::vector<Leaf> free_;
  std::unordered_map<rigid::BodyId, Leaf> by_id_;
  std::vector<Leaf> by_row_;  // of the last step
  std::vector<Cube> reach_;   // of the rows, as tight as it may be
  std::uint64_t step_ = 0;
  std::vector<std::pair<Leaf, Leaf>> pairs_;
  std::vector<Leaf> asked_;
};

}  // namespace silt::adapters
