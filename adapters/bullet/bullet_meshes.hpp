#pragma once
// The meshes as Bullet has them: its tree says which triangles are near.
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>

#include <map>
#include <memory>

#include "rigid/collision/triangle_search.hpp"

namespace silt::adapters {

/// One btBvhTriangleMeshShape a mesh, made when it is first asked about.
class BulletMeshes {
 public:
  using SharedMesh = std::shared_ptr<const rigid::TriangleMesh>;
  /// As CollisionBackend::triangles_near. Bullet rounds boxes outward to 2^-16 of the mesh's.
  void append_near(const SharedMesh&, const rigid::BoundingBox& near, std::vector<std::uint32_t>& out);
  /// As CollisionBackend::triangle_pairs_near: the triangles of the smaller mesh, one after the other, ask
  /// the tree of the larger.
  void append_pairs_near(const SharedMesh& a, const rigid::Pose& pose_a, const SharedMesh& b,
                         const rigid::Pose& pose_b, double margin, std::vector<rigid::TrianglePair>& out);

 private:
  struct Tree {
    explicit Tree(const SharedMesh&);
    SharedMesh mesh;  // Bullet refers to its corners
    btTriangleIndexVertexArray triangles;
    btBvhTriangleMeshShape shape;
  };
  Tree& tree_of(const SharedMesh&);

  std::map<const rigid::TriangleMesh*, std::unique_ptr<Tree>> trees_;
  std::vector<std::uint32_t> near_, of_other_;
};

}  // namespace silt::adapters
