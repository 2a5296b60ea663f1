#include "rigid/response/turning.hpp"

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

}  // namespace silt::rigid
