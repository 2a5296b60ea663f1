#pragma once
// Owner and remote bodies over MPI (the paper, section III): the exchanges of Algorithm 1.
//
// The owner of a body is the rank that holds the block with its wrapped centre of mass. Every rank one of
// whose blocks, grown by `rim`, meets the body's bounding box (in any periodic image), as it is or half a
// step later, holds a copy; so does every rank that may own a body beyond a film of lubrication. Messages go
// to those ranks only.
//
// Each rank remembers, as of the last synchronisation, which ranks hold a copy of its bodies and which rank
// owns each of its copies. Both ends of such a tie know it, hence contacts and the sweeps' velocities
// go between ties without asking anyone: a contact found here concerns only owners of bodies held here. The
// synchronisation can reach ranks without a tie, which a body now overlaps: there is one message between any
// two ranks around each other, as far as a body can come to reach in a step. A body set down anywhere needs a
// round of unannounced messages, see messages.hpp.
#include <mpi.h>

#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

#include "coupler/exchange/holders.hpp"
#include "parallel/messages.hpp"
#include "parallel/transfers.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

/// A body with all that only its owner has.
struct OwnedBody {
  rigid::BodyRecord record;
  rigid::FixedVec3 force = {}, torque = {};
  std::vector<rigid::StoredImpulse> impulses = {};
};
void put_body(parallel::Bytes& to, const OwnedBody&);
OwnedBody take_body(parallel::ByteReader& from);

/// Collective. Each rank gives bodies, and gets those of all ranks whose centre of mass lies in its blocks,
/// its own ones first.
std::vector<OwnedBody> sent_home(parallel::Messages&, const Holders&, std::vector<OwnedBody> given);

/// Bodies apart from a body set: records, and as many lists of stored impulses.
struct SavedBodies {
  std::vector<rigid::BodyRecord> records;
  std::vector<std::vector<rigid::StoredImpulse>> impulses;
};

/// Collective. Adds to `bodies`, as owned rows, those of the saved bodies of all ranks whose centre of mass
/// lies in this rank's blocks. Each body is saved on exactly one rank, whichever. They go in rounds of
/// `at_once` bodies a rank, so that the messages take little memory beside the bodies.
void send_home(parallel::Messages&, const Holders&, const SavedBodies&, rigid::BodySet& bodies,
               std::size_t at_once = std::size_t{1} << 14);

struct ExchangeCounters {
  std::uint64_t migrations = 0;  // bodies this rank gave away
  std::uint64_t copies_made = 0;
  std::uint64_t messages = 0, bytes = 0;
};

class ParallelBodyExchange : public rigid::BodyExchange {
 public:
  /// rim: cells by which blocks are grown: the ghost layer, the largest motion of a step and half a contact
  /// margin.
  ParallelBodyExchange(MPI_Comm, const lbm::Domain&, const rigid::World&, double rim);

  /// std::runtime_error on a rank one of whose bodies went further than to the ranks around it (reach()).
  void synchronise(rigid::BodySet&) override;
  bool owns_contact_at(const rigid::Vec3& x_W) const override;
  void exchange_contacts(rigid::BodySet&, std::vector<rigid::Contact>&) override;
  void share(rigid::BodySet&, std::span<double> rows, int width,
             std::span<const rigid::EchoReduction::Message> said = {},
             std::span<rigid::EchoReduction::Message> heard = {}, bool changed = true) override;

  MPI_Comm comm() const { return comm_; }
  const rigid::World& world() const { return neighbourhood_.world(); }
  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  const ExchangeCounters& counters() const;
  /// The rank that owns what is at x (wrapped; clamped into the domain beyond walls).
  int rank_at(const rigid::Vec3& x_W) const;
  /// The rank that owns a body held here, as of the last synchronisation.
  int owner_of(const rigid::BodySet&, std::size_t row) const;
  /// Ranks that hold a body of this shape at rest at this pose, the owner among them, sorted.
  std::vector<int> holders(int shape, const rigid::Pose&) const;
  /// Returns the holders of an owned body as it is, with the ranks that may own a body beyond one of its
  /// films.
  std::vector<int> holders(const rigid::BodySet&, std::size_t row) const;
  /// Synchronises bodies that may have been set down anywhere. Collective: every rank hears of every other.
  void relocate(rigid::BodySet&);
  /// Goes over to the cuts that the domain has now: bodies go to their new owners, with the forces on them
  /// and their stored impulses, and copies are made again. Collective, between steps.
  void cut_again(rigid::BodySet&);
  /// Takes bodies out of the simulation: held rows, in ascending order, without visitors and walls. Local:
  /// every rank that holds one must do so, between the same steps. Impulses that others remember of them
  /// stay until the next step, in which they find no contact.
  void take_out(rigid::BodySet&, std::span<const std::size_t> rows);
  /// Returns how far around its blocks a rank's bodies may reach, cells: at least as far as the next blocks.
  double reach() const;

  /// Sums `width` integers a row from copies into their owners' rows (exact in any order); copies' entries
  /// become zero.
  void sum_to_owners(const rigid::BodySet&, std::span<std::int64_t> rows, int width) const;
  /// Overwrites `width` doubles a row of every copy by its owner's.
  void share_with_copies(const rigid::BodySet&, std::span<double> rows, int width) const;

 private:
  /// Tells how far the owners of bodies may be from each other after a synchronisation.
  enum class Owners { next_to_each_other, anywhere };
  /// A tie holds what this rank shares with another, each list sorted by id: the other rank has the same
  /// lists, swapped.
  struct Tie {
    int rank;
    std::vector<rigid::BodyId> given;  // owned here, copied there
    std::vector<rigid::BodyId> taken;  // owned there, copied here
  };
  struct Holding {
    std::vector<int> ranks;  // sorted
    std::uint64_t round;     // the last in which it was so
    bool has(int rank) const { return std::binary_search(ranks.begin(), ranks.end(), rank); }
  };
  /// Rows whose velocities go to and come from a rank in the sweeps, in the order of ids.
  struct VelocityMessages {
    int rank;
    std::vector<std::size_t> given, taken;
    parallel::Bytes outgoing, incoming;
  };
  using Pairs = std::vector<std::pair<rigid::BodyId, rigid::BodyId>>;
  struct Arrivals;

  // ---- who holds what ----
  int owner(rigid::BodyId) const;  // of a copy or visitor
  /// Renews the ties after held_by_ or owner_of_ changed.
  void tie(const rigid::BodySet&);
  /// Ranks of ties that give (or take) anything.
  std::vector<int> those_that(std::vector<rigid::BodyId> Tie::*have) const;
  const Tie& tie_with(int rank) const;
  void deal_out(rigid::BodySet&);

  // ---- parallel_body_exchange_synchronise.cpp ----
  void synchronise(rigid::BodySet&, Owners);
  void announce(rigid::BodySet&, Owners, std::vector<std::size_t>& departures);
  bool announce_body(const rigid::BodySet&, std::size_t row, Owners, std::vector<int>& ranks);
  void require_around(rigid::BodyId, int to) const;
  void expect_all_around();
  void read(rigid::BodySet&, Arrivals&);
  bool settle(rigid::BodySet&, Arrivals&, const std::vector<std::size_t>& departures);
  bool drop_visitors(rigid::BodySet&);

  // ---- parallel_body_exchange_contacts.cpp ----
  void send_contact(const rigid::BodySet&, const rigid::Contact&, bool new_pair);
  void send_partner(const rigid::BodySet&, rigid::BodyId, int to);
  void receive_contacts(rigid::BodySet&, std::vector<rigid::Contact>&, Pairs& crossing);
  void plan_velocity_messages(const rigid::BodySet&, const Pairs& crossing);

  MPI_Comm comm_;
  int rank_, ranks_;
  Neighbourhood neighbourhood_;
  mutable parallel::Messages messages_;
  mutable ExchangeCounters counters_;
  // nothing depends on the order in which these are run through
  std::unordered_map<rigid::BodyId, Holding> held_by_;  // owned bodies that others hold
  std::unordered_map<rigid::BodyId, int> owner_of_;     // copies and visitors
  std::vector<Tie> ties_;                               // by rank
  std::uint64_t round_ = 0;                             // of announcements
  std::vector<VelocityMessages> velocity_messages_;     // by rank
  parallel::Transfers sharing_{messages_.comm(), 3};
};

}  // namespace silt::coupler
