// The meshes as Bullet has them: its tree says which triangles are near.
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>

#include "adapters/bullet/bullet.hpp"

namespace silt::adapters {

using namespace rigid;

namespace {

btVector3 to_bullet(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Its index of a triangle has 21 bits in a quantized tree.
bool may_quantize(const TriangleMesh& mesh) {
  return mesh.triangles().size() < std::size_t{1} << (31 - MAX_NUM_PARTS_IN_BITS);
}

btTriangleIndexVertexArray array_of(const TriangleMesh& mesh) {
  btIndexedMesh all;
  all.m_numTriangles = static_cast<int>(mesh.triangles().size());
  all.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(mesh.triangles().data());
  all.m_triangleIndexStride = sizeof(TriangleMesh::Triangle);
  all.m_numVertices = static_cast<int>(mesh.vertices().size());
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
      ask(b, pose.seen_from(pose_of_other), margin, [&](std::uint32_t own, std::uint32_t found) {
        out.push_back({own, found});
      });
    else
      b.ask(*this, pose_of_other.seen_from(pose), margin, [&](std::uint32_t own, std::uint32_t found) {
        out.push_back({found, own});
      });
  }

 private:
  /// Calls use(own triangle, triangle of `large`), the own ones at a pose seen from `large`.
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

  SharedMesh mesh_;  // Bullet refers to its corners
  btTriangleIndexVertexArray triangles_;
  btBvhTriangleMeshShape shape_;
  std::vector<std::uint32_t> own_, near_;
};

}  // namespace

std::unique_ptr<MeshTree> make_bullet_tree(const SharedMesh& mesh) {
  return std::make_unique<BulletTree>(mesh);
}

}  // namespace silt::adapters
