
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>

#include "adapters/common/tree_broad_phase.hpp"
#include "adapters/fcl/fcl.hpp"

// Debian's FCL is built for plain x86-64, where Eigen aligns to 16 bytes; another value changes its types.
static_assert(EIGEN_MAX_ALIGN_BYTES == 16, "compile this file with EIGEN_MAX_ALIGN_BYTES=16");

namespace silt::adapters {

namespace {

class FclBroadPhase : public TreeBroadPhase {
 public:
  std::string_view name() const override { return "fcl"; }

 private:
  using Object = fcl::CollisionObjectd;

  static std::unique_ptr<Object> object_of(const Cube& cube) {
    const auto box = std::make_shared<fcl::Boxd>(rigid::Vec3::Constant(2 * cube.half_edge));
    return std::make_unique<Object>(box, rigid::Mat3::Identity(), cube.centre);
  }
  static Leaf leaf_of(const Object* object) {
    return static_cast<Leaf>(reinterpret_cast<std::uintptr_t>(object->getUserData()));
  }

  void place(Leaf leaf, const Cube& cube) override {
    if (leaf >= objects_.size()) objects_.resize(leaf + 1);
    if (objects_[leaf]) tree_.unregisterObject(objects_[leaf].get());
    objects_[leaf] = object_of(cube);
    objects_[leaf]->setUserData(reinterpret_cast<void*>(static_cast<std::uintptr_t>(leaf)));
    placed_.push_back(objects_[leaf].get());
  }

  void remove(Leaf leaf) override {
    tree_.unregisterObject(objects_[leaf].get());
    objects_[leaf].reset();
  }

  /// Into an empty tree all at once: it is then built from the top.
  void refresh() override {
    if (tree_.empty())
      tree_.registerObjects(placed_);
    else
      for (Object* object : placed_) tree_.registerObject(object);
    tree_.setup();
    placed_.clear();
  }

  void overlapping_pairs(std::vector<std::pair<Leaf, Leaf>>& pairs) override {
    tree_.collide(&pairs, [](Object* a, Object* b, void* found) {
      static_cast<std::vector<std::pair<Leaf, Leaf>>*>(found)->emplace_back(leaf_of(a), leaf_of(b));
      return false;
    });
  }

  void overlapping(const Cube& cube, std::vector<Leaf>& leaves) override {
    tree_.collide(object_of(cube).get(), &leaves, [](Object* in_tree, Object*, void* found) {
      static_cast<std::vector<Leaf>*>(found)->push_back(leaf_of(in_tree));
      return false;
    });
  }

  fcl::DynamicAABBTreeCollisionManagerd tree_;
  std::vector<std::unique_ptr<Object>> objects_;  // of the leaves
  std::vector<Object*> placed_;                   // since the last refresh
};

}  // namespace

std::unique_ptr<rigid::BroadPhase> make_fcl_broad_phase() {
  return std::make_unique<FclBroadPhase>();
}

}  // namespace silt::adapters
