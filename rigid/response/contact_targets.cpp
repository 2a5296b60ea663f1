#include "rigid/response/contact_targets.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {
namespace {

Vec3 turn_of_normal(NormalTurns turns, const Vec3& of_a, const Vec3& of_b) {
  switch (turns) {
    case NormalTurns::with_a:
      return of_a;
    case NormalTurns::with_b:
      return of_b;
    case NormalTurns::with_both:
      return 0.5 * (of_a + of_b);
    default:
      return Vec3::Zero();
  }
}

double root(double square) {
  return std::sqrt(std::max(0.0, square));
}

}  // namespace

Turning::Turning(const Contact& c, bool joined, const Twist& a, const Twist& b, double dt)
    : normal_(c.normal),
      between_(c.r_a - c.r_b + (joined ? 0 : c.gap) * c.normal),
      turn_(turn_of_normal(c.normal_turns, a.w, b.w)),
      half_turn_(cayley(0.5 * dt * turn_)),
      gap_(c.gap),
      opening_rate_(normal_.dot(b.at(c.r_b) - a.at(c.r_a))),
      dt_(dt),
      with_centres_(c.normal_turns == NormalTurns::with_centres) {
  across_ = b.v - a.v - opening_rate_ * normal_;
}

double Turning::gap_at_start() const {
  const Vec3 velocity = across_ + opening_rate_ * normal_, start = between_ - 0.5 * dt_ * velocity;
  if (with_centres_) return start.norm() - (normal_.dot(between_) - gap_);
  const double by_arms = opening_rate_ - normal_.dot(velocity - turn_.cross(between_));
  return gap_ + normal_.dot(half_turn_ * start - between_) - 0.5 * dt_ * by_arms;
}

/// The centres of spheres are the corners of a polygon whose sides touch a circle at their middles.
double Turning::gap_of_chord() const {
  if (!with_centres_) return std::max(0.0, -0.5 * dt_ * normal_.dot(velocity_along(half_turn_, 0.5 * dt_)));
  const double touching = normal_.dot(between_) - gap_, sine = 0.5 * dt_ * across_.norm() / touching;
  constexpr double steepest = 0.9;  // limit; no body rotates as fast (method-parallel.md, guards)
  const double bounded = std::min(sine, steepest);
  return touching / root(1 - bounded * bounded) - touching;
}

Vec3 Turning::normal_before() const {
  if (with_centres_) return (between_ - dt_ * (across_ + opening_rate_ * normal_)).normalized();
  return half_turn_.conjugate() * (half_turn_.conjugate() * normal_);
}

/// In a rotating frame b continues along the surface of a.
Vec3 Turning::velocity_along(const Quat& turned, double time) const {
  const Vec3 with_frame = turn_.cross(between_), slip = across_ - with_frame;
  const Vec3 later = between_ + time * (slip - normal_.dot(slip) * normal_);
  return (turned * later - later) / time - with_frame;
}

/// Centres of spheres keep their distance; other bodies keep their relative pose as they rotate.
Vec3 Turning::velocity_together() const {
  if (!with_centres_)
    return turn_ == Vec3::Zero() ? Vec3(Vec3::Zero()) : velocity_along(half_turn_ * half_turn_, dt_);
  const double distance = normal_.dot(between_);
  return (root(distance * distance - dt_ * dt_ * across_.squaredNorm()) - distance) / dt_ * normal_;
}

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
