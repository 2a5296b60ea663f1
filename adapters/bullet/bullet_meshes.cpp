#include "adapters/bullet/bullet_meshes.hpp"

namespace silt::adapters {

using namespace rigid;

namespace {

btVector3 to_bullet(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

struct Collect : btTriangleCallback {
  std::vector<std::uint32_t>& found;
  explicit Collect(std::vector<std::uint32_t>& into) : found(into) {}
  void processTriangle(btVector3*, int, int triangle) override { found.push_back(triangle); }
};

/// Its index of a triangle has 21 bits in a quantized tree.
bool may_quantize(const TriangleMesh& mesh) {
  return mesh.triangles().size() < std::size_t{1} << (31 - MAX_NUM_PARTS_IN_BITS);
}

btIndexedMesh indexed(const TriangleMesh& mesh) {
  btIndexedMesh all;
  all.m_numTriangles = static_cast<int>(mesh.triangles().size());
  all.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(mesh.triangles().data());
  all.m_triangleIndexStride = sizeof(TriangleMesh::Triangle);
  all.m_numVertices = static_cast<int>(mesh.vertices().size());
  all.m_vertexBase = reinterpret_cast<const unsigned char*>(mesh.vertices().data());
  all.m_vertexStride = sizeof(Vec3);
  all.m_vertexType = PHY_DOUBLE;
  return all;
}

btTriangleIndexVertexArray array_of(const TriangleMesh& mesh) {
  btTriangleIndexVertexArray array;
  array.addIndexedMesh(indexed(mesh), PHY_INTEGER);
  return array;
}

}  // namespace

BulletMeshes::Tree::Tree(const SharedMesh& of)
    : mesh(of), triangles(array_of(*of)), shape(&triangles, may_quantize(*of)) {}

BulletMeshes::Tree& BulletMeshes::tree_of(const SharedMesh& mesh) {
  auto& tree = trees_[mesh.get()];
  if (!tree) tree = std::make_unique<Tree>(mesh);
  return *tree;
}

void BulletMeshes::append_near(const SharedMesh& mesh, const BoundingBox& near,
                               std::vector<std::uint32_t>& out) {
  Collect collect(out);
  tree_of(mesh).shape.processAllTriangles(&collect, to_bullet(near.lower), to_bullet(near.upper));
}

void BulletMeshes::append_pairs_near(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b,
                                     const Pose& pose_b, double margin, std::vector<TrianglePair>& out) {
  const bool a_asks = a->triangles().size() <= b->triangles().size();
  const SharedMesh &small = a_asks ? a : b, &large = a_asks ? b : a;
  const Pose seen = a_asks ? pose_a.seen_from(pose_b) : pose_b.seen_from(pose_a);
  const Mat3 turn = seen.orientation.toRotationMatrix();
  const BoundingBox& all = large->box();
  const Vec3 half = turn.cwiseAbs().transpose() * (0.5 * (all.upper - all.lower));
  of_other_.clear();
  append_near(small,
              BoundingBox::around(turn.transpose() * (0.5 * (all.lower + all.upper) - seen.position),
                                  half + Vec3::Constant(margin)),
              of_other_);
  for (const std::uint32_t t : of_other_) {
    BoundingBox box = BoundingBox::empty();
    for (const Vec3& x : small->corners(t)) {
      const Vec3 y = seen.position + turn * x;
      box.add({y - Vec3::Constant(margin), y + Vec3::Constant(margin)});
    }
    near_.clear();
    append_near(large, box, near_);
    for (const std::uint32_t r : near_) out.push_back(a_asks ? TrianglePair{t, r} : TrianglePair{r, t});
  }
}

}  // namespace silt::adapters
