#pragma once
// The common part of backends on an engine: query, check of the answer, fallback, contact points.
#include <map>
#include <optional>

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

}  // namespace silt::adapters
