#pragma once
// The broad phase: finds pairs of bodies whose bounding spheres nearly touch, and bodies near walls.
// Positions are canonical; through a periodic side a body meets the images of other bodies (never its own),
// through each side separately. The criterion is defined here, bitwise, so that the searches
// (rigid/collision/uniform_grid, the trees of engines in adapters/) are interchangeable, and the Verlet list
// does not change results.
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/shapes/tube.hpp"

namespace silt::rigid {

struct CandidatePair {
  std::size_t row_a, row_b;  // of the body of lower and of higher id
  Image image;               // of b, relative to the canonical position of a
};

/// Returns the image of a relative to b, where `image` is that of b relative to a.
inline Image opposite(Image image) {
  return {static_cast<std::int8_t>(-image.x), static_cast<std::int8_t>(-image.y),
          static_cast<std::int8_t>(-image.z)};
}

/// Returns the order of pairs by lower id, higher id and image; id_of(row) returns an id.
template <class IdOf>
auto pair_order(IdOf id_of) {
  return [id_of](const CandidatePair& p, const CandidatePair& q) {
    return std::tuple(id_of(p.row_a), id_of(p.row_b), p.image) <
           std::tuple(id_of(q.row_a), id_of(q.row_b), q.image);
  };
}

/// Returns all images through which a body may meet another, in order; 0 along axes without periodicity.
inline std::vector<Image> images_of(const Extent& extent) {
  std::vector<Image> all;
  const auto last = [&](int d) -> std::int8_t { return extent.periodic[d] ? 1 : 0; };
  for (std::int8_t x = -last(0); x <= last(0); ++x)
    for (std::int8_t y = -last(1); y <= last(1); ++y)
      for (std::int8_t z = -last(2); z <= last(2); ++z) all.push_back({x, y, z});
  return all;
}

/// The range within which a body may take part in a contact, from its centre.
struct Reach {
  double radius;  // of the bounding sphere
  double margin;  // largest gap of a contact
  double sum() const { return radius + margin; }
};

/// A wall as the broad phase sees it: a half-space whose surface contains a point, or a tube. World frame.
struct WallSurface {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();  // of a half-space
  std::optional<Tube> tube = {};
  Pose pose = {};  // of the tube

  bool operator==(const WallSurface&) const = default;

  /// Returns a wall that no body meets here (for meshes, which rigid/collision/detect_contacts handles).
  static WallSurface unreachable() { return {{0, 0, -std::numeric_limits<double>::infinity()}}; }
  /// Returns the distance of a point from the surface, negative in the wall.
  double distance(const Vec3& x_W) const {
    return tube ? tube->gap(pose, x_W) : normal.dot(x_W) - normal.dot(point);
  }
};

/// The bodies and their ranges, without the walls.
struct Surroundings {
  const BodySet& bodies;
  const Extent& extent;
  std::span<const Reach> reach;  // one per row

  std::size_t size() const { return bodies.first_wall(); }
  /// Returns the pair of two bodies in the order of their ids; `image` is that of `other` relative to `row`.
  CandidatePair in_order(std::size_t row, std::size_t other, Image image) const {
    if (bodies.id[row] < bodies.id[other]) return {row, other, image};
    return {other, row, opposite(image)};
  }
  /// Returns whether at least one body is free and the bounding spheres are no further apart than the sum of
  /// margins; bitwise the same for every caller.
  bool meet(const CandidatePair& p) const {
    if (!bodies.is_dynamic(p.row_a) && !bodies.is_dynamic(p.row_b)) return false;
    const double range = reach[p.row_a].sum() + reach[p.row_b].sum();
    return near(bodies.position[p.row_a], bodies.position[p.row_b], p.image, range);
  }
  /// Returns whether the body is free and its bounding sphere is no further from the wall than its margin.
  bool meets(std::size_t row, const WallSurface& wall) const {
    return bodies.is_dynamic(row) && wall.distance(bodies.position[row]) <= reach[row].sum();
  }
  bool near(const Vec3& a, const Vec3& b, Image of_b, double range) const {
    return (b + extent.shift(of_b) - a).squaredNorm() <= range * range;
  }
};

/// A Verlet list (L. Verlet, Phys. Rev. 159 (1967) 98): the broad phase searches with a larger reach and
/// keeps the pairs found. Until a body has used up its slack, every pair within reach is in the list, and the
/// exact test selects it. The result does not depend on the list.
///
/// The slack of a body is its expected displacement while the list serves. Only displacements relative to the
/// mean count, so that a falling bed keeps its list. Towards walls the whole displacement counts: a body that
/// has used it up is tested against the walls again.
///
/// On several ranks bodies arrive and leave. Those that have left are skipped; a few new ones are tested
/// against all others, and their pairs are added.
class VerletList {
 public:
  /// Returns whether the list still contains every pair that can be within reach.
  bool is_valid(const Surroundings&, std::span<const WallSurface>);
  /// Additional reach of the search (cells).
  struct Slack {
    float to_bodies, to_walls;
  };
  /// Returns, after is_valid(), the slack worth its cost, one per row; zero if bodies move too fast.
  std::span<const Slack> plan(const Surroundings&);
  /// Stores the current state. Returns the list, which the caller fills with all pairs of bodies within reach
  /// plus the planned slack, sorted as in BroadPhase.
  std::vector<CandidatePair>& renew(const Surroundings&, std::span<const WallSurface>);
  /// Appends the pairs within reach, in order. Call after is_valid() or renew() with the same arguments.
  void select(const Surroundings&, std::span<const WallSurface>, std::vector<CandidatePair>& pairs) const;

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  static constexpr double unlimited = std::numeric_limits<double>::infinity();
  struct Snapshot {  // a body's snapshot when it was last tested against all others
    BodyId id;
    Vec3 position, common;  // common: mean displacement of all bodies at that time
    std::array<std::int32_t, 3> image;
    bool dynamic;
    int calls;  // at that time
    double reach;
    Slack slack;
    Vec3 at_walls = Vec3::Zero();     // displacement when it was last tested against the walls
    double to_next_wall = unlimited;  // from there, beyond its reach, to the nearest wall that is not listed

    /// Returns the displacement relative to the mean since the snapshot; `all`: the mean since the search.
    Vec3 relative(const Vec3& moved, const Vec3& all) const { return moved - (all - common); }
  };
  struct NearWall {
    std::uint32_t snapshot, wall;  // indices in snapshots_ and in the span of walls
  };
  struct Rows {
    std::vector<std::uint32_t> of_snapshot;  // current row of each snapshot; none: the body has gone
    std::vector<std::uint32_t> snapshot;     // index of each row in snapshots_; none: a newcomer
    std::vector<BodyId> ids;                 // of each row
    std::vector<std::uint32_t> newcomers;    // rows
  };
  struct Plan {
    std::vector<Slack> slack;  // one per row
    Slack typical{};           // mean of all rows, used for newcomers
    bool has_slack = false;
    double largest = 0;  // largest reach plus slack of a body
  };
  void add_snapshot(const Surroundings&, std::size_t row, const Slack&, const Vec3& common);
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
  void update_walls(const Surroundings&, std::span<const WallSurface>);
  template <class List>
  void update_walls(const Surroundings&, std::span<const WallSurface>, std::uint32_t n, List&&);
  bool add_newcomers(const Surroundings&, const Vec3& common);
  void pair_with_all(const Surroundings&, std::size_t n, const Vec3& common);
  bool one_image_is_in_reach() const;

  std::vector<Snapshot> snapshots_;  // newcomers at the end
  Rows rows_;
  std::vector<WallSurface> walls_;
  Extent extent_;
  Plan plan_;
  // changes since the search
  int calls_ = 0;
  bool known_ = false;                         // walls and the bodies' properties have not changed
  bool wrapped_ = false;                       // some body crossed a periodic side
  std::vector<CandidatePair> pairs_;           // row_a and row_b are indices in snapshots_
  std::vector<CandidatePair> added_;           // the same, of newcomers
  std::vector<NearWall> near_walls_;           // sorted by the body's id, then the wall
  std::vector<std::uint32_t> walls_outdated_;  // indices in snapshots_: bodies to be tested against the walls
};

class BroadPhase {
 public:
  virtual ~BroadPhase() = default;
  virtual std::string_view name() const = 0;
  /// Fills pairs with every (a, b, image) within reach, each once, sorted by (id a, id b, image). A wall is
  /// within reach if the bounding sphere of a free body is no further from it than the body's margin. reach:
  /// one per row (unused for walls). walls: one per wall row. The result depends on the arguments only.
  void operator()(const BodySet&, const Extent&, std::span<const Reach> reach,
                  std::span<const WallSurface> walls, std::vector<CandidatePair>& pairs);

 private:
  void find_candidates(const Surroundings&, std::span<const WallSurface>);
  /// Appends the pairs of bodies within reach, each once, in any order. Called with at least one body.
  virtual void find_pairs(const Surroundings&, std::vector<CandidatePair>& found) = 0;
  void sort_into(const BodySet&, std::vector<CandidatePair>& pairs);

  VerletList list_;
  std::vector<Reach> wider_;
  std::vector<CandidatePair> found_;
  std::vector<std::uint32_t> order_, rank_, start_;
};

}  // namespace silt::rigid
