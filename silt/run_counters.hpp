#pragma once
// The counters of a run. A new counter needs a member and a line in visit_counters, which checkpoints,
// report.json and the sums over ranks use.
#include <cstdint>

#include "rigid/collision/collision_backend.hpp"
#include "silt/case/units.hpp"

namespace silt {

struct CellCounts {
  std::uint64_t covered = 0, uncovered = 0;  // cells that bodies covered and left
};
struct BodyCounts {
  std::uint64_t migrations = 0;         // bodies that changed their owner
  std::uint64_t arrived = 0, left = 0;  // since the start
  std::uint64_t left_by[7] = {};        // through each side of the domain, and into an [[outflow]]
  std::uint64_t refused = 0;            // bodies for which a repeated fill had no room
};
struct ContactCounts {
  std::uint64_t contacts = 0, mixed_owner_contacts = 0;
  std::uint64_t lubricated_contacts = 0, unlubricated_contacts = 0;  // with a film; too narrow for a film
  std::uint64_t infeasible = 0;                                      // of the resolver (ResolverStatistics)
};
struct Counts : CellCounts, BodyCounts, ContactCounts, rigid::BackendCounters {};
struct Extremes {
  double sweeps = 0;  // of the rank with most
  double body_speed = 0, penetration = 0, residual = 0;
};

/// The counters since step 0, lattice units. Counts of contacts are summed over steps.
struct RunCounters : Counts, Extremes {};

struct CounterName {
  const char *checkpoint, *report;        // names in checkpoints and report.json (null: none)
  Dimension dimension = dimension::none;  // of the value in the report
};

/// Calls visit(name, counter) for each counter. Counts are summed over ranks and steps, extremes are maxima.
template <class Counters, class Visit>
void visit_counters(Counters& c, Visit&& visit) {
  visit(CounterName{"covered", "covered"}, c.covered);
  visit(CounterName{"uncovered", "uncovered"}, c.uncovered);
  visit(CounterName{"migrations", "migrations"}, c.migrations);
  visit(CounterName{"arrived", "bodies_arrived"}, c.arrived);
  visit(CounterName{"refused", "bodies_refused"}, c.refused);
  visit(CounterName{"left", "bodies_left"}, c.left);
  constexpr const char* ways[7] = {"left_x_low", "left_x_high", "left_y_low",  "left_y_high",
                                   "left_z_low", "left_z_high", "left_outflow"};
  for (int way = 0; way < 7; ++way) visit(CounterName{ways[way], nullptr}, c.left_by[way]);
  visit(CounterName{"contacts", "contacts"}, c.contacts);
  visit(CounterName{"mixed_owner_contacts", "mixed_owner_contacts"}, c.mixed_owner_contacts);
  visit(CounterName{"sweeps", "resolver_sweeps"}, c.sweeps);
  visit(CounterName{"infeasible", "infeasible"}, c.infeasible);
  visit(CounterName{"queries", "collision_queries"}, c.queries);
  visit(CounterName{"answered", "answered_by_engine"}, c.answered);
  visit(CounterName{"refined", "refined_from_engine"}, c.refined);
  visit(CounterName{"fallbacks", "fallbacks"}, c.fallbacks);
  visit(CounterName{"lubricated_contacts", "lubricated_contacts"}, c.lubricated_contacts);
  visit(CounterName{"unlubricated_contacts", "unlubricated_contacts"}, c.unlubricated_contacts);
  visit(CounterName{"body_speed", "max_body_velocity", dimension::velocity}, c.body_speed);
  visit(CounterName{"penetration", "max_penetration", dimension::length}, c.penetration);
  visit(CounterName{"residual", "resolver_residual", dimension::velocity}, c.residual);
}

}  // namespace silt
