#pragma once
// Algorithm 1 of the paper exchanges bodies and contacts between ranks at its lines 13 and 23. Lines 1 and 6
// send nothing here: forces act on owned rows only, and a copy, which has its owner's state, drifts as its
// owner does. On one rank, and in this class itself, the exchange only wraps positions into a periodic
// domain. The parallel form is coupler/exchange/parallel_body_exchange.hpp.
#include <span>
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/bodies/rank_cluster.hpp"

namespace silt::rigid {

/// The box the bodies live in: [0, size), periodic or walled, an axis at a time.
struct Extent {
  Vec3 size = Vec3::Zero();
  std::array<bool, 3> periodic{};
  /// Into [0, size) along the periodic axes; `image` counts the periods taken off.
  void wrap(Vec3& x, std::array<std::int32_t, 3>& image) const;
  Vec3 shift(Image i) const { return {i.x * size[0], i.y * size[1], i.z * size[2]}; }
};

class BodyExchange {
 public:
  explicit BodyExchange(const Extent& extent) : extent_(extent) {}
  virtual ~BodyExchange() = default;

  const Extent& extent() const { return extent_; }
  /// Wraps the positions of owned bodies and copies into the domain.
  void wrap_positions(BodySet&) const;
  /// Line 23: wraps positions, makes, updates and drops copies, on all ranks that the bodies concern as they
  /// are and after a half step; visitors go. Bodies are handed over to the rank that has their centre, and
  /// with them their stored impulses, force and torque.
  virtual void synchronise(BodySet& bodies) { wrap_positions(bodies); }
  /// Does this rank create the contact whose point is x_W? (Exactly one rank does.)
  virtual bool owns_contact_at(const Vec3& x_W) const { return (void)x_W, true; }
  /// Line 13: contacts go to the owners of their bodies; those of owned bodies come back, sorted by key, and
  /// every partner of an owned body has a row (a visitor if it was not held before).
  virtual void exchange_contacts(BodySet&, std::vector<Contact>&);
  /// In the sweeps, with the ranks that own a partner of a body owned here: overwrites `width` doubles of
  /// each not-owned partner's row by its owner's. `said`, if any, is one word for all of them, and `heard`
  /// what they say, in the order of cluster().partners(). Not `changed`: no row owned here has changed since
  /// the last share, and only the word goes.
  virtual void share(BodySet&, std::span<double> /*rows x width*/, int /*width*/,
                     std::span<const RankCluster::Word> /*said*/ = {},
                     std::span<RankCluster::Word> /*heard*/ = {}, bool /*changed*/ = true) {}
  /// A share that is a round of the cluster. Returns the least of `value` here and on the partners.
  int share_in_round(BodySet&, std::span<double> rows, int width, int value, bool changed);
  /// The ranks that contacts connect this one with, as of the last exchange_contacts.
  const RankCluster& cluster() const { return cluster_; }

 protected:
  Extent extent_;
  RankCluster cluster_;

 private:
  std::vector<RankCluster::Word> heard_;  // scratch
};

}  // namespace silt::rigid
