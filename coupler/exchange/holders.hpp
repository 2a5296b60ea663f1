#pragma once
// The holders of a body are the ranks it concerns: the one that owns it and those that hold a copy. They are
// a function of the cuts alone, so that every rank comes to the same answer, found by descending their tree:
// only the blocks that a box meets, in any periodic image, are looked at, however many there are.
#include <vector>

#include "lbm/blocks/domain.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

class Holders {
 public:
  /// rim: cells by which blocks are grown on all sides. here: the rank whose blocks are looked at first, for
  /// most of what it asks is inside them; -1: none.
  Holders(const lbm::Domain& domain, double rim, int here = -1);

  /// The block that contains x, and its rank: half-open boxes, x wrapped along periodic axes and clamped
  /// along others.
  int block_at(const rigid::Vec3& x_W) const { return domain_->tree().leaf_at(cell_at(x_W)).index; }
  int rank_at(const rigid::Vec3& x_W) const {
    return is_here(x_W, x_W) ? here_ : domain_->rank_of(block_at(x_W));
  }
  /// Fills ranks, sorted, with those one of whose grown blocks meets the box, whatever its size.
  void ranks_of(const rigid::BoundingBox& box_W, std::vector<int>& ranks) const;

 private:
  lbm::Int3 cell_at(const rigid::Vec3& x_W) const;
  /// The cells that an interval meets; beyond a wall the last ones before it.
  lbm::CellRun met_by(int axis, double lower, double upper) const;

  /// Says whether the box between two corners lies inside one block of the rank `here`.
  bool is_here(const rigid::Vec3& lower, const rigid::Vec3& upper) const {
    for (const rigid::BoundingBox& block : blocks_here_)
      if ((lower.array() >= block.lower.array()).all() && (upper.array() < block.upper.array()).all())
        return true;
    return false;
  }

  const lbm::Domain* domain_;
  double rim_;
  int here_;
  std::vector<rigid::BoundingBox> blocks_here_;  // to infinity beyond the sides of the domain that are walls
};

/// The ranks that the bodies of one rank concern, and may come to concern in a step.
class Neighbourhood {
 public:
  /// rim: that of the blocks, within which a body has to be known.
  Neighbourhood(const lbm::Domain&, const rigid::World&, double rim, int rank);
  /// Returns the neighbourhood after the domain was cut again.
  Neighbourhood renewed() const { return {*domain_, *world_, rim_, rank_}; }

  const rigid::World& world() const { return *world_; }
  const Holders& holders() const { return holders_; }
  int rank_at(const rigid::Vec3& x_W) const { return holders_.rank_at(x_W); }
  /// Ranks that hold a body that is at a pose and moves on by so much, its owner among them, sorted.
  void find_holders(int shape, const rigid::Pose&, const rigid::Twist& motion, std::vector<int>& ranks) const;
  /// Finds the ranks that hold an owned body until half a step later, and those that may own a body beyond
  /// one of its films.
  void find_holders(const rigid::BodySet&, std::size_t row, std::vector<int>& ranks) const;
  double reach() const { return reach_; }  // cells around the blocks of a rank
  /// Returns the other ranks that have a block within reach of one here, sorted: they agree.
  const std::vector<int>& around() const { return around_; }

 private:
  void include_owners_beyond_films(const rigid::BodySet&, std::size_t row, std::vector<int>& ranks) const;

  const lbm::Domain* domain_;
  const rigid::World* world_;
  double rim_;
  int rank_;
  Holders holders_, owners_;  // within the rim of a block; within a step's motion of it
  double largest_radius_;     // of a body
  double reach_;
  std::vector<int> around_;
};

/// Inserts a rank where it is not among the sorted ones yet.
void include(std::vector<int>& sorted, int rank);

}  // namespace silt::coupler
