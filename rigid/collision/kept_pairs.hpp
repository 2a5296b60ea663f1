#pragma once
// Bodies move little from call to call, so a broad phase looks further than it is asked to and keeps what it
// finds (the list of L. Verlet, Phys. Rev. 159 (1967) 98): while no body has used up its slack, every pair
// that meets is among those kept, and is told from the others by the same test as ever. What comes out does
// not depend on what is kept.
//
// The slack of a body is what it is expected to move in the calls that the list is to serve: fast bodies have
// more than slow ones. Only motion apart from that which all have in common counts, so that a bed that falls
// keeps its list; towards walls all of it does.
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
  /// After hold(): what is worth while, one a body; nothing where bodies come and go or move too fast.
  std::span<const Slack> plan(const Surroundings&);
  /// Remembers how all is now. Returns the list to be filled with all pairs that meet with the slack that was
  /// planned, sorted as BroadPhase says.
  std::vector<CandidatePair>& renew(const Surroundings&, std::span<const WallSurface>);
  /// Appends those that meet, in order. Call after hold() or renew() with the same.
  void select(const Surroundings&, std::span<const WallSurface>, std::vector<CandidatePair>& pairs) const;

 private:
  struct Seen {  // a body, when the pairs were found
    BodyId id;
    Vec3 position;
    std::array<std::int32_t, 3> image;
    bool dynamic;
    double reach;
  };
  bool same_surroundings(const Surroundings&, std::span<const WallSurface>) const;
  bool images_are_few() const;
  Vec3 displacement_of(const Surroundings&, std::size_t row) const;
  Vec3 common_displacement(const Surroundings&) const;
  double best_calls(const Surroundings&, const Vec3& common) const;
  Slack motion_of(const Surroundings&, std::size_t row, const Vec3& common) const;
  bool image_now(const BodySet&, CandidatePair&) const;

  std::vector<Seen> seen_;
  std::vector<WallSurface> walls_;
  Extent extent_;
  std::vector<Slack> slack_;  // one a body
  bool has_slack_ = false;
  bool few_images_ = false;
  // since then
  int calls_ = 0;
  bool known_ = false;    // the same bodies and walls
  bool wrapped_ = false;  // some body passed a periodic side
  std::vector<CandidatePair> pairs_;
};

}  // namespace silt::rigid
