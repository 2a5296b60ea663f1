#pragma once
// The exchange of bodies over MPI (the paper, section III) for Algorithm 1.
//
// The owner of a body is the rank with the block that contains its wrapped centre of mass. A rank holds a
// copy if one of its blocks, grown by `rim`, meets the body's bounding box (in any periodic image), now or
// half a step later, or if it may own a body beyond a lubrication film. Messages go to such ranks only.
//
// Each rank stores which ranks had a copy of its bodies, and which ranks owned its copies, at the last
// synchronisation. Both ends of such a tie know it, so contacts and velocities are sent along ties without a
// query: a contact found here concerns owners of bodies held here. A synchronisation can reach ranks without
// a tie, which a body newly overlaps, so there is one message between any two ranks within the range of
// bodies in a step. A body moved anywhere needs a sparse exchange (messages.hpp).
#include <mpi.h>

#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

#include "coupler/exchange/holders.hpp"
#include "parallel/messages.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

/// A body with the data that only its owner has.
struct OwnedBody {
  rigid::BodyRecord record;
  rigid::FixedVec3 force = {}, torque = {};
  std::vector<rigid::StoredImpulse> impulses = {};
};
void put_body(parallel::Bytes& to, const OwnedBody&);
OwnedBody read_body(parallel::ByteReader& from);

/// Collective. Sends bodies to the ranks whose blocks contain their centres; returns this rank's.
std::vector<OwnedBody> sent_to_owners(parallel::Messages&, const Holders&, std::vector<OwnedBody> bodies);

/// Bodies outside a body set: records and as many lists of stored impulses.
struct SavedBodies {
  std::vector<rigid::BodyRecord> records;
  std::vector<std::vector<rigid::StoredImpulse>> impulses;
};

/// Collective. Adds to `bodies`, as owned rows, the saved bodies of all ranks with a centre of mass in this
/// rank's blocks. Each body is saved on exactly one rank. Rounds of `at_once` bodies save memory.
void distribute_to_owners(parallel::Messages&, const Holders&, const SavedBodies&, rigid::BodySet& bodies,
                          std::size_t at_once = std::size_t{1} << 14);

struct ExchangeCounters {
  std::uint64_t migrations = 0;  // bodies handed over by this rank
  std::uint64_t copies_made = 0;
  std::uint64_t messages = 0, bytes = 0;
};

class ParallelBodyExchange : public rigid::BodyExchange {
 public:
  /// rim: cells by which blocks are grown: halo, largest displacement in a step and half a contact margin.
  ParallelBodyExchange(MPI_Comm, const lbm::Domain&, const rigid::World&, double rim);

  /// Throws std::runtime_error if a body of this rank moved beyond the ranks around it (reach()).
  void synchronise(rigid::BodySet&) override;
  bool owns_contact_at(const rigid::Vec3& x_W) const override;
  void exchange_contacts(rigid::BodySet&, std::vector<rigid::Contact>&) override;
  void share(rigid::BodySet&, std::span<double> rows, int width,
             std::span<const rigid::EchoReduction::Message> sent = {},
             std::span<rigid::EchoReduction::Message> received = {}, bool changed = true) override;

  MPI_Comm comm() const { return comm_; }
  const rigid::World& world() const { return neighbourhood_.world(); }
  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  ExchangeCounters counters() const;
  /// Returns the rank that owns position x (wrapped; clamped into the domain beyond walls).
  int rank_at(const rigid::Vec3& x_W) const;
  /// Returns the owner of a body held here, as of the last synchronisation.
  int owner_of(const rigid::BodySet&, std::size_t row) const;
  /// Returns the ranks, sorted, that hold a body of this shape at rest at this pose, including its owner.
  std::vector<int> holders(int shape, const rigid::Pose&) const;
  /// Returns the holders of an owned body as it is, and the owners of bodies beyond its films.
  std::vector<int> holders(const rigid::BodySet&, std::size_t row) const;
  /// Synchronises bodies that may have been moved anywhere. Collective over all ranks.
  void relocate(rigid::BodySet&);
  /// Adopts the current partition of the domain: bodies move to their new owners with forces and stored
  /// impulses, and copies are made anew. Collective, between steps.
  void repartition(rigid::BodySet&);
  /// Removes bodies from the simulation: held rows in ascending order, without visitors and walls. Local:
  /// every rank that holds one must do so between the same steps. The impulses that other bodies store with
  /// them become unused.
  void remove_bodies(rigid::BodySet&, std::span<const std::size_t> rows);
  /// Returns the range of a rank's bodies around its blocks, cells; at least the distance to the next blocks.
  double reach() const;

  /// Sums `width` integers per row from copies into their owners' rows, exactly, and clears copies.
  void sum_to_owners(const rigid::BodySet&, std::span<std::int64_t> rows, int width);
  /// Overwrites `width` doubles per row of every copy by its owner's.
  void share_with_copies(const rigid::BodySet&, std::span<double> rows, int width);

 private:
  /// Where new owners of bodies may be relative to the old ones.
  enum class Owners { next_to_each_other, anywhere };
  /// What this rank shares with another one; that rank has the same lists, exchanged. Sorted by id.
  struct Tie {
    int rank;
    std::vector<rigid::BodyId> sent;      // owned here, copied there
    std::vector<rigid::BodyId> received;  // owned there, copied here
  };
  struct Holding {
    std::vector<int> ranks;  // sorted
    std::uint64_t round;     // last round in which this was so
    bool has(int rank) const { return std::binary_search(ranks.begin(), ranks.end(), rank); }
  };
  /// Rows whose velocities are sent to and received from a rank in the sweeps, by id.
  struct VelocityMessages {
    int rank;
    std::vector<std::size_t> sent, received;
    parallel::Bytes outgoing, incoming;
  };
  using Pairs = std::vector<std::pair<rigid::BodyId, rigid::BodyId>>;
  struct Arrivals;

  // ---- ownership and copies ----
  int owner(rigid::BodyId) const;  // of a copy or visitor
  /// Rebuilds the ties after a change of held_by_ or owner_of_.
  void tie(const rigid::BodySet&);
  /// Returns the ranks of ties whose list `have` is not empty.
  std::vector<int> ranks_with(std::vector<rigid::BodyId> Tie::*have) const;
  const Tie& tie_with(int rank) const;
  void redistribute(rigid::BodySet&);

  // ---- parallel_body_exchange_synchronise.cpp ----
  void synchronise(rigid::BodySet&, Owners);
  void announce(rigid::BodySet&, Owners, std::vector<std::size_t>& departures);
  bool announce_body(const rigid::BodySet&, std::size_t row, Owners, std::vector<int>& ranks);
  void require_around(rigid::BodyId, int to) const;
  void expect_all_around();
  void read(rigid::BodySet&, Arrivals&);
  bool update_rows(rigid::BodySet&, Arrivals&, const std::vector<std::size_t>& departures);
  bool remove_visitors(rigid::BodySet&);

  // ---- parallel_body_exchange_contacts.cpp ----
  void send_contact(const rigid::BodySet&, const rigid::Contact&, bool new_pair);
  void send_partner(const rigid::BodySet&, rigid::BodyId, int to);
  void receive_contacts(rigid::BodySet&, std::vector<rigid::Contact>&, Pairs& crossing);
  void plan_velocity_messages(const rigid::BodySet&, const Pairs& crossing);

  MPI_Comm comm_;
  int rank_, ranks_;
  Neighbourhood neighbourhood_;
  parallel::Messages messages_;
  ExchangeCounters counters_;
  // results do not depend on the iteration order of these maps
  std::unordered_map<rigid::BodyId, Holding> held_by_;  // owned bodies with copies elsewhere
  std::unordered_map<rigid::BodyId, int> owner_of_;     // of copies and visitors
  std::vector<Tie> ties_;                               // by rank
  std::uint64_t round_ = 0;                             // number of synchronisations
  std::vector<VelocityMessages> velocity_messages_;     // by rank
  parallel::Transfers sharing_{messages_.comm(), 3};
};

}  // namespace silt::coupler
