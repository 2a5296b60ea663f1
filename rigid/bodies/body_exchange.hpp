#pragma once
// Exchange of bodies and contacts between ranks: lines 13 and 23 of Algorithm 1. Lines 1 and 6 send nothing
// here, since forces act on owned rows only and copies, which have their owners' state, drift as their owners
// do. The base class is the exchange of one rank: it only wraps positions into a periodic domain. The
// parallel one is coupler/exchange/parallel_body_exchange.hpp.
#include <array>
#include <span>
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/bodies/echo_reduction.hpp"

namespace silt::rigid {

/// The domain of the bodies, [0, size), periodic or walled along each axis.
struct Extent {
  Vec3 size = Vec3::Zero();
  std::array<bool, 3> periodic{};
  /// Wraps x into [0, size) along the periodic axes and adds the periods taken off to `image`.
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
  /// Line 23: wraps positions, hands bodies over to the rank that contains their centre (with stored
  /// impulses, force and torque), and makes, updates and deletes copies on all ranks that bodies meet, now or
  /// after a half step. Visitors are deleted.
  virtual void synchronise(BodySet& bodies) { wrap_positions(bodies); }
  /// Returns whether this rank creates the contact at x_W; exactly one rank does.
  virtual bool owns_contact_at(const Vec3& x_W) const { return (void)x_W, true; }
  /// Line 13: sends contacts to the owners of their bodies. Afterwards `contacts` are those of owned bodies,
  /// sorted by key, and every partner of an owned body has a row (a visitor's if the rank held none).
  virtual void exchange_contacts(BodySet&, std::vector<Contact>&);
  /// In the sweeps: overwrites `width` doubles in the row of each partner owned elsewhere with its owner's.
  /// Ranks whose bodies are partners exchange messages. `sent`, one message or none, goes to all of them;
  /// `received` gets theirs, in the order of cluster().partners(). If not `changed`, no owned row has changed
  /// since the last call and only the message is sent.
  virtual void share(BodySet&, std::span<double> /*rows x width*/, int /*width*/,
                     std::span<const EchoReduction::Message> /*sent*/ = {},
                     std::span<EchoReduction::Message> /*received*/ = {}, bool /*changed*/ = true) {}
  /// Shares rows in a round of the cluster. Returns the least `value` of this rank and its partners.
  int share_in_round(BodySet&, std::span<double> rows, int width, int value, bool changed);
  /// Returns the cluster of ranks connected by contacts, as of the last exchange_contacts.
  const EchoReduction& cluster() const { return cluster_; }

 protected:
  Extent extent_;
  EchoReduction cluster_;

 private:
  std::vector<EchoReduction::Message> received_;  // scratch
};

/// Ends the sweeps on all connected ranks at once (method-bodies.md, The end of the sweeps): synchronized
/// distributed termination (B. Szymanski, Y. Shi, N. Prywes, IEEE Trans. Softw. Eng. SE-11 (1985) 1136). Each
/// rank counts idle sweeps: 0 while it has something to solve again, otherwise one more than the least count
/// it receives. Once the count exceeds the number of messages that information needs to reach all ranks of
/// the cluster, all of them were idle in one sweep, and all of them know it in the same sweep.
class CommonRest {
 public:
  explicit CommonRest(BodyExchange& exchange) : exchange_(exchange) {}

  /// Returns whether this rank, as far as it knows, has nothing to solve in the next sweep.
  bool idle() const { return quiet_ > 0; }
  /// Ends a sweep; `moving`: this rank has something to solve again. Returns true in the same sweep on all
  /// ranks of the cluster, once none of them has.
  bool reached(bool moving) {
    quiet_ = moving ? 0 : quiet_ + 1;
    return quiet_ > 0 && exchange_.cluster().is_complete(quiet_ - 1);
  }
  /// Shares the rows that may have changed since the last call, and the count of idle sweeps.
  void share(BodySet& bodies, std::span<double> rows, int width) {
    quiet_ = exchange_.share_in_round(bodies, rows, width, quiet_, quiet_ < 2);
  }

 private:
  BodyExchange& exchange_;
  int quiet_ = 0;  // idle sweeps
};

/// Returns whether `here` is true on any rank of this rank's cluster.
inline bool on_any(BodySet& bodies, BodyExchange& exchange, bool here) {
  int nowhere = !here;
  for (int rounds = 0; !exchange.cluster().is_complete(rounds); ++rounds)
    nowhere = exchange.share_in_round(bodies, {}, 0, nowhere, false);
  return nowhere == 0;
}

}  // namespace silt::rigid
