#include "rigid/contact_pair.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace silt::rigid {

namespace {

constexpr int most_rounds =
    100;  // few are needed but where a box slides: 40 leave 1e-9 there, 12 let a stack drift
constexpr double converged = 1e-14;      // change of an impulse in a round, relative to the largest
constexpr double converged_push = 1e-6;  // the same where only positions are corrected
constexpr double decoupled = 1e-12;      // mixing of directions, relative to k_n: none

/// The solver's own copy of a pair: velocities at the contacts along their directions.
struct Block {
  std::span<ContactRow> rows;
  const double* matrix;
  double* u;
  std::size_t lines;             // 3 a contact
  double change = 0, scale = 0;  // squared, largest of the round

  void push(std::size_t line, double impulse) {
    const double* column = matrix + line * lines;  // symmetric
    for (std::size_t j = 0; j < lines; ++j) u[j] += column[j] * impulse;
  }

  void solve(std::size_t k, bool frictionless) {
    ContactRow& row = rows[k];
    const std::array<double, 3> old = row.impulse;
    auto& p = row.impulse;
    p[0] = std::max(0.0, p[0] + (row.target - u[3 * k]) * row.inverse_k_n);
    if (p[0] != old[0]) push(3 * k, p[0] - old[0]);
    if (!frictionless && row.friction > 0) {
      p[1] -= row.inverse_k_t * u[3 * k + 1];
      p[2] -= row.inverse_k_t * u[3 * k + 2];
      const double square = p[1] * p[1] + p[2] * p[2], limit = row.friction * p[0];
      if (square > limit * limit) {
        const double shrink = limit / std::sqrt(square);
        p[1] *= shrink, p[2] *= shrink;
      }
      if (p[1] != old[1]) push(3 * k + 1, p[1] - old[1]);
      if (p[2] != old[2]) push(3 * k + 2, p[2] - old[2]);
    }
    double changed = 0, now = 0;
    for (int d = 0; d < 3; ++d) changed += (p[d] - old[d]) * (p[d] - old[d]), now += p[d] * p[d];
    change = std::max(change, changed);
    scale = std::max(scale, now);
  }
};

/// The only contact of a pair whose directions do not mix: each is solved once, without the matrix.
void solve_single(ContactRow& row, const double* u) {
  auto& p = row.impulse;
  p[0] = std::max(0.0, p[0] + (row.target - u[0]) * row.inverse_k_n);
  if (row.friction <= 0) return;
  p[1] -= row.inverse_k_t * u[1];
  p[2] -= row.inverse_k_t * u[2];
  const double square = p[1] * p[1] + p[2] * p[2], limit = row.friction * p[0];
  if (square <= limit * limit) return;
  const double shrink = limit / std::sqrt(square);
  p[1] *= shrink, p[2] *= shrink;
}

void iterate(Block& block, bool frictionless) {
  const double tolerance = frictionless ? converged_push : converged;
  for (int i = 0; i < most_rounds; ++i) {
    block.change = block.scale = 0;
    for (std::size_t k = 0; k < block.rows.size(); ++k) block.solve(k, frictionless);
    if (block.change <= tolerance * tolerance * block.scale) return;
  }
}

}  // namespace

std::array<Vec3, 3> contact_directions(const Vec3& n) {
  int smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  const Vec3 t = n.cross(Vec3::Unit(smallest)).normalized();
  return {n, t, n.cross(t)};
}

bool set_effective_masses(std::span<ContactRow> rows, const SplitMass& a, const SplitMass& b,
                          double* matrix) {
  const std::size_t lines = 3 * rows.size();
  const double inverse_mass = a.inverse_mass + b.inverse_mass;
  for (std::size_t l = 0; l < lines; ++l) {
    const Vec3& d = rows[l / 3].direction[l % 3];
    const Vec3 turn_a = a.inverse_inertia * rows[l / 3].r_a.cross(d),
               turn_b = b.inverse_inertia * rows[l / 3].r_b.cross(d);
    for (std::size_t k = 0; k <= l; ++k) {
      const ContactRow& other = rows[k / 3];
      const Vec3 velocity = inverse_mass * d + turn_a.cross(other.r_a) + turn_b.cross(other.r_b);
      matrix[l * lines + k] = matrix[k * lines + l] = other.direction[k % 3].dot(velocity);
    }
  }
  bool simple = rows.size() == 1;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double* block = matrix + 3 * k * lines + 3 * k;
    const double k_n = block[0], k11 = block[lines + 1], k22 = block[2 * lines + 2], k12 = block[lines + 2];
    const double half_difference = 0.5 * (k11 - k22);
    const double spread = std::sqrt(half_difference * half_difference + k12 * k12);
    rows[k].inverse_k_n = 1 / k_n;
    rows[k].inverse_k_t = 1 / (0.5 * (k11 + k22) + spread);
    simple = simple && std::max({std::abs(block[1]), std::abs(block[2]), spread}) <= decoupled * k_n;
  }
  return simple;
}

PairChange solve_pair(std::span<ContactRow> rows, const double* matrix, const Twist& a, const Twist& b,
                      PairLaw law) {
  constexpr std::size_t usual = 16;  // contacts of a pair of convex bodies; compounds may have more
  double few_u[3 * usual];
  std::array<double, 3> few_old[usual];
  std::vector<double> many_u(rows.size() > usual ? 3 * rows.size() : 0);
  std::vector<std::array<double, 3>> many_old(rows.size() > usual ? rows.size() : 0);
  double* u = rows.size() > usual ? many_u.data() : few_u;
  std::array<double, 3>* old = rows.size() > usual ? many_old.data() : few_old;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Vec3 velocity = b.at(rows[k].r_b) - a.at(rows[k].r_a);
    for (int d = 0; d < 3; ++d) u[3 * k + d] = rows[k].direction[d].dot(velocity);
    old[k] = rows[k].impulse;
  }
  if (law == PairLaw::single) {
    solve_single(rows[0], u);
  } else {
    Block block{rows, matrix, u, 3 * rows.size()};
    iterate(block, law == PairLaw::frictionless);
  }
  PairChange total;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const ContactRow& row = rows[k];
    Vec3 change = Vec3::Zero();
    double changed = 0, before = 0, now = 0;
    for (int d = 0; d < 3; ++d) {
      const double difference = row.impulse[d] - old[k][d];
      change += difference * row.direction[d];
      changed += difference * difference, before += old[k][d] * old[k][d],
          now += row.impulse[d] * row.impulse[d];
    }
    if (changed == 0 && now == 0) continue;
    total.impulse += change;
    total.angular_a += row.r_a.cross(change);
    total.angular_b += row.r_b.cross(change);
    total.largest = std::max(total.largest, changed);
    total.scale = std::max({total.scale, now, before});
  }
  total.largest = std::sqrt(total.largest);
  total.scale = std::sqrt(total.scale);
  return total;
}

}  // namespace silt::rigid
