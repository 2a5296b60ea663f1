// btDbvt itself and not btDbvtBroadphase, which keeps a table of pairs from step to step that has to be
// cleared of stale ones (three times the cost at 100 000 bodies).

#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include "adapters/bullet/bullet.hpp"
#include "adapters/common/tree_broad_phase.hpp"

#ifndef BT_USE_DOUBLE_PRECISION
#error "build against bullet-float64"
#endif

namespace silt::adapters {

namespace {

class BulletBroadPhase : public TreeBroadPhase {
 public:
  std::string_view name() const override { return "bullet"; }

 private:
  static btDbvtVolume volume_of(const Cube& c) {
    return btDbvtVolume::FromCR(btVector3(c.centre.x(), c.centre.y(), c.centre.z()), c.half_edge);
  }

  void place(Leaf leaf, const Cube& cube) override {
    btDbvtVolume volume = volume_of(cube);
    if (leaf >= nodes_.size()) nodes_.resize(leaf + 1, nullptr);
    if (nodes_[leaf]) {
      tree_.update(nodes_[leaf], volume);
    } else {
      nodes_[leaf] = tree_.insert(volume, nullptr);
      nodes_[leaf]->dataAsInt = static_cast<int>(leaf);
      ++inserted_;
    }
  }

  void remove(Leaf leaf) override {
    tree_.remove(nodes_[leaf]);
    nodes_[leaf] = nullptr;
  }

  /// Leaves put in one after the other make a poor tree.
  void refresh() override {
    if (2 * inserted_ > tree_.m_leaves)
      tree_.optimizeTopDown();
    else
      tree_.optimizeIncremental(1 + tree_.m_leaves / 100);
    inserted_ = 0;
  }

  void overlapping_pairs(std::vector<std::pair<Leaf, Leaf>>& pairs) override {
    struct Collect : btDbvt::ICollide {
      std::vector<std::pair<Leaf, Leaf>>& pairs;
      explicit Collect(std::vector<std::pair<Leaf, Leaf>>& p) : pairs(p) {}
      void Process(const btDbvtNode* a, const btDbvtNode* b) override {
        pairs.emplace_back(a->dataAsInt, b->dataAsInt);
      }
    } collect(pairs);
    tree_.collideTTpersistentStack(tree_.m_root, tree_.m_root, collect);
  }

  void overlapping(const Cube& cube, std::vector<Leaf>& leaves) override {
    struct Collect : btDbvt::ICollide {
      std::vector<Leaf>& leaves;
      explicit Collect(std::vector<Leaf>& l) : leaves(l) {}
      void Process(const btDbvtNode* a) override { leaves.push_back(static_cast<Leaf>(a->dataAsInt)); }
    } collect(leaves);
    tree_.collideTVNoStackAlloc(tree_.m_root, volume_of(cube), stack_, collect);
  }

  btDbvt tree_;
  std::vector<btDbvtNode*> nodes_;  // of the leaves; the tree owns them
  btNodeStack stack_;
  int inserted_ = 0;  // since the last refresh
};

}  // namespace

std::unique_ptr<rigid::BroadPhase> make_bullet_broad_phase() {
  check_bullet_precision();
  return std::make_unique<BulletBroadPhase>();
}

}  // namespace silt::adapters
