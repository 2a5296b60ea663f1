#pragma once
// A contact resolver turns the contacts of one step into post-contact velocities (lines 14 to 20 of the
// paper's Algorithm 1).
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

/// A contact that changes the velocities of two bodies at once.
struct Impact {
  std::size_t row_a, row_b;  // of the BodySet
  Vec3 normal;               // unit, from a to b, W
  double impulse;            // on b along the normal, mass times velocity in lattice units
};

/// A sink does something about impacts. It hears of each once its impulse is final, on every rank that solved
/// the pair (that owns one of its free bodies), in the order of the contacts, bitwise the same on each.
class ImpactSink {
 public:
  virtual ~ImpactSink() = default;
  /// Returns what b gets besides the impulse reported, and a the reverse of, in time; W.
  virtual Vec3 operator()(BodySet&, const Impact&) const = 0;
};

struct ResolverSettings {
  int max_sweeps = 16;
  double sweep_tolerance = 1e-10;  // relative change of the impulses at which the sweeps stop
  double correction = 0.2;         // share of the overlap taken back a step (split impulses; ffd: alpha)
  double slop = 0.0;               // overlap left alone, lattice units
  bool warm_start = true;
  int impact_sweeps = 0;  // sffd: of the impact phase before it (impact_phase.hpp), at most; 0: none
  double least_impact_restitution = 0;  // the least with which a pair takes part in it
  std::shared_ptr<const ImpactSink>
      impacts;  // sffd: told of every impact but those of the impact phase; null: nobody
  // of pairs, as those of the World; empty: no pair resists rolling or pulls (sffd)
  std::vector<Material> materials;
  int material_count = 0;
};

/// Gives a resolver the materials that have more than restitution and friction.
inline void set_materials(ResolverSettings& settings, const World& world) {
  const auto plain = [](const Material& m) { return m.rolls_freely() && !m.pulls(); };
  if (std::ranges::all_of(world.materials, plain)) return;
  settings.materials = world.materials;
  settings.material_count = world.material_count;
}

struct ResolverStatistics {
  std::uint64_t contacts = 0;  // of owned bodies, each counted at the owner of its lower id
  int sweeps = 0;              // the last that solved a pair of this rank
  int impact_sweeps = 0;
  double residual = 0;     // largest change of a body's velocity in the last sweep allowed; 0: at rest before
  double penetration = 0;  // deepest overlap met, lattice units
  double cone_excess = 0;  // largest |p_t| - mu p_n, relative to p_n
  std::uint64_t infeasible = 0;  // ffd: bodies stopped because no feasible velocity was found

  /// Adds a later sub-step: sums of what is done, extremes of what is met; contacts are those of the last
  /// one.
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

/// What a contact gives its second body, and takes from its first one, besides the impulse that they
/// remember: what its film does against rolling, an impact, which is forgotten, and what the ImpactSink adds.
struct OtherImpulse {
  std::size_t contact;   // its index
  Vec3 impulse, moment;  // W; the latter about its point
};

/// Velocities at hand in the middle of a step, one entry a row of the BodySet: set where a contact is.
struct StepVelocities {
  bool start = false;                     // in: nothing happened before, so no impulse is stored
  std::vector<std::size_t> rows;          // that have a contact
  std::vector<Twist> before;              // the kick: what restitution sees
  std::vector<Twist> now;                 // in: after the kick; out: after the contacts
  std::vector<Twist> push;                // out: position correction, velocities for positions only; or empty
  std::vector<std::uint8_t> misses_kick;  // out (if first_kick() < 1): bodies that miss the rest of theirs
  std::vector<double>
      rebounds;  // in: least velocities of contacts at which impacts have parted them; or empty
  bool wants_all_impulses = false;           // in: else those of walls and fixed bodies alone are told
  std::vector<OtherImpulse> other_impulses;  // added to: of pairs with an owned free body
  bool tells_impulses(const BodySet& bodies, std::size_t row_a, std::size_t row_b) const {
    return wants_all_impulses || !bodies.is_dynamic(row_a) || !bodies.is_dynamic(row_b);
  }
};

class ContactResolver {
 public:
  virtual ~ContactResolver() = default;
  virtual std::string_view name() const = 0;
  /// Share of the external force (not of gravity) that acts before the contacts: 1 (sffd) or 1/2 (ffd).
  virtual double first_kick() const { return 1.0; }
  /// bodies: after the kick. contacts: sorted by key, all those of owned bodies. Fills velocities of owned
  /// rows that have one.
  virtual ResolverStatistics resolve(BodySet&, const std::vector<Contact>&, double dt, StepVelocities&,
                                     BodyExchange&) = 0;
};

/// A resolver by its name, and which settings and phases of a step it knows. A new one is a row in
/// contact_resolver.cpp.
struct ResolverModel {
  std::string_view name;
  bool lubricates, has_impact_phase;
  bool resists_rolling_and_pulls;
  bool makes_energy;  // contacts of several bodies may leave more than there was
  bool sweeps;        // over the contacts, again and again
  std::unique_ptr<ContactResolver> (*make)(const ResolverSettings&);
};

/// Returns every resolver, the default first.
std::span<const ResolverModel> resolver_models();
/// Returns the row of a name; std::invalid_argument names the known ones.
const ResolverModel& resolver_model(std::string_view name);
std::unique_ptr<ContactResolver> make_resolver(std::string_view name, const ResolverSettings&);

}  // namespace silt::rigid
