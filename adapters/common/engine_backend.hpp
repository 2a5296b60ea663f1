#pragma once
// The part that all backends share: to ask the engine, check the answer, fall back, and build the points.
#include <map>
#include <optional>

#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/convex_core.hpp"

namespace silt::adapters {

using rigid::SharedMesh;
using rigid::Vec3;

/// An engine's answer is taken where it agrees with the supporting planes to this part of the pair's size
/// (length_scale, sizes and distance: some 60 lattice units for bodies of 10, so 6e-10 of a cell).
inline constexpr double answer_tolerance = 1e-11;
/// A normal this near (radian) to that of a face or of two crossed edges is taken to be it (not for spheres).
inline constexpr double snap_angle = 1e-7;

/// The tolerance is wider for a pair with a cylinder, an ellipsoid or a polyhedron: engines find the normal
/// of curved shapes to 1e-4 or worse, the gap to 1e-5.
inline constexpr double curved_tolerance = 1e-5;

struct Query {
  const rigid::ConvexShape &a, &b;
  const rigid::Pose &pose_a, &pose_b;
  double tolerance;  // lattice units: the gap up to which contacts are wanted
};

/// The deepest (or nearest) point of a pair, as an engine sees it.
struct Answer {
  Vec3 normal;  // unit, from a to b
  double gap;   // lattice units, < 0: overlap
  /// The engine pads the gap by this length (lattice units), if known; only the normal then counts.
  double padding = 0;
};

/// n . (support of b along -n - support of a along n), by rigid::support: the gap if n is the contact's
/// normal, and never more than the gap.
double support_gap(const Query&, const Vec3& n);

/// An engine's tree of the triangles of one mesh.
class MeshTree {
 public:
  virtual ~MeshTree() = default;
  /// See CollisionBackend::triangles_near and triangle_pairs_near; `other` is a tree of the same engine.
  virtual void append_near(const rigid::BoundingBox& near, std::vector<std::uint32_t>& out) = 0;
  virtual void append_pairs_near(MeshTree& other, const rigid::Pose& pose, const rigid::Pose& pose_of_other,
                                 double margin, std::vector<rigid::TrianglePair>& out) = 0;
};

/// The engine gives normal and gap of the deepest point. They are checked: the gap must be that of the
/// supporting planes, n . (support_B(-n) - support_A(n)), which for overlap no direction may exceed by more
/// than rounding. "No contact" is checked too. A pair that fails is counted and asked by the engine's next
/// method, at last by closed forms. With a cylinder, an ellipsoid or a polyhedron climb() starts from the
/// engine's normal; the direction it arrives at is proven (proven_direction) and taken, and an engine's
/// answer that differs from it has failed. The other points of a flat contact are built along the engine's
/// normal by append_manifold, alike for every engine, because engines give between one and four.
class EngineBackend : public rigid::CollisionBackend {
 public:
  void collide(const rigid::ConvexShape& a, const rigid::Pose& pose_a, const rigid::ConvexShape& b,
               const rigid::Pose& pose_b, double tolerance, std::vector<rigid::ContactPoint>& out) override;

 protected:
  /// How many ways to ask the engine about this pair, best first.
  virtual int methods(const Query&) const = 0;
  /// The deepest point; nothing where the engine sees no contact within the tolerance.
  virtual std::optional<Answer> ask(int method, const Query&) = 0;
  /// Called once for each mesh that is asked about.
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
  /// Asks the engine about a half-space and counts where it is wrong.
  void check_plane(const Query&);

  std::map<SharedMesh, std::unique_ptr<MeshTree>> trees_;
};

}  // namespace silt::adapters
