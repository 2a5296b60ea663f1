#pragma once
// The meshes as FCL has them: its tree says which triangles are near.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBB.h>

#include <map>
#include <memory>

#include "rigid/collision/triangle_search.hpp"

namespace silt::adapters {

/// One BVHModel of oriented boxes a mesh, made when it is first asked about. Its nodes and their test of
/// overlap are FCL's, the walk down the tree is not: FCL's own ends at each triangle in libccd, which loses
/// triangles that touch. Boxes that have spheres swept besides (OBBRSS) serve distances only, and take twice
/// the memory: as it is some 300 bytes a triangle.
class FclMeshes {
 public:
  using SharedMesh = std::shared_ptr<const rigid::TriangleMesh>;
  /// As CollisionBackend::triangles_near.
  void append_near(const SharedMesh&, const rigid::BoundingBox& near, std::vector<std::uint32_t>& out);
  /// As CollisionBackend::triangle_pairs_near, down both trees at once.
  void append_pairs_near(const SharedMesh& a, const rigid::Pose& pose_a, const SharedMesh& b,
                         const rigid::Pose& pose_b, double margin, std::vector<rigid::TrianglePair>& out);

 private:
  using Box = fcl::OBBd;
  struct Tree {
    explicit Tree(const SharedMesh&);
    SharedMesh mesh;  // so that no other takes its address
    fcl::BVHModel<Box> model;
  };
  Tree& tree_of(const SharedMesh&);

  std::map<const rigid::TriangleMesh*, std::unique_ptr<Tree>> trees_;
};

}  // namespace silt::adapters
