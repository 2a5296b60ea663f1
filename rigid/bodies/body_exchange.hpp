#pragma once
// Algorithm 1 of the paper exchanges bodies and contacts between ranks at its lines 13 and 23. Lines 1 and 6
// send nothing here: forces act on owned rows only, and a copy, which has its owner's state, drifts as its
// owner does. On one rank, and in this class itself, the exchange only wraps positions into a periodic
// domain. The parallel form is coupler/exchange/parallel_body_exchange.hpp.
#include <array>
#include <span>
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/bodies/echo_reduction.hpp"

namespace silt::rigid {

/// The box the bodies live in: [0, size), periodic or walled, an axis at a time.
struct Extent {
  Vec3 size = Vec3::Zero();
  std::array<bool, 3> periodic{};
  /// Wraps x into [0, size) along the periodic axes; `image` counts the periods taken off.
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
  /// Overwrites, in the sweeps, `width` doubles of each not-owned partner's row by its owner's, with the
  /// ranks that own a partner of a body owned here. `said`, if any, is one word for all of them, and `heard`
  /// gets theirs, in the order of cluster().partners(). Not `changed`: no row owned here has changed since
  /// the last share, and only the word goes.
  virtual void share(BodySet&, std::span<double> /*rows x width*/, int /*width*/,
                     std::span<const EchoReduction::Message> /*said*/ = {},
                     std::span<EchoReduction::Message> /*heard*/ = {}, bool /*changed*/ = true) {}
  /// A share that is a round of the cluster. Returns the least of `value` here and on the partners.
  int share_in_round(BodySet&, std::span<double> rows, int width, int value, bool changed);
  /// The ranks that contacts connect this one with, as of the last exchange_contacts.
  const EchoReduction& cluster() const { return cluster_; }

 protected:
  Extent extent_;
  EchoReduction cluster_;

 private:
  std::vector<EchoReduction::Message> heard_;  // scratch
};

/// Sweeps over contacts end by a common rest (method-bodies.md, The end of the sweeps). Each rank counts the
/// sweeps for which it, and as far as it has heard the others, had nothing to solve again: one more than the
/// least of the counts it hears, 0 while it has something to do. Above the number of messages that a word
/// needs to come to all ranks that contacts connect, all have been at rest in one sweep, and each knows it in
/// the same sweep (B. Szymanski, Y. Shi, N. Prywes, "Synchronized distributed termination", IEEE Trans.
/// Softw. Eng. SE-11 (1985) 1136).
class CommonRest {
 public:
  explicit CommonRest(BodyExchange& exchange) : exchange_(exchange) {}

  /// Says whether this rank, as far as it has heard, has nothing to solve in the next sweep.
  bool idle() const { return quiet_ > 0; }
  /// Ends a sweep after which this rank has something to solve again (`moving`) or not. True in the same
  /// sweep on all ranks that contacts connect, once none of them has.
  bool reached(bool moving) {
    quiet_ = moving ? 0 : quiet_ + 1;
    return quiet_ > 0 && exchange_.cluster().is_complete(quiet_ - 1);
  }
  /// Shares the bodies' rows, if any of them may have changed since the last time, and what is known of rest.
  void share(BodySet& bodies, std::span<double> rows, int width) {
    quiet_ = exchange_.share_in_round(bodies, rows, width, quiet_, quiet_ < 2);
  }

 private:
  BodyExchange& exchange_;
  int quiet_ = 0;  // sweeps
};

/// Says whether something is so on this rank or on any that contacts connect it with.
inline bool on_any(BodySet& bodies, BodyExchange& exchange, bool here) {
  int nowhere = !here;
  for (int rounds = 0; !exchange.cluster().is_complete(rounds); ++rounds)
    nowhere = exchange.share_in_round(bodies, {}, 0, nowhere, false);
  return nowhere == 0;
}

}  // namespace silt::rigid
