#pragma once
// Owner and remote bodies over MPI (the paper, section III): the four exchanges of Algorithm 1.
//
// The owner of a body is the rank that holds the block with its wrapped centre of mass. Every rank one of
// whose blocks, grown by `rim`, meets the body's bounding box (in any periodic image) holds a copy; so does
// every rank that may own a body beyond a film of lubrication. Messages go to those ranks only. Who they are
// both ends know from the last synchronisation (distribution.hpp). A synchronisation itself goes to all ranks
// that a body may come to reach in a step, each of which expects one message; only a body set down anywhere
// reaches ranks that do not expect it (messages.hpp).
#include <mpi.h>

#include <memory>

#include "lbm/domain.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

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
  void update_copies(rigid::BodySet&) override;
  void synchronise(rigid::BodySet&) override;
  bool owns_contact_at(const rigid::Vec3& x_W) const override;
  void exchange_contacts(rigid::BodySet&, std::vector<rigid::Contact>&) override;
  void share(rigid::BodySet&, std::span<double> rows, int width,
             std::span<const rigid::RankCluster::Word> said = {},
             std::span<rigid::RankCluster::Word> heard = {}, bool changed = true) override;

  MPI_Comm comm() const { return comm_; }
  const rigid::World& world() const { return world_; }
  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  const ExchangeCounters& counters() const;
  /// The rank that owns what is at x (wrapped; clamped into the domain beyond walls).
  int rank_at(const rigid::Vec3& x_W) const;
  /// The rank that owns a body held here, as of the last synchronisation.
  int owner_of(const rigid::BodySet&, std::size_t row) const;
  /// Ranks that hold a body of this shape at this pose, the owner among them, sorted.
  std::vector<int> holders(int shape, const rigid::Pose&) const;
  /// The same of an owned body as it is, with the ranks that may own a body beyond one of its films.
  std::vector<int> holders(const rigid::BodySet&, std::size_t row) const;
  /// Synchronises bodies that may have been set down anywhere. Collective: every rank hears of every other.
  void relocate(rigid::BodySet&);
  /// Goes over to the cuts that the domain has now: bodies go to their new owners, with the forces on them
  /// and their stored impulses, and copies are made anew. Collective, between steps: what acts on copies is
  /// lost.
  void cut_anew(rigid::BodySet&);
  /// Takes bodies out of the simulation: held rows, in ascending order, without visitors and walls. Local:
  /// every rank that holds one must do so, between the same steps. Impulses that others remember of them
  /// stay until the next step, in which they find no contact.
  void take_out(rigid::BodySet&, std::span<const std::size_t> rows);
  /// How far around its blocks a rank's bodies may reach, cells: at least as far as the next blocks.
  double reach() const;

  /// Sums `width` integers a row from copies into their owners' rows (exact in any order); copies' entries
  /// become zero.
  void sum_to_owners(const rigid::BodySet&, std::span<std::int64_t> rows, int width) const;
  /// Overwrites `width` doubles a row of every copy by its owner's.
  void share_with_copies(const rigid::BodySet&, std::span<double> rows, int width) const;

 private:
  struct Distribution;  // who holds what, messages and their plans; none on one rank
  MPI_Comm comm_;
  int rank_ = 0, ranks_ = 1;
  const lbm::Domain& domain_;
  const rigid::World& world_;
  double rim_;
  mutable ExchangeCounters counters_;
  std::shared_ptr<Distribution> distribution_;
};

}  // namespace silt::coupler
