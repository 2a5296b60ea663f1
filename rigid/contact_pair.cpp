#include "rigid/contact_pair.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {

namespace {

constexpr int most_rounds = 40;             // with 12 a stack drifts and vibrates, with 40 it settles (FFD.md 5.3)
constexpr double converged = 1e-14;         // change of an impulse in a round, relative to the largest
constexpr double decoupled = 1e-12;         // mixing of directions, relative to k_n: none

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return m;
}

/// Velocity of the contact point for a unit impulse there: 1/m - [r] I^-1 [r].
Mat3 mobility(const SplitMass& m, const Vec3& r) {
  const Mat3 x = cross_matrix(r);
  return m.inverse_mass * Mat3::Identity() - x * m.inverse_inertia * x;
}

/// A tangent by dropping the normal's largest component.
Vec3 tangent(const Vec3& n) {
  int smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  return n.cross(Vec3::Unit(smallest)).normalized();
}

struct Round {
  const SplitMass &a, &b;
  Twist &twist_a, &twist_b;
  double change = 0, scale = 0;  // squared, largest of the round

  void apply(const ContactRow& row, const Vec3& impulse) {
    a.push(twist_a, row.r_a, -impulse);
    b.push(twist_b, row.r_b, impulse);
  }
  Vec3 approach(const ContactRow& row) const { return twist_b.at(row.r_b) - twist_a.at(row.r_a); }

  void solve(ContactRow& row, bool frictionless) {
    const Vec3 old = row.impulse();
    const double p_n = std::max(0.0, row.p_n + (row.target - row.normal.dot(approach(row))) * row.inverse_k_n);
    apply(row, (p_n - row.p_n) * row.normal);
    row.p_n = p_n;
    if (!frictionless && row.friction > 0) {
      const Vec3 u = approach(row);
      const Vec3 trial = row.p_t - row.inverse_k_t * (u - row.normal.dot(u) * row.normal);
      const double size = trial.norm(), limit = row.friction * p_n;
      const Vec3 p_t = size > limit ? Vec3(trial * (limit / size)) : trial;
      apply(row, p_t - row.p_t);
      row.p_t = p_t;
    }
    const Vec3 now = row.impulse();
    change = std::max(change, (now - old).squaredNorm());
    scale = std::max({scale, now.squaredNorm(), old.squaredNorm()});
  }
};

}  // namespace

bool set_effective_masses(std::span<ContactRow> rows, const SplitMass& a, const SplitMass& b) {
  bool simple = rows.size() == 1;
  for (ContactRow& row : rows) {
    const Mat3 k = mobility(a, row.r_a) + mobility(b, row.r_b);
    const Vec3 t1 = tangent(row.normal), t2 = row.normal.cross(t1);
    const double k_n = row.normal.dot(k * row.normal);
    const double k11 = t1.dot(k * t1), k22 = t2.dot(k * t2), k12 = t1.dot(k * t2);
    const double half_difference = 0.5 * (k11 - k22);
    const double spread = std::sqrt(half_difference * half_difference + k12 * k12);
    row.inverse_k_n = 1 / k_n;
    row.inverse_k_t = 1 / (0.5 * (k11 + k22) + spread);
    const double mixing = std::max({std::abs(t1.dot(k * row.normal)), std::abs(t2.dot(k * row.normal)), spread});
    simple = simple && mixing <= decoupled * k_n;
  }
  return simple;
}

PairChange solve_pair(std::span<ContactRow> rows, const SplitMass& a, const SplitMass& b, Twist twist_a,
                      Twist twist_b, bool one_round, bool frictionless) {
  constexpr std::size_t usual = 16;  // contacts of a pair of convex bodies; compounds may have more
  Vec3 at_start[usual];
  std::vector<Vec3> many(rows.size() > usual ? rows.size() : 0);
  Vec3* old = many.empty() ? at_start : many.data();
  for (std::size_t k = 0; k < rows.size(); ++k) old[k] = rows[k].impulse();
  for (int i = 0; i < (one_round ? 1 : most_rounds); ++i) {
    Round round{a, b, twist_a, twist_b};
    for (ContactRow& row : rows) round.solve(row, frictionless);
    if (round.change <= converged * converged * round.scale) break;
  }
  PairChange total;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Vec3 now = rows[k].impulse(), change = now - old[k];
    total.impulse += change;
    total.angular_a += rows[k].r_a.cross(change);
    total.angular_b += rows[k].r_b.cross(change);
    total.largest = std::max(total.largest, change.norm());
    total.scale = std::max({total.scale, now.norm(), old[k].norm()});
  }
  return total;
}

}  // namespace silt::rigid
