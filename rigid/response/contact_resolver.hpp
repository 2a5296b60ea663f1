#pragma once
// The interface of contact resolvers, which turn the contacts of a step into post-contact velocities (lines
// 14 to 20 of the paper's Algorithm 1).
#include <algorithm>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// A contact with a sudden change of two bodies' velocities.
struct Impact {
  std::size_t row_a, row_b;  // of the BodySet
  Vec3 normal;               // unit, from a to b, W
  double impulse;            // on b along the normal, mass times velocity in lattice units
};

/// Receives every impact once its impulse is final, on each rank that solved the pair (owns one of its free
/// bodies), bitwise the same and in the order of the contacts.
class ImpactSink {
 public:
  virtual ~ImpactSink() = default;
  /// Returns the additional impulse that b receives over later steps, and a reversed; W.
  virtual Vec3 operator()(BodySet&, const Impact&) const = 0;
};

struct ResolverSettings {
  int max_sweeps = 16;
  double sweep_tolerance = 1e-10;  // relative change of the impulses at which the sweeps stop
  double correction = 0.2;         // fraction of the overlap removed per step (split impulses; ffd: alpha)
  double slop = 0.0;               // overlap that is not corrected, lattice units
  bool warm_start = true;
  int impact_sweeps = 0;  // sffd: limit of sweeps of the impact phase before it (impact_phase.hpp); 0: none
  double least_impact_restitution = 0;  // least restitution of a pair that takes part in it
  std::shared_ptr<const ImpactSink>
      impacts;  // sffd: receives every impact outside the impact phase; null: none does
  // of pairs, as in World; empty: no pair resists rolling or pulls (sffd)
  std::vector<Material> materials;
  int material_count = 0;
};

/// Sets the materials if any has more than restitution and friction.
inline void set_materials(ResolverSettings& settings, const World& world) {
  const auto plain = [](const Material& m) { return m.rolls_freely() && !m.pulls(); };
  if (std::ranges::all_of(world.materials, plain)) return;
  settings.materials = world.materials;
  settings.material_count = world.material_count;
}

struct ResolverStatistics {
  std::uint64_t contacts = 0;  // of owned bodies, each counted by the owner of its lower id
  int sweeps = 0;              // number of the last sweep that solved a pair of this rank
  int impact_sweeps = 0;
  double residual =
      0;  // largest change of a body's velocity in the last sweep allowed; 0 if converged before
  double penetration = 0;        // deepest overlap, lattice units
  double cone_excess = 0;        // largest |p_t| - mu p_n, relative to p_n
  std::uint64_t infeasible = 0;  // ffd: bodies stopped for lack of a feasible velocity

  /// Adds a later sub-step: sums of sweeps and failures, maxima of errors; contacts are replaced.
  ResolverStatistics& operator+=(const ResolverStatistics& later) {
    contacts = later.contacts;
    sweeps += later.sweeps;
    impact_sweeps += later.impact_sweeps;
    residual = std::max(residual, later.residual);
    penetration = std::max(penetration, later.penetration);
    cone_excess = std::max(cone_excess, later.cone_excess);
    infeasible += later.infeasible;
    return *this;
  }
};

/// A part of a contact's impulse, on its second body and reversed on its first, that is not stored for the
/// warm start: of a film against rolling, of an impact, or from the ImpactSink.
struct OtherImpulse {
  std::size_t contact;   // index
  Vec3 impulse, moment;  // W; the moment is about the contact point
};

/// The sum of a body's contact impulses in a step, and of their moments about its centre of mass; W.
struct ContactSum {
  std::size_t row;
  Vec3 impulse, moment;
};

/// Velocities during a step, one entry per row of the BodySet, set for rows with a contact.
struct StepVelocities {
  bool start = false;                     // in: the first step, without stored impulses
  std::vector<std::size_t> rows;          // rows with a contact
  std::vector<Twist> before;              // in: before the kick, for restitution
  std::vector<Twist> now;                 // in: after the kick; out: after the contacts
  std::vector<Twist> push;                // out: pseudo velocities of the position correction; or empty
  std::vector<std::uint8_t> misses_kick;  // out (if first_kick() < 1): bodies that do not get the rest of it
  std::vector<double>
      rebounds;  // in: least separation velocity of each contact after the impact phase; or empty
  bool wants_all_impulses = false;           // in: false: only for walls and fixed bodies
  std::vector<OtherImpulse> other_impulses;  // appended, for pairs with an owned free body
  std::vector<ContactSum> on_locked;  // out: of bodies with locked axes, whose velocities do not tell them
  bool records_impulses(const BodySet& bodies, std::size_t row_a, std::size_t row_b) const {
    return wants_all_impulses || !bodies.is_dynamic(row_a) || !bodies.is_dynamic(row_b);
  }
};

class ContactResolver {
 public:
  virtual ~ContactResolver() = default;
  virtual std::string_view name() const = 0;
  /// Fraction of the external force (not of gravity) that acts before the contacts: 1 (sffd) or 1/2 (ffd).
  virtual double first_kick() const { return 1.0; }
  /// Sets velocities.now of the owned rows in contact. Bodies are after the kick; contacts sorted by key.
  virtual ResolverStatistics resolve(BodySet&, const std::vector<Contact>&, double dt, StepVelocities&,
                                     BodyExchange&) = 0;
};

/// A resolver's name and features. A new one is a row in contact_resolver.cpp.
struct ResolverModel {
  std::string_view name;
  bool lubricates = false, has_impact_phase = false;
  bool resists_rolling_and_pulls = false;
  bool makes_energy = false;  // several contacts of a body may increase the energy
  bool sweeps = false;        // iterates over the contacts
  std::unique_ptr<ContactResolver> (*make)(const ResolverSettings&);
};

/// Returns all resolvers, the default first.
std::span<const ResolverModel> resolver_models();
/// Returns the resolver of a name; throws std::invalid_argument with the known names.
const ResolverModel& resolver_model(std::string_view name);
std::unique_ptr<ContactResolver> make_resolver(std::string_view name, const ResolverSettings&);

}  // namespace silt::rigid
