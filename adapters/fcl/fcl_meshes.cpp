#include "adapters/fcl/fcl_meshes.hpp"

// Debian's FCL is built for plain x86-64, where Eigen aligns to 16 bytes; another value changes its types.
static_assert(EIGEN_MAX_ALIGN_BYTES == 16, "compile this file with EIGEN_MAX_ALIGN_BYTES=16");

namespace silt::adapters {

using namespace rigid;

namespace {

using Box = fcl::OBBd;
using Model = fcl::BVHModel<Box>;

Box wider(Box box, double margin) {
  box.extent.array() += margin;
  return box;
}

/// Calls use(triangle) for the leaves at and below a node that meet the box.
template <class Use>
void descend(const Model& model, int at, const Box& box, Use&& use) {
  const fcl::BVNode<Box>& node = model.getBV(at);
  if (!node.bv.overlap(box)) return;
  if (node.isLeaf()) return use(static_cast<std::uint32_t>(node.primitiveId()));
  descend(model, node.leftChild(), box, use);
  descend(model, node.rightChild(), box, use);
}

/// Two models, the second at a pose seen from the first.
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

}  // namespace

FclMeshes::Tree::Tree(const SharedMesh& of) : mesh(of) {
  std::vector<fcl::Vector3d> corners(of->vertices().begin(), of->vertices().end());
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(of->triangles().size());
  for (const auto& [a, b, c] : of->triangles()) triangles.emplace_back(a, b, c);
  model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(corners.size()));
  model.addSubModel(corners, triangles);
  model.endModel();
}

FclMeshes::Tree& FclMeshes::tree_of(const SharedMesh& mesh) {
  auto& tree = trees_[mesh.get()];
  if (!tree) tree = std::make_unique<Tree>(mesh);
  return *tree;
}

void FclMeshes::append_near(const SharedMesh& mesh, const BoundingBox& near,
                            std::vector<std::uint32_t>& out) {
  Box box;
  box.axis.setIdentity();
  box.To = 0.5 * (near.lower + near.upper);
  box.extent = 0.5 * (near.upper - near.lower);
  descend(tree_of(mesh).model, 0, box, [&](std::uint32_t triangle) { out.push_back(triangle); });
}

void FclMeshes::append_pairs_near(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b,
                                  const Pose& pose_b, double margin, std::vector<TrianglePair>& out) {
  const Pose seen = pose_b.seen_from(pose_a);
  const Descent descent{tree_of(a).model, tree_of(b).model, seen.orientation.toRotationMatrix(),
                        seen.position,    margin,           out};
  descent.go(0, 0);
}

}  // namespace silt::adapters
