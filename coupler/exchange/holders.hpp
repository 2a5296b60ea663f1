#pragma once
// The holders of a body: its owner and the ranks with a copy. Every rank finds the same ones, from the cuts
// of the domain. The search visits only blocks that a box meets, in any periodic image.
#include <vector>

#include "lbm/blocks/domain.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

class Holders {
 public:
  /// rim: cells by which blocks are grown on all sides. here: the rank whose blocks are tested first, since
  /// most boxes are inside them; -1: none.
  Holders(const lbm::Domain& domain, double rim, int here = -1);

  /// Returns the block that contains x (half-open boxes), after wrapping x along periodic axes and clamping
  /// it along others; rank_at returns its rank.
  int block_at(const rigid::Vec3& x_W) const { return domain_->tree().leaf_at(cell_at(x_W)).index; }
  int rank_at(const rigid::Vec3& x_W) const {
    return is_here(x_W, x_W) ? here_ : domain_->rank_of(block_at(x_W));
  }
  /// Fills ranks, sorted, with those that have a grown block which meets the box.
  void ranks_of(const rigid::BoundingBox& box_W, std::vector<int>& ranks) const;

 private:
  lbm::Int3 cell_at(const rigid::Vec3& x_W) const;
  /// Returns the cells that an interval overlaps; beyond a wall the last cells before it.
  lbm::CellRun met_by(int axis, double lower, double upper) const;

  /// Returns whether the box lies inside one block of the rank `here`.
  bool is_here(const rigid::Vec3& lower, const rigid::Vec3& upper) const {
    for (const rigid::BoundingBox& block : blocks_here_)
      if ((lower.array() >= block.lower.array()).all() && (upper.array() < block.upper.array()).all())
        return true;
    return false;
  }

  const lbm::Domain* domain_;
  double rim_;
  int here_;
  std::vector<rigid::BoundingBox> blocks_here_;  // infinite beyond walls of the domain
};

/// The ranks that must know the bodies of a rank, now or after a step.
class Neighbourhood {
 public:
  /// rim: distance from a block within which its rank must know a body.
  Neighbourhood(const lbm::Domain&, const rigid::World&, double rim, int rank);
  /// Returns the neighbourhood for the current partition of the domain.
  Neighbourhood renewed() const { return {*domain_, *world_, rim_, rank_}; }

  const rigid::World& world() const { return *world_; }
  const Holders& holders() const { return holders_; }
  int rank_at(const rigid::Vec3& x_W) const { return holders_.rank_at(x_W); }
  /// Finds the holders, sorted, of a body with this pose and displacement.
  void find_holders(int shape, const rigid::Pose&, const rigid::Twist& motion, std::vector<int>& ranks) const;
  /// Finds those of an owned body, also half a step later, with owners of bodies beyond its films.
  void find_holders(const rigid::BodySet&, std::size_t row, std::vector<int>& ranks) const;
  double reach() const { return reach_; }  // cells around the blocks of a rank
  /// Returns the other ranks with a block within reach of this rank's, sorted; a symmetric relation.
  const std::vector<int>& around() const { return around_; }

 private:
  void include_owners_beyond_films(const rigid::BodySet&, std::size_t row, std::vector<int>& ranks) const;

  const lbm::Domain* domain_;
  const rigid::World* world_;
  double rim_;
  int rank_;
  Holders holders_, owners_;  // within the rim of a block; within the motion of a step
  double largest_radius_;     // of all bodies
  double reach_;
  std::vector<int> around_;
};

/// Inserts a rank into sorted ones unless it is there.
void include(std::vector<int>& sorted, int rank);

}  // namespace silt::coupler
