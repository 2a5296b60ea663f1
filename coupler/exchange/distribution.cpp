#include "coupler/exchange/distribution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace silt::coupler {

using rigid::BodyId;
using rigid::BodySet;

namespace {

/// The widest gap of a film between two bodies.
double film_reach(const rigid::World& world) {
  return world.contact_margin + world.lubrication->reach();
}

/// Of bodies: walls have none.
double largest_radius_of(const rigid::World& world) {
  double largest = 0;
  for (const double radius : world.bounding_radii)
    if (std::isfinite(radius)) largest = std::max(largest, radius);
  return largest;
}

constexpr double furthest_in_a_step = 2;  // cells, at least

/// Half a cell more or less than a whole number, so that of two blocks each finds the other.
double reach_of(const lbm::Domain& domain, const rigid::World& world, double rim) {
  const double largest = largest_radius_of(world);
  const double to_partner = world.lubrication ? largest + film_reach(world) : 0;
  int thinnest = std::numeric_limits<int>::max();
  domain.tree().for_leaves_meeting({{}, domain.cells()}, [&](const lbm::CutTree::Leaf& leaf) {
    for (int d = 0; d < 3; ++d) thinnest = std::min(thinnest, leaf.box.size[d]);
  });
  return std::max(std::ceil(rim + largest + to_partner + furthest_in_a_step) + 0.5, thinnest - 0.5);
}

std::vector<int> ranks_around(const lbm::Domain& domain, int rank, double reach) {
  const Holders holders(domain, reach);
  std::vector<int> all, of_block;
  for (const lbm::BlockPlace& place : domain.blocks_of(rank)) {
    rigid::BoundingBox bounds;
    for (int d = 0; d < 3; ++d) {
      bounds.lower[d] = place.box.lower[d];
      bounds.upper[d] = place.box.lower[d] + place.box.size[d];
    }
    holders.ranks_of(bounds, of_block);
    all.insert(all.end(), of_block.begin(), of_block.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::erase(all, rank);
  return all;
}

template <class T>
std::span<T> row_of(std::span<T> rows, std::size_t row, int width) {
  return rows.subspan(row * width, width);
}

}  // namespace

ParallelBodyExchange::Distribution::Distribution(MPI_Comm comm, int rank, const lbm::Domain& domain,
                                                 const rigid::World& world, double rim)
    : rank(rank),
      world(world),
      holders(domain, rim, rank),
      owners(domain, furthest_in_a_step, rank),
      messages(comm),
      largest_radius(largest_radius_of(world)),
      reach(reach_of(domain, world, rim)),
      around(ranks_around(domain, rank, reach)) {}

/// The coupling in time asks in the next step how fast the bodies beyond the films of an owned body are, so
/// the owner of a film's other body has to know this one. Who that will be: of a body owned here its new
/// place tells, of a copy the place it had, of one that only the sweeps knew no more than how wide a film is.
void ParallelBodyExchange::Distribution::include_owners_beyond_films(const BodySet& bodies, std::size_t row,
                                                                     std::vector<int>& ranks) {
  const rigid::Vec3& x = bodies.position[row];
  const auto anywhere_near = [&](std::vector<int>& found) {
    const double far = world.bounding_radii[bodies.shape[row]] + film_reach(world) + largest_radius;
    owners.ranks_of({x - rigid::Vec3::Constant(far), x + rigid::Vec3::Constant(far)}, found);
  };
  const auto films = [](const rigid::StoredImpulse& s) {
    return (s.feature & rigid::lubrication_feature) && !rigid::is_wall(s.partner);
  };
  const auto& impulses = bodies.stored_impulses[row];
  if (std::none_of(impulses.begin(), impulses.end(), films)) return;
  anywhere_near(near_);
  if (near_.size() == 1) return;  // this rank
  for (const rigid::StoredImpulse& s : impulses) {
    if (!films(s)) continue;
    const std::size_t other = bodies.row_of(s.partner);  // of a visitor, which is gone, anything
    if (other < bodies.owned)
      near_.assign(1, holders.rank_at(bodies.position[other]));
    else if (other < bodies.owned + bodies.copies && bodies.id[other] == s.partner)
      owners.ranks_of({bodies.position[other], bodies.position[other]}, near_);
    else
      anywhere_near(near_);
    ranks.insert(ranks.end(), near_.begin(), near_.end());
  }
  std::sort(ranks.begin(), ranks.end());
  ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
}

const std::vector<int>& ParallelBodyExchange::Distribution::those_that(std::vector<BodyId> Tie::*have) {
  ranks_.clear();
  for (const Tie& t : ties)
    if (!(t.*have).empty()) ranks_.push_back(t.rank);
  return ranks_;
}

int ParallelBodyExchange::Distribution::owner(BodyId id) const {
  const auto found = owner_of.find(id);
  if (found == owner_of.end())
    throw std::logic_error("body " + std::to_string(id) + " has no known owner here");
  return found->second;
}

void ParallelBodyExchange::Distribution::forget(BodyId id) {
  held_by.erase(id);
  owner_of.erase(id);
}

void ParallelBodyExchange::Distribution::tie(const BodySet& bodies) {
  ties.clear();
  const auto with = [&](int other) -> Tie& {
    const auto at =
        std::lower_bound(ties.begin(), ties.end(), other, [](const Tie& t, int r) { return t.rank < r; });
    return at != ties.end() && at->rank == other ? *at : *ties.insert(at, {other, {}, {}});
  };
  held_.clear();
  for (const auto& held : held_by) held_.push_back(held.first);
  std::sort(held_.begin(), held_.end());
  for (const BodyId id : held_)
    for (const int holder : held_by.find(id)->second.ranks) with(holder).given.push_back(id);
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row)
    with(owner(bodies.id[row])).taken.push_back(bodies.id[row]);
}

void ParallelBodyExchange::Distribution::sum_to_owners(const BodySet& bodies, std::span<std::int64_t> rows,
                                                       int width) {
  for (const Tie& t : ties)
    for (const BodyId id : t.taken) {
      const std::span<std::int64_t> values = row_of(rows, bodies.row_of(id), width);
      parallel::put(messages.to(t.rank), std::span<const std::int64_t>(values));
      std::fill(values.begin(), values.end(), 0);
    }
  messages.with_partners(those_that(&Tie::given));
  std::vector<std::int64_t> values(width);
  for (const parallel::Messages::Message& m : messages.received()) {
    parallel::ByteReader reader(m.bytes);
    const auto t = std::find_if(ties.begin(), ties.end(), [&](const Tie& t) { return t.rank == m.rank; });
    for (const BodyId id : t->given) {
      reader.take(std::span(values));
      const std::span<std::int64_t> sums = row_of(rows, bodies.row_of(id), width);
      for (int k = 0; k < width; ++k) sums[k] += values[k];
    }
  }
}

void ParallelBodyExchange::Distribution::share_with_copies(const BodySet& bodies, std::span<double> rows,
                                                           int width) {
  std::vector<double> none(width, 0.0);  // of a body taken out of the simulation since
  const auto values_of = [&](BodyId id) {
    const std::size_t row = bodies.row_of(id);
    return row < bodies.size() ? row_of(rows, row, width) : std::span(none);
  };
  for (const Tie& t : ties)
    for (const BodyId id : t.given)
      parallel::put(messages.to(t.rank), std::span<const double>(values_of(id)));
  messages.with_partners(those_that(&Tie::taken));
  for (const parallel::Messages::Message& m : messages.received()) {
    parallel::ByteReader reader(m.bytes);
    const auto t = std::find_if(ties.begin(), ties.end(), [&](const Tie& t) { return t.rank == m.rank; });
    for (const BodyId id : t->taken) reader.take(values_of(id));
  }
}

}  // namespace silt::coupler
