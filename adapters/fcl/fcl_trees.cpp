// The trees of FCL: of the bodies, and of the triangles of a mesh.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/math/bv/OBB.h>

#include "adapters/common/engine_backend.hpp"

// Debian's FCL is built for plain x86-64, where Eigen aligns to 16 bytes; another value changes its types.
static_assert(EIGEN_MAX_ALIGN_BYTES == 16, "compile this file with EIGEN_MAX_ALIGN_BYTES=16");

namespace silt::adapters {

using namespace rigid;

namespace {

using OrientedBox = fcl::OBBd;
using Model = fcl::BVHModel<OrientedBox>;

OrientedBox wider(OrientedBox box, double margin) {
  box.extent.array() += margin;
  return box;
}

/// Calls use(triangle) for the leaves below a node that overlap the box.
template <class Use>
void descend(const Model& model, int at, const OrientedBox& box, Use&& use) {
  const fcl::BVNode<OrientedBox>& node = model.getBV(at);
  if (!node.bv.overlap(box)) return;
  if (node.isLeaf()) return use(std::uint32_t(node.primitiveId()));
  descend(model, node.leftChild(), box, use);
  descend(model, node.rightChild(), box, use);
}

/// Simultaneous traversal of two models, the second at a pose relative to the first.
struct Descent {
  const Model &a, &b;
  Mat3 turn;
  Vec3 shift;
  double margin;
  std::vector<TrianglePair>& out;

  void go(int at_a, int at_b) const {
    const auto &in_a = a.getBV(at_a), &in_b = b.getBV(at_b);
    if (!fcl::overlap(turn, shift, wider(in_a.bv, margin), in_b.bv)) return;
    if (in_a.isLeaf() && in_b.isLeaf()) {
      out.push_back({in_a.primitiveId(), in_b.primitiveId()});
    } else if (in_b.isLeaf() || (!in_a.isLeaf() && in_a.bv.size() > in_b.bv.size())) {
      go(in_a.leftChild(), at_b);
      go(in_a.rightChild(), at_b);
    } else {
      go(at_a, in_b.leftChild());
      go(at_a, in_b.rightChild());
    }
  }
};

class FclTree : public MeshTree {
 public:
  explicit FclTree(const TriangleMesh& mesh) {
    std::vector<fcl::Vector3d> corners(mesh.vertices().begin(), mesh.vertices().end());
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(mesh.triangles().size());
    for (const auto& [a, b, c] : mesh.triangles()) triangles.emplace_back(a, b, c);
    model_.beginModel(int(triangles.size()), int(corners.size()));
    model_.addSubModel(corners, triangles);
    model_.endModel();
  }
  void append_near(const BoundingBox& near, std::vector<std::uint32_t>& out) override {
    OrientedBox box;
    box.axis.setIdentity();
    box.To = 0.5 * (near.lower + near.upper);
    box.extent = 0.5 * (near.upper - near.lower);
    descend(model_, 0, box, [&](std::uint32_t triangle) { out.push_back(triangle); });
  }
  void append_pairs_near(MeshTree& other, const Pose& pose, const Pose& pose_of_other, double margin,
                         std::vector<TrianglePair>& out) override {
    const Pose seen = pose_of_other.relative_to(pose);
    const Descent descent{model_,
                          static_cast<FclTree&>(other).model_,
                          seen.orientation.toRotationMatrix(),
                          seen.position,
                          margin,
                          out};
    descent.go(0, 0);
  }

 private:
  Model model_;
};

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

  /// An empty tree gets all objects at once, so that FCL builds it top-down.
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

std::unique_ptr<MeshTree> make_fcl_tree(const SharedMesh& mesh) {
  return std::make_unique<FclTree>(*mesh);
}

std::unique_ptr<rigid::BroadPhase> make_fcl_broad_phase() {
  return std::make_unique<FclBroadPhase>();
}

}  // namespace silt::adapters
