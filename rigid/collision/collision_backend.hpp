#pragma once
// The interface of the narrow phase: contact points of a pair of convex shapes, and nearby triangles of
// meshes. Engines implement it in adapters/; rigid/ never includes them.
#include <cstdint>
#include <string_view>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::rigid {

using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// Counters of the narrow phase. Queries neither answered nor refined were computed here.
struct BackendCounters {
  std::uint64_t queries = 0;    // pairs of shapes, and searches for triangles
  std::uint64_t answered = 0;   // an engine's normal, triangles, or verdict that there is no contact was used
  std::uint64_t refined = 0;    // an engine's normal was the start of the own search
  std::uint64_t fallbacks = 0;  // an answer failed its check and was replaced by another method's
};

class CollisionBackend {
 public:
  virtual ~CollisionBackend() = default;
  virtual std::string_view name() const = 0;
  /// Returns whether collide() handles the pair: every bounded convex shape with every convex shape, but
  /// polyhedra only up to some 10000 vertices (has_codes).
  bool supports(const ConvexShape& a, const ConvexShape& b) const;
  /// Appends all contact points of a and b with gap <= tolerance (lattice units), ordered by feature, which
  /// is unique within the call. Poses are relative to the first *body*, so that numbers are small. A pure
  /// function: no state is kept between queries. A flat face on a flat face or plane gives at least the
  /// corners of the common patch (4 for boxes). b may be a half-space, a may not.
  virtual void collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b, const Pose& pose_b,
                       double tolerance, std::vector<ContactPoint>& out) = 0;

  /// Appends at least the triangles that reach into `near` (frame of the mesh), each once, in any order.
  void triangles_near(const SharedMesh& mesh, const BoundingBox& near, std::vector<std::uint32_t>& out);
  /// Appends at least the pairs of triangles within `margin` (lattice units), each once, in any order.
  void triangle_pairs_near(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b, const Pose& pose_b,
                           double margin, std::vector<TrianglePair>& out);
  const BackendCounters& counters() const { return counters_; }

 protected:
  /// Returns whether an engine's tree implements the two functions below.
  virtual bool finds_triangles() const { return false; }
  /// Implement triangles_near and triangle_pairs_near; by default with the mesh's own tree of boxes.
  virtual void find_triangles(const SharedMesh& mesh, const BoundingBox& near,
                              std::vector<std::uint32_t>& out);
  virtual void find_triangle_pairs(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b,
                                   const Pose& pose_b, double margin, std::vector<TrianglePair>& out);

  BackendCounters counters_;
};

/// "analytic": closed forms and Newton's method, without an engine.
class AnalyticBackend : public CollisionBackend {
 public:
  std::string_view name() const override { return "analytic"; }
  /// Closed forms for spheres, capsules and boxes (deepest_separation); vertices, rims and support points on
  /// a half-space; deepest_direction for all other pairs.
  void collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b, const Pose& pose_b,
               double tolerance, std::vector<ContactPoint>& out) override;
};

}  // namespace silt::rigid
