// The trees of Bullet: of the bodies, and of the triangles of a mesh.
#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>

#include "adapters/common/engine_backend.hpp"

#ifndef BT_USE_DOUBLE_PRECISION
#error "build against bullet-float64"
#endif

namespace silt::adapters {

using namespace rigid;

namespace {

btVector3 to_bullet(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// The index of a triangle has 21 bits in Bullet's quantized tree.
bool may_quantize(const TriangleMesh& mesh) {
  return mesh.triangles().size() < std::size_t{1} << (31 - MAX_NUM_PARTS_IN_BITS);
}

btTriangleIndexVertexArray array_of(const TriangleMesh& mesh) {
  btIndexedMesh all;
  all.m_numTriangles = int(mesh.triangles().size());
  all.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(mesh.triangles().data());
  all.m_triangleIndexStride = sizeof(TriangleMesh::Triangle);
  all.m_numVertices = int(mesh.vertices().size());
  all.m_vertexBase = reinterpret_cast<const unsigned char*>(mesh.vertices().data());
  all.m_vertexStride = sizeof(Vec3);
  all.m_vertexType = PHY_DOUBLE;
  btTriangleIndexVertexArray array;
  array.addIndexedMesh(all, PHY_INTEGER);
  return array;
}

class BulletTree : public MeshTree {
 public:
  explicit BulletTree(const SharedMesh& of)
      : mesh_(of), triangles_(array_of(*of)), shape_(&triangles_, may_quantize(*of)) {}

  void append_near(const BoundingBox& near, std::vector<std::uint32_t>& out) override {
    struct Collect : btTriangleCallback {
      std::vector<std::uint32_t>& found;
      explicit Collect(std::vector<std::uint32_t>& into) : found(into) {}
      void processTriangle(btVector3*, int, int triangle) override { found.push_back(triangle); }
    } collect(out);
    shape_.processAllTriangles(&collect, to_bullet(near.lower), to_bullet(near.upper));
  }

  void append_pairs_near(MeshTree& other, const Pose& pose, const Pose& pose_of_other, double margin,
                         std::vector<TrianglePair>& out) override {
    auto& b = static_cast<BulletTree&>(other);
    if (mesh_->triangles().size() <= b.mesh_->triangles().size())
      ask(b, pose.relative_to(pose_of_other), margin, [&](std::uint32_t own, std::uint32_t found) {
        out.push_back({own, found});
      });
    else
      b.ask(*this, pose_of_other.relative_to(pose), margin, [&](std::uint32_t own, std::uint32_t found) {
        out.push_back({found, own});
      });
  }

 private:
  /// Calls use(own triangle, triangle of `large`), with the own triangles at a pose relative to `large`.
  template <class Use>
  void ask(BulletTree& large, const Pose& seen, double margin, Use&& use) {
    const Mat3 turn = seen.orientation.toRotationMatrix();
    const BoundingBox& all = large.mesh_->box();
    const Vec3 half = turn.cwiseAbs().transpose() * (0.5 * (all.upper - all.lower));
    own_.clear();
    append_near(BoundingBox::around(turn.transpose() * (0.5 * (all.lower + all.upper) - seen.position),
                                    half + Vec3::Constant(margin)),
                own_);
    for (const std::uint32_t t : own_) {
      BoundingBox box = BoundingBox::empty();
      for (const Vec3& x : mesh_->corners(t)) {
        const Vec3 y = seen.position + turn * x;
        box.add({y - Vec3::Constant(margin), y + Vec3::Constant(margin)});
      }
      near_.clear();
      large.append_near(box, near_);
      for (const std::uint32_t r : near_) use(t, r);
    }
  }

  SharedMesh mesh_;  // Bullet refers to its vertices
  btTriangleIndexVertexArray triangles_;
  btBvhTriangleMeshShape shape_;
  std::vector<std::uint32_t> own_, near_;
};

/// Uses btDbvt directly: btDbvtBroadphase keeps a table of pairs between steps that has to be cleared of
/// stale ones (three times the cost at 100 000 bodies).
class BulletBroadPhase : public TreeBroadPhase {
 public:
  std::string_view name() const override { return "bullet"; }

 private:
  static btDbvtVolume volume_of(const Cube& c) {
    return btDbvtVolume::FromCR(to_bullet(c.centre), c.half_edge);
  }

  void place(Leaf leaf, const Cube& cube) override {
    btDbvtVolume volume = volume_of(cube);
    if (leaf >= nodes_.size()) nodes_.resize(leaf + 1, nullptr);
    if (nodes_[leaf]) {
      tree_.update(nodes_[leaf], volume);
    } else {
      nodes_[leaf] = tree_.insert(volume, nullptr);
      nodes_[leaf]->dataAsInt = int(leaf);
      ++inserted_;
    }
  }

  void remove(Leaf leaf) override {
    tree_.remove(nodes_[leaf]);
    nodes_[leaf] = nullptr;
  }

  /// Rebuilds a tree whose leaves were mostly inserted one by one, which makes a poor tree.
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
  std::vector<btDbvtNode*> nodes_;  // of the leaves; owned by the tree
  btNodeStack stack_;
  int inserted_ = 0;  // since the last refresh
};

}  // namespace

std::unique_ptr<MeshTree> make_bullet_tree(const SharedMesh& mesh) {
  return std::make_unique<BulletTree>(mesh);
}

std::unique_ptr<rigid::BroadPhase> make_bullet_broad_phase() {
  check_bullet_precision();
  return std::make_unique<BulletBroadPhase>();
}

}  // namespace silt::adapters
