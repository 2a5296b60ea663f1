#pragma once
// The narrow phase rigid/ asks for contact points, one pair of convex shapes at a time, and for the triangles
// of meshes that are near. Engines implement it in adapters/; rigid/ never sees them.
#include <cstdint>
#include <string_view>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::rigid {

using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// The queries to the narrow phase, and how many of them an engine answered. A query that is neither answered
/// nor refined is ours, checked by the engine or not.
struct BackendCounters {
  std::uint64_t queries = 0;    // pairs of shapes, and meshes asked for triangles
  std::uint64_t answered = 0;   // an engine's answer was taken: its normal, that there is none, its triangles
  std::uint64_t refined = 0;    // an engine's normal was where our search for the exact one started
  std::uint64_t fallbacks = 0;  // answers that failed their check and were replaced by another method's
};

class CollisionBackend {
 public:
  virtual ~CollisionBackend() = default;
  virtual std::string_view name() const = 0;
  /// Says whether collide() answers the pair: every bounded convex shape against every convex shape,
  /// polyhedra of up to some 10000 vertices (has_codes).
  bool supports(const ConvexShape& a, const ConvexShape& b) const;
  /// Appends every contact point with gap <= tolerance (lattice units) between a and b. Poses are relative to
  /// the first *body* (small numbers). A pure function of its arguments: no state is kept from query to
  /// query. A flat face on a flat face or plane gives at least the corners of the common patch (4 for boxes).
  /// b may be a half-space; a never is. Points are ordered by feature, which is unique within the call.
  virtual void collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b, const Pose& pose_b,
                       double tolerance, std::vector<ContactPoint>& out) = 0;

  /// Appends, in any order, each once, at least the triangles that reach into `near` (frame of the mesh).
  void triangles_near(const SharedMesh& mesh, const BoundingBox& near, std::vector<std::uint32_t>& out);
  /// Appends, in any order, each once, at least the pairs of triangles no further apart than `margin`
  /// (lattice units).
  void triangle_pairs_near(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b, const Pose& pose_b,
                           double margin, std::vector<TrianglePair>& out);
  const BackendCounters& counters() const { return counters_; }

 protected:
  /// Says whether an engine's tree answers the two below.
  virtual bool finds_triangles() const { return false; }
  /// These two answer triangles_near and triangle_pairs_near: by the mesh's own tree of boxes, if no
  /// engine's.
  virtual void find_triangles(const SharedMesh& mesh, const BoundingBox& near,
                              std::vector<std::uint32_t>& out);
  virtual void find_triangle_pairs(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b,
                                   const Pose& pose_b, double margin, std::vector<TrianglePair>& out);

  BackendCounters counters_;
};

/// "analytic": closed forms and Newton's method, no engine.
class AnalyticBackend : public CollisionBackend {
 public:
  std::string_view name() const override { return "analytic"; }
  /// Spheres, capsules and boxes by closed forms (deepest_separation), anything on a half-space by its
  /// vertices, rims and supports, all other pairs by deepest_direction.
  void collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b, const Pose& pose_b,
               double tolerance, std::vector<ContactPoint>& out) override;
};

}  // namespace silt::rigid
