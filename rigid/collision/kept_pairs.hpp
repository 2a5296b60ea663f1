#pragma once
// Bodies move little from call to call, so a broad phase looks further than it is asked to and keeps what it
// finds (the list of L. Verlet, Phys. Rev. 159 (1967) 98): while no body has used up its slack, every pair
// that meets is among those kept, and the same test as ever tells them from the others. The result does not
// depend on the pairs that are kept.
//
// The slack of a body is what it is expected to move in the calls that the list is to serve: fast bodies have
// more than slow ones. Only motion apart from that which all have in common counts, so that a bed that falls
// keeps its list. Towards walls all of it does: a body that has moved further than there was room to the next
// one is looked at with the walls again, by itself.
//
// Of many ranks each has bodies that come and go. Those that have gone are passed over; the few that come are
// looked at with all the others, and what they may meet is added.
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/shapes/tube.hpp"

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

/// A WallSurface is a half-space whose surface goes through a point, or a tube. World frame.
struct WallSurface {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();  // of a half-space
  std::optional<Tube> tube = {};
  Pose pose = {};  // of the tube

  bool operator==(const WallSurface&) const = default;

  /// A wall that no body meets here (a mesh: rigid/collision/detect_contacts finds what is near it).
  static WallSurface out_of_sight() { return {{0, 0, -std::numeric_limits<double>::infinity()}}; }
  /// Returns the distance of a point from the surface, negative in the wall.
  double distance(const Vec3& x_W) const {
    return tube ? tube->gap(pose, x_W) : normal.dot(x_W) - normal.dot(point);
  }
};

/// Surroundings are the bodies at hand, without the walls.
struct Surroundings {
  const BodySet& bodies;
  const Extent& extent;
  std::span<const Reach> reach;  // one a row

  std::size_t size() const { return bodies.first_wall(); }
  /// Returns the pair of two bodies, `image` being that of `other` seen from `row`, in id order.
  CandidatePair in_order(std::size_t row, std::size_t other, Image image) const {
    if (bodies.id[row] < bodies.id[other]) return {row, other, image};
    return {other, row, opposite(image)};
  }
  /// Says whether one of the two is free and their bounding spheres are no further apart than both margins.
  /// It rounds alike whoever asks.
  bool meet(const CandidatePair& p) const {
    if (!bodies.is_dynamic(p.row_a) && !bodies.is_dynamic(p.row_b)) return false;
    const double range = reach[p.row_a].sum() + reach[p.row_b].sum();
    return near(bodies.position[p.row_a], bodies.position[p.row_b], p.image, range);
  }
  /// Says whether the body is free and its bounding sphere no further from the wall than its margin.
  bool meets(std::size_t row, const WallSurface& wall) const {
    return bodies.is_dynamic(row) && wall.distance(bodies.position[row]) <= reach[row].sum();
  }
  bool near(const Vec3& a, const Vec3& b, Image of_b, double range) const {
    return (b + extent.shift(of_b) - a).squaredNorm() <= range * range;
  }
};

class KeptPairs {
 public:
  /// No pair can meet that is not kept.
  bool hold(const Surroundings&, std::span<const WallSurface>);
  /// The search for what a body may come to meet goes so much further (cells).
  struct Slack {
    float to_bodies, to_walls;
  };
  /// Returns, after hold(), the slack that is worth while, one a body; nothing where bodies move too fast.
  std::span<const Slack> plan(const Surroundings&);
  /// Remembers how all is now. Returns the list to be filled with all pairs of bodies that meet with the
  /// slack that was planned, sorted as BroadPhase says.
  std::vector<CandidatePair>& renew(const Surroundings&, std::span<const WallSurface>);
  /// Appends those that meet, in order. Call after hold() or renew() with the same.
  void select(const Surroundings&, std::span<const WallSurface>, std::vector<CandidatePair>& pairs) const;

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  static constexpr double unlimited = std::numeric_limits<double>::infinity();
  struct Seen {  // a body, when it was looked at with all the others
    BodyId id;
    Vec3 position, common;  // common: displacement of all by then
    std::array<std::int32_t, 3> image;
    bool dynamic;
    int calls;  // by then
    double reach;
    Slack slack;
    Vec3 at_walls;        // displacement when it was looked at with the walls
    double to_next_wall;  // from there, beyond its reach and the walls that are listed

    /// Returns the displacement apart from the others, of a body's since it was seen and that of all since
    /// the list was made.
    Vec3 relative(const Vec3& moved, const Vec3& all) const { return moved - (all - common); }
  };
  struct NearWall {
    std::uint32_t seen, wall;  // in seen_; in the span of walls
  };
  struct Rows {
    std::vector<std::uint32_t> of_seen;    // now; none: it is gone
    std::vector<std::uint32_t> seen;       // of each, the index in seen_; none: it has just come
    std::vector<BodyId> ids;               // of each
    std::vector<std::uint32_t> newcomers;  // which have just come
  };
  struct Plan {
    std::vector<Slack> slack;  // one a row
    Slack typical{};           // of all
    bool has_slack = false;
    double largest = 0;  // reach and slack of a body
  };
  bool same_extent_and_walls(const Surroundings&, std::span<const WallSurface>) const;
  bool same_rows(const Surroundings&) const;
  void find_rows(const Surroundings&);
  bool images_are_few() const;
  Vec3 displacement_of(const Surroundings&, std::size_t n) const;
  Vec3 common_displacement(const Surroundings&) const;
  double best_calls(const Surroundings&, const Vec3& common) const;
  Slack motion_of(const Surroundings&, std::size_t n, const Vec3& common) const;
  std::int32_t image_change(const BodySet&, const CandidatePair& kept, int axis) const;
  bool image_now(const BodySet&, const CandidatePair& kept, Image&) const;
  void look_at_walls(const Surroundings&, std::span<const WallSurface>);
  template <class List>
  void look_at_walls(const Surroundings&, std::span<const WallSurface>, std::uint32_t n, List&&);
  bool take_in(const Surroundings&, const Vec3& common);
  void pair_with_all(const Surroundings&, std::size_t n, const Vec3& common);
  bool one_image_is_in_reach() const;

  std::vector<Seen> seen_;  // those that came later at the end
  Rows rows_;
  std::vector<WallSurface> walls_;
  Extent extent_;
  Plan plan_;
  // since then
  int calls_ = 0;
  bool known_ = false;                     // the same walls, and bodies that are what they were
  bool wrapped_ = false;                   // some body passed a periodic side
  std::vector<CandidatePair> pairs_;       // row_a and row_b are indices in seen_
  std::vector<CandidatePair> added_;       // likewise
  std::vector<NearWall> near_walls_;       // by the body's id, then the wall
  std::vector<std::uint32_t> to_look_at_;  // indices in seen_, with the walls
};

}  // namespace silt::rigid
