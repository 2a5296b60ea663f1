#pragma once
// What collision engines share: a backend with its query, check of the answer, fallback and contact points; a
// broad phase on the engine's tree of boxes, with a leaf for each body, kept between steps, periodic images,
// and the exact selection of pairs; and the engines of this program.
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "rigid/collision/broad_phase.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/convex_core.hpp"

namespace silt::adapters {

using rigid::SharedMesh;
using rigid::Vec3;

/// Tolerance for the agreement of an engine's answer with the supporting planes, relative to length_scale
/// (sizes and distance, some 60 lattice units for bodies of 10: 6e-10 of a cell).
inline constexpr double answer_tolerance = 1e-11;
/// Angle (radians) within which a normal becomes that of a face or crossed edges (not for spheres).
inline constexpr double snap_angle = 1e-7;

/// The same tolerance for a pair with a cylinder, an ellipsoid or a polyhedron: engines find the normal of
/// curved shapes to 1e-4 or worse, the gap to 1e-5.
inline constexpr double curved_tolerance = 1e-5;

struct Query {
  const rigid::ConvexShape &a, &b;
  const rigid::Pose &pose_a, &pose_b;
  double tolerance;  // largest gap of a contact, lattice units
};

/// An engine's result: the deepest (or nearest) point of a pair.
struct Answer {
  Vec3 normal;  // unit, from a to b
  double gap;   // lattice units, < 0: overlap
  /// Length by which the engine pads the gap (lattice units), if known; then only the normal is used.
  double padding = 0;
};

/// Returns n . (support of b along -n - support of a along n): at most the gap.
double support_gap(const Query&, const Vec3& n);

/// An engine's tree of the triangles of a mesh.
class MeshTree {
 public:
  virtual ~MeshTree() = default;
  /// See CollisionBackend::triangles_near and triangle_pairs_near; `other` is a tree of the same engine.
  virtual void append_near(const rigid::BoundingBox& near, std::vector<std::uint32_t>& out) = 0;
  virtual void append_pairs_near(MeshTree& other, const rigid::Pose& pose, const rigid::Pose& pose_of_other,
                                 double margin, std::vector<rigid::TrianglePair>& out) = 0;
};

/// The engine gives normal and gap of the deepest point, and both are checked: the gap must be that of the
/// supporting planes, n . (support_B(-n) - support_A(n)), and for overlap no direction may exceed it by more
/// than rounding. "No contact" is checked, too. A failure is counted, and the engine's next method tried,
/// finally closed forms. With a cylinder, an ellipsoid or a polyhedron climb() starts from the engine's
/// normal, and its result, once proven (proven_direction), is used; an engine's answer that differs from it
/// has failed. The other points of a flat contact come from append_manifold.
class EngineBackend : public rigid::CollisionBackend {
 public:
  void collide(const rigid::ConvexShape& a, const rigid::Pose& pose_a, const rigid::ConvexShape& b,
               const rigid::Pose& pose_b, double tolerance, std::vector<rigid::ContactPoint>& out) override;

 protected:
  /// Returns the number of methods that the engine has for this pair, best first.
  virtual int methods(const Query&) const = 0;
  /// Returns the deepest point; nothing if the engine finds no contact within the tolerance.
  virtual std::optional<Answer> ask(int method, const Query&) = 0;
  /// Is called once for each mesh.
  virtual std::unique_ptr<MeshTree> make_tree(const SharedMesh&) = 0;

 private:
  bool finds_triangles() const override { return true; }
  void find_triangles(const SharedMesh&, const rigid::BoundingBox& near,
                      std::vector<std::uint32_t>& out) override;
  void find_triangle_pairs(const SharedMesh& a, const rigid::Pose& pose_a, const SharedMesh& b,
                           const rigid::Pose& pose_b, double margin,
                           std::vector<rigid::TrianglePair>& out) override;
  MeshTree& tree_of(const SharedMesh&);
  void collide_boxes(const Query&, const rigid::ConvexCore& a, const rigid::ConvexCore& b,
                     std::vector<rigid::ContactPoint>& out);
  void collide_convex(const Query&, const rigid::ConvexCore& a, const rigid::ConvexCore& b,
                      std::vector<rigid::ContactPoint>& out);
  /// Queries the engine about a half-space and counts wrong answers.
  void check_plane(const Query&);

  std::map<SharedMesh, std::unique_ptr<MeshTree>> trees_;
};

/// A leaf is a cube around a body's reach, slightly larger, so that it stays while the body moves inside. Two
/// bodies with overlapping cubes are a pair if they meet (rigid/collision/broad_phase). Images are found by
/// querying the tree with cubes that extend beyond a periodic side, shifted by the period. Thus the pairs do
/// not depend on the tree or its history.
class TreeBroadPhase : public rigid::BroadPhase {
 protected:
  using Leaf = std::uint32_t;  // less than the largest number of bodies so far
  struct Cube {
    rigid::Vec3 centre = rigid::Vec3::Zero();
    double half_edge = 0;  // < 0: empty
  };

 private:
  /// Inserts a leaf, or changes its cube.
  virtual void place(Leaf, const Cube&) = 0;
  virtual void remove(Leaf) = 0;
  /// Is called after the last change in a step, before queries.
  virtual void refresh() = 0;
  /// Append at least all pairs of leaves with overlapping cubes, and all leaves whose cubes overlap one.
  virtual void overlapping_pairs(std::vector<std::pair<Leaf, Leaf>>&) = 0;
  virtual void overlapping(const Cube&, std::vector<Leaf>&) = 0;

  void find_pairs(const rigid::Surroundings&, std::vector<rigid::CandidatePair>& found) final;
  void update_leaves(const rigid::Surroundings&);
  Leaf leaf_of(rigid::BodyId, std::size_t row);
  void remove_absent();
  void find_images(const rigid::Surroundings&, std::vector<rigid::CandidatePair>& found);

  struct Known {  // the state of a leaf
    rigid::BodyId id;
    std::size_t row;
    Cube cube;
    std::uint64_t seen;  // last step in which the body was present; 0: never
  };
  std::vector<Known> leaves_;
  std::vector<Leaf> free_;
  std::unordered_map<rigid::BodyId, Leaf> by_id_;
  std::vector<Leaf> by_row_;  // in the last step
  std::vector<Cube> reach_;   // of each row, without slack
  std::uint64_t step_ = 0;
  std::vector<std::pair<Leaf, Leaf>> pairs_;
  std::vector<Leaf> hits_;
};

// "bullet": Bullet in double precision.

/// All throw std::runtime_error if the Bullet found at run time does not compute in double precision.
void check_bullet_precision();
std::unique_ptr<rigid::CollisionBackend> make_bullet_backend();
/// The dynamic tree of boxes of Bullet's btDbvtBroadphase.
std::unique_ptr<rigid::BroadPhase> make_bullet_broad_phase();

/// A btBvhTriangleMeshShape. Bullet rounds boxes outward to 2^-16 of the mesh's box. For two meshes each
/// triangle of the smaller one queries the tree of the larger.
std::unique_ptr<MeshTree> make_bullet_tree(const SharedMesh&);

// "fcl": the Flexible Collision Library with libccd.

std::unique_ptr<rigid::CollisionBackend> make_fcl_backend();
/// FCL's dynamic tree of boxes.
std::unique_ptr<rigid::BroadPhase> make_fcl_broad_phase();

/// A BVHModel of oriented boxes, with FCL's nodes and overlap test but its own traversal: FCL's traversal
/// calls libccd for each triangle, which misses touching triangles. OBBRSS would serve distances only and
/// double the memory (some 300 bytes per triangle as it is).
std::unique_ptr<MeshTree> make_fcl_tree(const SharedMesh&);

}  // namespace silt::adapters
