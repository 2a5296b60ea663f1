#pragma once
#include <array>
#include <cstdint>

#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// A vertex, edge, face or the interior of a box: a side for each axis, or 0 along the feature.
struct Feature {
  std::array<std::int8_t, 3> sign{0, 0, 0};

  std::uint32_t code() const { return (sign[0] + 1) + 3 * (sign[1] + 1) + 9 * (sign[2] + 1); }  // 0..26
  /// Returns the feature common to this one and another: of two faces an edge, of two edges a vertex.
  Feature with(const Feature& other) const {
    Feature f = *this;
    for (int k = 0; k < 3; ++k)
      if (!f.sign[k]) f.sign[k] = other.sign[k];
    return f;
  }
};

/// Half edges may be 0: the core of a sphere is a point, that of a capsule a segment along z.
struct Box {
  static constexpr std::string_view name = "box";
  Vec3 half_edges;
  bool operator==(const Box&) const = default;
  static constexpr auto fields =
      std::tuple{Field<Box, Vec3>{"edges", &Box::half_edges, "the lengths of the box, [x, y, z]", 0.5}};

  double signed_distance(const Vec3& x) const;
  std::optional<LineInterval> line_interval(const Vec3& o, const Vec3& d) const;
  BoundingBox bounding_box(const Pose&) const;
  double reach(const Pose&) const;
  Vec3 support(const Vec3& n) const {
    return {std::copysign(half_edges[0], n[0]), std::copysign(half_edges[1], n[1]),
            std::copysign(half_edges[2], n[2])};
  }
  MassProperties mass_properties() const;
  double least_width() const { return 2 * half_edges.minCoeff(); }
  void add_inner_balls(std::vector<InnerBall>&) const;

  std::optional<Mat3> curvature(const Vec3& x, const Vec3& n) const;
  static constexpr bool is_polytope = true;
  Vec3 half_widths() const { return half_edges; }
  InnerBall inner_ball(const Vec3& x) const;
  void kinks(const Placement&, const Vec3& n_B, double angle, Kinks& out) const;
  double touching_ball(const Vec3& x, const Vec3& n) const;
  void touching_outline(const Placement&, const Vec3& n, double slack, ContactOutline& out) const;
  void facing_outline(const Placement&, const Vec3& n, ContactOutline& out) const;
  template <class Use>
  void extremes(Use&& use) const {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      use.ball(half_edges.cwiseProduct(sign), 0, corner);
    }
  }
  template <class Parts>
  void surface(Parts& parts) const {
    parts.add(SurfaceKind::box, half_edges);
  }
};

}  // namespace silt::rigid
