#include "adapters/common/tree_broad_phase.hpp"

#include <algorithm>

namespace silt::adapters {

using rigid::Image;
using rigid::Vec3;

namespace {

/// Distance that a body may move before its leaf does, relative to its reach. More gives more pairs to test.
constexpr double slack = 0.05;
/// Relative rounding of coordinates, by which cubes are enlarged so that no pair that meets is missed.
constexpr double rounding = 1e-14;

struct Bounds {
  Vec3 lower = Vec3::Constant(1e300), upper = Vec3::Constant(-1e300);

  template <class Cube>
  void add(const Cube& c) {
    lower = lower.cwiseMin(c.centre - Vec3::Constant(c.half_edge));
    upper = upper.cwiseMax(c.centre + Vec3::Constant(c.half_edge));
  }
  template <class Cube>
  bool overlap(const Cube& c) const {
    return ((c.centre.array() + c.half_edge) >= lower.array()).all() &&
           ((c.centre.array() - c.half_edge) <= upper.array()).all();
  }
};

}  // namespace

TreeBroadPhase::Leaf TreeBroadPhase::leaf_of(rigid::BodyId id, std::size_t row) {
  if (row < by_row_.size() && leaves_[by_row_[row]].id == id) return by_row_[row];
  const auto [at, is_new] = by_id_.try_emplace(id, 0);
  if (!is_new) return at->second;
  if (free_.empty()) {
    free_.push_back(static_cast<Leaf>(leaves_.size()));
    leaves_.emplace_back();
  }
  at->second = free_.back();
  free_.pop_back();
  leaves_[at->second] = {id, row, {}, 0};
  return at->second;
}

/// Updates the leaves to the present bodies and their positions.
void TreeBroadPhase::update_leaves(const rigid::Surroundings& around) {
  ++step_;
  reach_.resize(around.size());
  std::vector<Leaf> by_row(around.size());
  for (std::size_t row = 0; row < around.size(); ++row) {
    const Vec3& x = around.bodies.position[row];
    const double tight = around.reach[row].sum();
    const double half_edge =
        tight + rounding * (tight + x.lpNorm<Eigen::Infinity>() + around.extent.size.maxCoeff());
    reach_[row] = {x, half_edge};
    by_row[row] = leaf_of(around.bodies.id[row], row);
    Known& leaf = leaves_[by_row[row]];
    leaf.row = row;
    const double spare = leaf.cube.half_edge - half_edge;
    if (leaf.seen == 0 || (x - leaf.cube.centre).lpNorm<Eigen::Infinity>() > spare ||
        spare > 4 * slack * half_edge) {
      leaf.cube = {x, (1 + slack) * half_edge};
      place(by_row[row], leaf.cube);
    }
    leaf.seen = step_;
  }
  by_row_ = std::move(by_row);
}

void TreeBroadPhase::remove_absent() {
  if (by_id_.size() == by_row_.size()) return;
  for (Leaf k = 0; k < leaves_.size(); ++k) {
    Known& leaf = leaves_[k];
    if (leaf.seen == 0 || leaf.seen == step_) continue;
    remove(k);
    by_id_.erase(leaf.id);
    free_.push_back(k);
    leaf.seen = 0;
  }
}

void TreeBroadPhase::find_images(const rigid::Surroundings& around,
                                 std::vector<rigid::CandidatePair>& found) {
  // opposite images give the same pairs as seen from either body: half of the images suffice
  std::vector<Image> images = rigid::images_of(around.extent);
  std::erase_if(images, [](Image image) { return image <= Image{}; });
  if (images.empty()) return;
  Bounds all;
  for (const Leaf k : by_row_) all.add(leaves_[k].cube);
  for (std::size_t row = 0; row < around.size(); ++row)
    for (const Image image : images) {
      const Cube shifted{reach_[row].centre - around.extent.shift(image), reach_[row].half_edge};
      if (!all.overlap(shifted)) continue;
      hits_.clear();
      overlapping(shifted, hits_);
      for (const Leaf k : hits_) {
        if (leaves_[k].row == row) continue;
        const rigid::CandidatePair pair = around.in_order(row, leaves_[k].row, image);
        if (around.meet(pair)) found.push_back(pair);
      }
    }
}

void TreeBroadPhase::find_pairs(const rigid::Surroundings& around, std::vector<rigid::CandidatePair>& found) {
  update_leaves(around);
  remove_absent();
  refresh();
  pairs_.clear();
  overlapping_pairs(pairs_);
  for (const auto& [p, q] : pairs_) {
    const rigid::CandidatePair pair = around.in_order(leaves_[p].row, leaves_[q].row, {});
    if (around.meet(pair)) found.push_back(pair);
  }
  find_images(around, found);
}

}  // namespace silt::adapters
