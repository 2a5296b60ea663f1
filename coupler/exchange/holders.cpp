#include "coupler/exchange/holders.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

void sort_unique(std::vector<int>& ranks) {
  std::sort(ranks.begin(), ranks.end());
  ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
}

/// Wraps x into [0, length), also after rounding.
double wrapped(double x, double length) {
  if (x >= 0 && x < length) return x;
  const double y = x - std::floor(x / length) * length;
  return y >= 0 && y < length ? y : 0.0;
}

/// Returns the cell of x; the first and last cell are unbounded, and the first also gets NaN.
int clamped(double x, int cells) {
  if (!(x >= 0)) return 0;
  return x >= cells ? cells - 1 : static_cast<int>(x);
}

/// Returns the largest gap of a lubrication film between two bodies.
double film_reach(const rigid::World& world) {
  return world.contact_margin + world.lubrication->reach();
}

/// Returns the largest bounding radius, not counting walls.
double largest_radius_of(const rigid::World& world) {
  double largest = 0;
  for (const double radius : world.bounding_radii)
    if (std::isfinite(radius)) largest = std::max(largest, radius);
  return largest;
}

constexpr double furthest_in_a_step = 2;  // cells, at least
constexpr double ahead = 0.5;             // steps for which copies drift by themselves

/// Half-integer, so that rounding cannot make one of two blocks find the other but not the reverse.
double reach_of(const lbm::Domain& domain, const rigid::World& world, double rim) {
  const double largest = largest_radius_of(world);
  const double to_partner = world.lubrication ? largest + film_reach(world) : 0;
  int thinnest = std::numeric_limits<int>::max();
  domain.tree().for_leaves_meeting({{}, domain.cells()}, [&](const lbm::CutTree::Leaf& leaf) {
    for (int d = 0; d < 3; ++d) thinnest = std::min(thinnest, leaf.box.size[d]);
  });
  return std::max(std::ceil(rim + largest + to_partner + (1 + ahead) * furthest_in_a_step) + 0.5,
                  thinnest - 0.5);
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
  sort_unique(all);
  std::erase(all, rank);
  return all;
}

}  // namespace

Holders::Holders(const lbm::Domain& domain, double rim, int here) : domain_(&domain), rim_(rim), here_(here) {
  if (here < 0) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const lbm::BlockPlace& place : domain.blocks_of(here)) {
    const lbm::CellBox& box = place.box;
    rigid::BoundingBox& bounds = blocks_here_.emplace_back();
    for (int d = 0; d < 3; ++d) {
      const int lower = box.lower[d], upper = lower + box.size[d];
      const bool ends = !domain.periodic(d);
      bounds.lower[d] = ends && lower == 0 ? -infinity : lower;
      bounds.upper[d] = ends && upper == domain.cells()[d] ? infinity : upper;
    }
  }
}

lbm::Int3 Holders::cell_at(const rigid::Vec3& x) const {
  lbm::Int3 cell;
  for (int d = 0; d < 3; ++d) {
    const int n = domain_->cells()[d];
    cell[d] = clamped(domain_->periodic(d) ? wrapped(x[d], n) : x[d], n);
  }
  return cell;
}

lbm::CellRun Holders::met_by(int axis, double lower, double upper) const {
  const double from = lower - rim_, to = upper + rim_;
  const int n = domain_->cells()[axis];
  if (!domain_->periodic(axis)) {
    const int first = clamped(from, n);
    return {first, clamped(to, n) - first + 1};
  }
  if (!(to - from < n)) return {0, n};
  const double start = wrapped(from, n), end = start + (to - from);
  const int first = clamped(start, n);
  const int last = end < n ? clamped(end, n) : clamped(end - n, n) + n;
  return {first, std::min(last - first + 1, n)};
}

void Holders::ranks_of(const rigid::BoundingBox& box, std::vector<int>& ranks) const {
  ranks.clear();
  const rigid::Vec3 rim = rigid::Vec3::Constant(rim_);
  if (is_here(box.lower - rim, box.upper + rim)) return ranks.push_back(here_);
  std::array<lbm::CellRun, 3> runs;
  for (int d = 0; d < 3; ++d) runs[d] = met_by(d, box.lower[d], box.upper[d]);
  domain_->for_blocks_meeting(runs, [&](const lbm::BlockPlace& block) {
    if (ranks.empty() || ranks.back() != block.rank) ranks.push_back(block.rank);
  });
  sort_unique(ranks);
}

Neighbourhood::Neighbourhood(const lbm::Domain& domain, const rigid::World& world, double rim, int rank)
    : domain_(&domain),
      world_(&world),
      rim_(rim),
      rank_(rank),
      holders_(domain, rim, rank),
      owners_(domain, furthest_in_a_step, rank),
      largest_radius_(largest_radius_of(world)),
      reach_(reach_of(domain, world, rim)),
      around_(ranks_around(domain, rank, reach_)) {}

void include(std::vector<int>& sorted, int rank) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), rank);
  if (at == sorted.end() || *at != rank) sorted.insert(at, rank);
}

/// Tests the bounding sphere first: most bodies are well inside a block.
void Neighbourhood::find_holders(int shape, const rigid::Pose& pose, const rigid::Twist& motion,
                                 std::vector<int>& ranks) const {
  const double radius = world_->bounding_radii[shape];
  const rigid::Vec3 back = motion.v.cwiseMin(0), forth = motion.v.cwiseMax(0);
  const auto ranks_beyond = [&](const rigid::BoundingBox& box, double slack) {
    const rigid::Vec3 rim = rigid::Vec3::Constant(slack);
    holders_.ranks_of({box.lower + back - rim, box.upper + forth + rim}, ranks);
  };
  ranks_beyond({pose.position, pose.position}, radius);
  if (ranks.size() > 1 && !rigid::is_sphere(world_->shapes[shape]))
    ranks_beyond(rigid::bounding_box(world_->shapes[shape], pose), radius * motion.w.norm());
  include(ranks, rank_at(pose.position));
}

void Neighbourhood::find_holders(const rigid::BodySet& bodies, std::size_t row,
                                 std::vector<int>& ranks) const {
  const rigid::Twist motion{ahead * bodies.velocity[row], ahead * bodies.angular_velocity[row]};
  find_holders(bodies.shape[row], bodies.pose(row), motion, ranks);
  if (world_->lubrication) include_owners_beyond_films(bodies, row, ranks);
}

/// In the next step the coupling in time needs the velocity of the bodies beyond the films of an owned body,
/// so the owner of a film's other body must know this one. That owner follows from the new position for a
/// body owned here, from the last position for a copy, and for a visitor only from the range of films.
void Neighbourhood::include_owners_beyond_films(const rigid::BodySet& bodies, std::size_t row,
                                                std::vector<int>& ranks) const {
  const rigid::Vec3& x = bodies.position[row];
  std::vector<int> near;
  const auto anywhere_near = [&] {
    const double far = world_->bounding_radii[bodies.shape[row]] + film_reach(*world_) + largest_radius_;
    owners_.ranks_of({x - rigid::Vec3::Constant(far), x + rigid::Vec3::Constant(far)}, near);
  };
  const auto is_film = [](const rigid::StoredImpulse& s) {
    return (s.feature & rigid::lubrication_feature) && !rigid::is_wall(s.partner);
  };
  const auto& impulses = bodies.stored_impulses[row];
  if (std::ranges::none_of(impulses, is_film)) return;
  anywhere_near();
  if (near.size() == 1) return;  // this rank
  for (const rigid::StoredImpulse& s : impulses) {
    if (!is_film(s)) continue;
    const std::size_t other = bodies.row_of(s.partner);  // no valid row for a visitor, which is gone
    if (other < bodies.owned)
      near.assign(1, rank_at(bodies.position[other]));
    else if (other < bodies.owned + bodies.copies && bodies.id[other] == s.partner)
      owners_.ranks_of({bodies.position[other], bodies.position[other]}, near);
    else
      anywhere_near();
    ranks.insert(ranks.end(), near.begin(), near.end());
  }
  sort_unique(ranks);
}

}  // namespace silt::coupler
