#pragma once
// The inside of ParallelBodyExchange on more than one rank: who holds what, and the rounds of messages.
//
// Each rank remembers, as of the last synchronisation, which ranks hold a copy of its bodies and which rank
// owns each of its copies. Both ends of such a tie know it, hence forces, contacts and the sweeps' velocities
// go between ties without asking anyone: a contact found here concerns only owners of bodies held here. The
// synchronisation can reach ranks without a tie, which a body now overlaps: there is one message between any
// two ranks around each other, as far as a body can come to reach in a step. A body set down anywhere needs a
// round of unannounced messages, see messages.hpp.
#include <algorithm>
#include <unordered_map>

#include "coupler/exchange/holders.hpp"
#include "coupler/exchange/parallel_body_exchange.hpp"
#include "parallel/messages.hpp"
#include "parallel/transfers.hpp"

namespace silt::coupler {

/// What this rank shares with another, each list sorted by id: the other rank has the same lists, swapped.
struct Tie {
  int rank;
  std::vector<rigid::BodyId> given;  // owned here, copied there
  std::vector<rigid::BodyId> taken;  // owned there, copied here
};

/// A body between ranks, in full.
struct Traveller {
  rigid::BodyRecord record;
  int owner;                       // after this synchronisation
  rigid::FixedVec3 force, torque;  // for a new owner only, as all below
  std::vector<int> holders;
  std::vector<rigid::StoredImpulse> impulses;
};

struct ParallelBodyExchange::Distribution {
  /// Where the owners of bodies may be after a synchronisation.
  enum class Owners { stay, next_to_each_other, anywhere };

  Distribution(MPI_Comm comm, int rank, const lbm::Domain& domain, const rigid::World& world, double rim);

  // ---- synchronise_bodies.cpp ----
  void synchronise(rigid::BodySet&, Owners);
  void sum_forces(rigid::BodySet&);
  /// Ranks that hold a body, its owner among them, sorted.
  void find_holders(int shape, const rigid::Pose&, std::vector<int>& ranks) const;
  /// The same of an owned body, with the ranks that may own a body beyond one of its films.
  void find_holders(const rigid::BodySet&, std::size_t row, std::vector<int>& ranks);

  // ---- deal_out.cpp ----
  /// From bodies that each have an owner on some rank, any one, and no copies that count, to those of the
  /// cuts and their copies.
  void deal_out(rigid::BodySet&);

  // ---- exchange_contacts.cpp ----
  void exchange_contacts(rigid::BodySet&, std::vector<rigid::Contact>&);
  void share(std::span<double> rows, int width, std::span<const rigid::RankCluster::Word> said,
             std::span<rigid::RankCluster::Word> heard, bool changed);
  /// Ranks that own a body with a contact with one owned here, sorted.
  std::vector<int> partners() const;

  // ---- distribution.cpp ----
  /// Adds to the sorted ranks those that may own a body with a film between it and an owned one.
  void include_owners_beyond_films(const rigid::BodySet&, std::size_t row, std::vector<int>& ranks);
  void sum_to_owners(const rigid::BodySet&, std::span<std::int64_t> rows, int width);
  void share_with_copies(const rigid::BodySet&, std::span<double> rows, int width);
  void forget(rigid::BodyId);
  /// Renews the ties after held_by or owner_of changed.
  void tie(const rigid::BodySet&);
  int owner(rigid::BodyId) const;  // of a copy or visitor

  const int rank;
  const rigid::World& world;
  Holders holders, owners;  // within the rim of a block; within a step's motion of it
  parallel::Messages messages;
  const double largest_radius;  // of a body
  const double reach;           // cells around the blocks of a rank
  const std::vector<int>
      around;  // other ranks that have a block within reach of one here, sorted: they agree
  ExchangeCounters counters;
  // nothing depends on the order in which these are run through
  struct Holding {
    std::vector<int> ranks;  // sorted
    std::uint64_t round;     // the last in which it was so
    bool has(int rank) const { return std::binary_search(ranks.begin(), ranks.end(), rank); }
  };
  std::unordered_map<rigid::BodyId, Holding> held_by;  // owned bodies that others hold
  std::unordered_map<rigid::BodyId, int> owner_of;     // copies and visitors
  std::vector<Tie> ties;                               // by rank

  /// Ranks of ties that give (or take) anything.
  const std::vector<int>& those_that(std::vector<rigid::BodyId> Tie::*have);

 private:
  struct VelocityMessages {  // rows whose velocities go to and come from a rank in the sweeps, in the order
                             // of ids
    int rank;
    std::vector<std::size_t> given, taken;
    parallel::Bytes outgoing, incoming;
  };
  struct Arrivals;
  void announce(rigid::BodySet&, Owners);
  void announce_body(const rigid::BodySet&, std::size_t row, Owners);
  void require_around(rigid::BodyId, int to) const;
  void expect_all_around();
  void send_forces_of_copies(rigid::BodySet&);
  void add_forces(rigid::BodySet&, const Arrivals&) const;
  void read(rigid::BodySet&, Arrivals&);
  bool settle(rigid::BodySet&, Arrivals&);
  bool drop_visitors(rigid::BodySet&);
  void send_contact(const rigid::BodySet&, const rigid::Contact&, bool new_pair);
  void send_partner(const rigid::BodySet&, rigid::BodyId, int to);
  void receive_contacts(rigid::BodySet&, std::vector<rigid::Contact>&);
  void plan_velocity_messages(const rigid::BodySet&);

  std::vector<int> ranks_, near_;                    // scratch
  std::vector<rigid::BodyId> held_;                  // scratch
  std::uint64_t round_ = 0;                          // of announcements
  std::vector<std::size_t> departures_;              // owned rows that are handed over
  std::vector<VelocityMessages> velocity_messages_;  // by rank
  std::vector<std::pair<rigid::BodyId, rigid::BodyId>>
      crossing_;  // pairs in contact, not both owned, and those received
  parallel::Transfers sharing_{messages.comm(), 3};
};

}  // namespace silt::coupler
