#include "rigid/response/contact_targets.hpp"

#include "rigid/response/turning.hpp"

namespace silt::rigid {
namespace {

constexpr double no_gap = 1e-6;  // relative to the lever arms: smaller gaps count as closed

/// The state of a cohesive contact.
struct CohesiveState {
  bool touch;
  double chord, kept;  // gaps: by rotation about each other; to be kept in the next step
};

CohesiveState state_of(const Contact& c, const Turning& turning, bool pressed) {
  const double arms = lever_arms(c), chord = turning.gap_of_chord();
  constexpr double turn_of_step = 4;  // second-order opening of a whole step over that of half a step
  if ((pressed || c.lubrication) && c.gap <= hair * arms + turn_of_step * chord)
    return {true, chord, chord + (c.lubrication ? 0 : hair * arms)};
  constexpr double share = 0.5;  // relative to the opening by rotation: accuracy of the gap at the start
  const bool touched = c.gap <= no_gap * arms || turning.gap_at_start() <= share * chord;
  return {touched, chord, touched ? chord : 0};
}

double pull(const Material& material, const Contact& c, const CohesiveState& state) {
  double force = state.touch ? material.cohesion : 0;
  const double apart = c.gap - (state.touch ? state.chord : 0);
  if (material.hamaker > 0 && apart <= material.van_der_waals_reach()) {
    const double gap = std::max(apart, material.hamaker_gap);
    force += material.hamaker * std::sqrt(c.radii.least * c.radii.largest) / (6 * gap * gap);
  }
  return force;
}

template <class Pressed>
void set_cohesion(const CohesivePair& p, std::span<ContactImpulse> impulses, Pressed pressed) {
  for (std::size_t k = 0; k < p.contacts.size(); ++k) {
    const Contact& c = p.contacts[k];
    const Turning turning(c, p.joined, p.a, p.b, p.dt);
    const CohesiveState held = state_of(c, turning, pressed(impulses[k]));
    impulses[k].last_normal = turning.normal_before();
    impulses[k].pull = p.dt * pull(p.material, c, held) / static_cast<double>(p.contacts.size());
    impulses[k].kept_gap = held.kept;
  }
}

}  // namespace

void set_pulls(const CohesivePair& p, std::span<ContactImpulse> impulses) {
  set_cohesion(p, impulses, [](const ContactImpulse& i) { return i.pressed; });
}

void set_greatest_pulls(const CohesivePair& p, std::span<ContactImpulse> impulses) {
  set_cohesion(p, impulses, [](const ContactImpulse&) { return true; });
}

Vec3 keep_together(const CohesivePair& p, std::span<const ContactImpulse> impulses,
                   std::span<double> targets) {
  if (std::ranges::none_of(impulses, [](const ContactImpulse& i) { return i.pull > 0; })) return Vec3::Zero();
  const Vec3 together = Turning(p.contacts[0], p.joined, p.a, p.b, p.dt).velocity_together();
  for (std::size_t k = 0; k < p.contacts.size(); ++k) {
    const Contact& c = p.contacts[k];
    if (targets[k] > 0) continue;
    const double turns_open = std::max(0.0, -together.dot(c.normal));
    if (c.gap <= 0)
      targets[k] = std::min(-c.gap / p.dt, turns_open);
    else if (impulses[k].pull > 0)
      targets[k] = std::min(0.0, impulses[k].kept_gap - c.gap) / p.dt;
  }
  return together;
}

}  // namespace silt::rigid
