#pragma once
// The common part of broad phases on an engine's tree of boxes: a leaf for each body, kept between steps,
// periodic images, and the exact selection of pairs.
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "rigid/collision/broad_phase.hpp"

namespace silt::adapters {

/// A leaf is a cube around a body's reach, slightly larger, so that it stays while the body moves inside. Two
/// bodies with overlapping cubes are a pair if they meet (rigid/collision/broad_phase). Images are found by
/// querying the tree with cubes that extend beyond a periodic side, shifted by the period. Thus the pairs do
/// not depend on the tree or its history.
class TreeBroadPhase : public rigid::BroadPhase {
 protected:
  using Leaf = std::uint32_t;  // less than the largest number of bodies so far
  struct Cube {
    rigid::Vec3 centre = rigid::Vec3::Zero();
    double half_edge = 0;  // < 0: empty
  };

 private:
  /// Inserts a leaf, or changes its cube.
  virtual void place(Leaf, const Cube&) = 0;
  virtual void remove(Leaf) = 0;
  /// Is called after the last change in a step, before queries.
  virtual void refresh() = 0;
  /// Append at least all pairs of leaves with overlapping cubes, and all leaves whose cubes overlap one.
  virtual void overlapping_pairs(std::vector<std::pair<Leaf, Leaf>>&) = 0;
  virtual void overlapping(const Cube&, std::vector<Leaf>&) = 0;

  void find_pairs(const rigid::Surroundings&, std::vector<rigid::CandidatePair>& found) final;
  void update_leaves(const rigid::Surroundings&);
  Leaf leaf_of(rigid::BodyId, std::size_t row);
  void remove_absent();
  void find_images(const rigid::Surroundings&, std::vector<rigid::CandidatePair>& found);

  struct Known {  // the state of a leaf
    rigid::BodyId id;
    std::size_t row;
    Cube cube;
    std::uint64_t seen;  // last step in which the body was present; 0: never
  };
  std::vector<Known> leaves_;
  std::vector<Leaf> free_;
  std::unordered_map<rigid::BodyId, Leaf> by_id_;
  std::vector<Leaf> by_row_;  // in the last step
  std::vector<Cube> reach_;   // of each row, without slack
  std::uint64_t step_ = 0;
  std::vector<std::pair<Leaf, Leaf>> pairs_;
  std::vector<Leaf> hits_;
};

}  // namespace silt::adapters
