#pragma once
// Bodies move little from call to call, so a broad phase looks further than it is asked to and keeps what it
// finds (the list of L. Verlet, Phys. Rev. 159 (1967) 98): while no body has used up its slack, every pair
// that meets is among those kept, and is told from the others by the same test as ever. What comes out does
// not depend on what is kept.
//
// The slack of a body is what it is expected to move in the calls that the list is to serve: fast bodies have
// more than slow ones. Only motion apart from that which all have in common counts, so that a bed that falls
// keeps its list. Towards walls all of it does: a body that has moved further than there was room to the next
// one is looked at with the walls again, by itself.
//
// Of many ranks each has bodies that come and go. Those that have gone are passed over; the few that come are
// looked at with all the others, and what they may meet is added.
#include <limits>
#include <vector>

#include "rigid/collision/surroundings.hpp"

namespace silt::rigid {

class KeptPairs {
 public:
  /// No pair can meet that is not kept.
  bool hold(const Surroundings&, std::span<const WallSurface>);
  /// How much further (cells) to look for what a body may come to meet.
  struct Slack {
    float to_bodies, to_walls;
  };
  /// After hold(): what is worth while, one a body; nothing where bodies move too fast.
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

    /// From its displacement since it was seen and that of all since the list was made: apart from the
    /// others.
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
