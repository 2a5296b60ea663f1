#pragma once
// What a broad phase sees: the bodies at hand, how far they reach, and the walls; and what a pair of them is.
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/shapes/hollow_shape.hpp"

namespace silt::rigid {

struct CandidatePair {
  std::size_t row_a, row_b;  // of the lower and the higher id
  Image image;               // of b, relative to the canonical position of a
};

/// Returns the image of a seen from b, where `image` is that of b seen from a.
inline Image opposite(Image image) {
  return {static_cast<std::int8_t>(-image.x), static_cast<std::int8_t>(-image.y),
          static_cast<std::int8_t>(-image.z)};
}

/// Returns the order of pairs by the lower id, the higher one and the image; id_of(row) tells an id.
template <class IdOf>
auto pair_order(IdOf id_of) {
  return [id_of](const CandidatePair& p, const CandidatePair& q) {
    return std::tuple(id_of(p.row_a), id_of(p.row_b), p.image) <
           std::tuple(id_of(q.row_a), id_of(q.row_b), q.image);
  };
}

/// Returns all images that a body may meet another through, in their order: none but itself along axes that
/// are not periodic.
inline std::vector<Image> images_of(const Extent& extent) {
  std::vector<Image> all;
  const auto last = [&](int d) -> std::int8_t { return extent.periodic[d] ? 1 : 0; };
  for (std::int8_t x = -last(0); x <= last(0); ++x)
    for (std::int8_t y = -last(1); y <= last(1); ++y)
      for (std::int8_t z = -last(2); z <= last(2); ++z) all.push_back({x, y, z});
  return all;
}

/// Reach says how far a body's surface may travel, and from where.
struct Reach {
  double radius;  // of the bounding sphere
  double margin;  // largest gap at which it may take part in a contact
  double sum() const { return radius + margin; }
};

/// A WallSurface is a half-space whose surface goes through a point, or a hollow. World frame.
struct WallSurface {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();  // of a half-space
  bool moves = false;
  std::optional<HollowShape> hollow = {};
  Pose pose = {};  // of the hollow

  bool operator==(const WallSurface&) const = default;

  /// A wall that no body meets here (a mesh: rigid/collision/detect_contacts finds what is near it).
  static WallSurface out_of_sight() { return {{0, 0, -std::numeric_limits<double>::infinity()}}; }
  /// Returns the distance of a point from the surface, negative in the wall.
  double distance(const Vec3& x_W) const {
    return hollow ? hollow->gap(pose, x_W) : normal.dot(x_W) - normal.dot(point);
  }
};

/// Surroundings are the bodies at hand, without the walls.
struct Surroundings {
  const BodySet& bodies;
  const Extent& extent;
  std::span<const Reach> reach;  // one a row
  bool with_sleeping = false;    // pairs of which nothing is active count, too

  std::size_t size() const { return bodies.first_wall(); }
  /// Returns the pair of two bodies, `image` being that of `other` seen from `row`, in id order.
  CandidatePair in_order(std::size_t row, std::size_t other, Image image) const {
    if (bodies.id[row] < bodies.id[other]) return {row, other, image};
    return {other, row, opposite(image)};
  }
  /// Says whether contacts of the two matter and their bounding spheres are no further apart than both
  /// margins. It rounds alike whoever asks.
  bool meet(const CandidatePair& p) const {
    if (!bodies.is_dynamic(p.row_a) && !bodies.is_dynamic(p.row_b)) return false;
    if (!with_sleeping && !bodies.is_active(p.row_a) && !bodies.is_active(p.row_b)) return false;
    const double range = reach[p.row_a].sum() + reach[p.row_b].sum();
    return near(bodies.position[p.row_a], bodies.position[p.row_b], p.image, range);
  }
  /// Says whether contacts with the wall matter and the body's bounding sphere is no further from it than its
  /// margin.
  bool meets(std::size_t row, const WallSurface& wall) const {
    return bodies.is_dynamic(row) && (with_sleeping || wall.moves || bodies.is_active(row)) &&
           wall.distance(bodies.position[row]) <= reach[row].sum();
  }
  bool near(const Vec3& a, const Vec3& b, Image of_b, double range) const {
    return (b + extent.shift(of_b) - a).squaredNorm() <= range * range;
  }
};

}  // namespace silt::rigid
