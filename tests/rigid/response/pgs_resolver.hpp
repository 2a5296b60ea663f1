#pragma once
// The reference that sffd is held to: the contact law of method.md, (C1) to (C3) and (C7), solved by
// projected Gauss-Seidel, contact by contact with the true masses, until nothing changes. One rank, no pairs,
// no split masses, no prepared matrices; written apart from sffd so that a fault of one shows against the
// other. For tests only: its order of contacts is that of their keys, so no decomposition over ranks could
// keep its results.
#include <algorithm>

#include "rigid/response/contact_resolver.hpp"

namespace silt::rigid::testing {

class PgsResolver : public ContactResolver {
 public:
  struct Solved {  // a contact
    Contact contact;
    std::size_t a, b;  // rows
    Vec3 r_a, r_b;
    Mat3 inverse_inertia_a, inverse_inertia_b;
    double inverse_mass_a, inverse_mass_b;
    Mat3 response;  // velocity at the contact for an impulse there
    double target = 0;
    Vec3 impulse = Vec3::Zero();  // on b, W
  };
  double tolerance =
      1e-13;  // change of a velocity at a contact in a pass, relative to what all passes changed
  int most_passes = 3000;
  double correction = 0.2;
  std::vector<Solved> solved;  // of the last step
  int passes = 0;
  double residual = 0;

  std::string_view name() const override { return "pgs"; }

  ResolverStatistics resolve(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                             StepVelocities& velocities, BodyExchange&) override {
    ResolverStatistics statistics;
    solved.clear();
    for (const Contact& c : contacts) {
      solved.push_back(prepared(bodies, c));
      solved.back().target = target(solved.back(), dt, velocities);
      if (pressed(bodies, c))
        solved.back().target = std::max(solved.back().target, closing_of_pressed(c, dt));
      statistics.penetration = std::max(statistics.penetration, -c.gap);
    }
    statistics.contacts = contacts.size();
    iterate(velocities.now, true);
    statistics.residual = residual;
    statistics.sweeps = passes;
    push_apart(bodies.size(), dt, velocities);
    return statistics;
  }

 private:
  static Solved prepared(const BodySet& bodies, const Contact& c) {
    const std::size_t a = bodies.row_of(c.a), b = bodies.row_of(c.b);
    Solved s{.contact = c,
             .a = a,
             .b = b,
             .r_a = c.r_a,
             .r_b = is_wall(c.b) ? Vec3(Vec3::Zero()) : c.r_b,
             .inverse_inertia_a = bodies.inverse_inertia_W(a),
             .inverse_inertia_b = bodies.inverse_inertia_W(b),
             .inverse_mass_a = bodies.inverse_mass(a),
             .inverse_mass_b = bodies.inverse_mass(b),
             .response = Mat3::Zero()};
    const auto cross = [](const Vec3& r) {
      Mat3 m;
      m << 0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0;
      return m;
    };
    const Mat3 x_a = cross(s.r_a), x_b = cross(s.r_b);
    s.response = Mat3(Mat3::Identity() * (s.inverse_mass_a + s.inverse_mass_b)) -
                 x_a * s.inverse_inertia_a * x_a - x_b * s.inverse_inertia_b * x_b;
    return s;
  }

  static Vec3 relative(const Solved& s, const std::vector<Twist>& of) {
    return of[s.b].v + of[s.b].w.cross(s.r_b) - of[s.a].v - of[s.a].w.cross(s.r_a);
  }

  static double target(const Solved& s, double dt, const StepVelocities& velocities) {
    const Contact& c = s.contact;
    const double approach = c.normal.dot(relative(s, velocities.before));
    const double closing = std::min(0.0, -c.gap / dt);
    const bool overlaps = c.gap <= 0, reached = c.gap + dt * approach < 0;
    if (approach >= 0 || !(overlaps || reached)) return closing;
    return std::max(closing, -c.restitution * approach);
  }

  /// In the last step: what sffd remembers for its warm start is part of its contact law.
  static bool pressed(const BodySet& bodies, const Contact& c) {
    for (const StoredImpulse& i : bodies.stored_impulses[bodies.row_of(c.a)])
      if (i.partner == c.b && i.feature == c.feature && i.image == c.image)
        return c.normal.dot(i.impulse) > 0;
    return false;
  }
  /// A gap of 1e-4 of the lever arms may stay.
  static double closing_of_pressed(const Contact& c, double dt) {
    const double arms = c.r_a.norm() + (is_wall(c.b) ? 0.0 : c.r_b.norm());
    return -std::max(0.0, c.gap - 1e-4 * arms) / dt;
  }

  static void push(const Solved& s, const Vec3& impulse, std::vector<Twist>& of) {
    of[s.a].v -= s.inverse_mass_a * impulse;
    of[s.a].w -= s.inverse_inertia_a * s.r_a.cross(impulse);
    of[s.b].v += s.inverse_mass_b * impulse;
    of[s.b].w += s.inverse_inertia_b * s.r_b.cross(impulse);
  }

  void iterate(std::vector<Twist>& of, bool rubs) {
    double scale = 0;
    for (passes = 0; passes < most_passes; ++passes) {
      double change = 0;
      for (Solved& s : solved) {
        const Vec3 &n = s.contact.normal, before = s.impulse;
        const double old = before.dot(n);
        const double normal =
            std::max(0.0, old + (s.target - n.dot(relative(s, of))) / n.dot(s.response * n));
        s.impulse += (normal - old) * n;
        push(s, (normal - old) * n, of);
        if (rubs) rub(s, normal, of);
        change = std::max(change, (s.response * (s.impulse - before)).norm());
      }
      scale = std::max(scale, change);
      residual = scale > 0 ? change / scale : 0;
      if (residual <= tolerance) return;
    }
  }

  static void rub(Solved& s, double normal, std::vector<Twist>& of) {
    const Vec3& n = s.contact.normal;
    const Mat3 flat = Mat3::Identity() - n * n.transpose();
    const double largest = (flat * s.response * flat).trace();  // no smaller than the larger eigenvalue
    const Vec3 old = flat * s.impulse;
    Vec3 tangential = old - flat * relative(s, of) / largest;
    const double limit = s.contact.friction * normal;
    if (tangential.norm() > limit) tangential *= limit / tangential.norm();
    s.impulse += tangential - old;
    push(s, tangential - old, of);
  }

  void push_apart(std::size_t rows, double dt, StepVelocities& s) {
    const std::vector<Solved> impulses = solved;
    const int passes_before = passes;
    const double residual_before = residual;
    s.push.assign(rows, {});
    for (Solved& k : solved) {
      const double u = k.contact.normal.dot(relative(k, s.now)), gap = k.contact.gap;
      k.target =
          gap > 0 ? std::min(0.0, -(gap / dt + u)) : std::max(0.0, -correction * gap / dt - std::max(0.0, u));
      k.impulse = Vec3::Zero();
    }
    iterate(s.push, false);
    solved = impulses, passes = passes_before, residual = residual_before;
  }
};

}  // namespace silt::rigid::testing
