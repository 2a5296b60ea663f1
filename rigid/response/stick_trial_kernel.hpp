#pragma once
// The stick trial: assumes that every contact of a pair that presses sticks, as in piles at rest. The
// impulses then follow from one linear system for the pair's relative motion, however many contacts share the
// load, where Gauss-Seidel needs many rounds (close contacts, long levers). Only for *_kernel.cpp.
//
// The system is (C6) of method.md: J_k maps the relative motion (u, omega at a's centre) to the velocity at
// contact k, G is the mobility, e_k the velocity to be removed, s the softness.
#include "rigid/response/lanes_kernel.hpp"

namespace silt::rigid::SILT_BUILD {
namespace {

constexpr std::uint32_t most_stick_contacts = 16;  // of a pair; with more, Gauss-Seidel solves it
constexpr int stick_passes = 2;                    // each reduces the error by the softness
constexpr double stick_residual =
    1e-7;  // relative to the velocity to be removed; a larger one refutes the trial

/// Eight pairs: relative velocity of b at a's centre, and sums of impulses and moments about it on b.
struct PairMotion {
  Vector u, omega;
  Vector impulse{}, angular{};

  PairMotion(const BlockGroup& g, const Twist& a, const Twist& b)
      : u(b.v + cross(b.w, load(g.offset)) - a.v - load(g.together)), omega(b.w - a.w) {}

  Vector at(const Vector& r) const { return u + cross(omega, r); }

  /// Applies an impulse at r.
  void push(const BlockGroup& g, const Vector& r, const Vector& p) { push_about_a(g, p, cross(r, p)); }
  /// Applies an impulse, or a sum of them, with its moment about a's centre.
  void push_about_a(const BlockGroup& g, const Vector& p, const Vector& about_a) {
    const Vector d = load(g.offset);
    const Vector turn_b = times(g.inverse_inertia_b, about_a + cross(d, p));
    omega += turn_b + times(g.inverse_inertia_a, about_a);
    u += Vector{p.x * g.inverse_mass[0], p.y * g.inverse_mass[1], p.z * g.inverse_mass[2]} + cross(turn_b, d);
    impulse += p;
    angular += about_a;
  }
};

inline PairMotion choose(Mask m, const PairMotion& a, const PairMotion& b) {
  PairMotion c = b;
  c.u = choose(m, a.u, b.u);
  c.omega = choose(m, a.omega, b.omega);
  c.impulse = choose(m, a.impulse, b.impulse);
  c.angular = choose(m, a.angular, b.angular);
  return c;
}

/// Returns the index of element (i, j) of a symmetric 6 x 6 matrix in its 21 numbers.
constexpr int packed(int i, int j) {
  return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
}

/// Factorises in place: M = L D L^T, with 1 / D on the diagonal (that of L is 1). Unlike Cholesky it takes no
/// square roots, whose latency would add to that of the quotients.
inline void factorise(Numbers* m) {
#pragma GCC unroll 6
  for (int j = 0; j < 6; ++j) {
    const Numbers inverse = 1 / m[packed(j, j)];
#pragma GCC unroll 6
    for (int i = 5; i > j; --i) {
      const Numbers l = m[packed(i, j)] * inverse;
#pragma GCC unroll 6
      for (int k = j + 1; k <= i; ++k) m[packed(i, k)] -= l * m[packed(k, j)];
      m[packed(i, j)] = l;
    }
    m[packed(j, j)] = inverse;
  }
}

/// Replaces x by the solution.
inline void solve_factorised(const Numbers* m, Numbers* x) {
#pragma GCC unroll 6
  for (int i = 1; i < 6; ++i)
#pragma GCC unroll 6
    for (int k = 0; k < i; ++k) x[i] -= m[packed(i, k)] * x[k];
#pragma GCC unroll 6
  for (int i = 5; i >= 0; --i) {
    x[i] *= m[packed(i, i)];
#pragma GCC unroll 6
    for (int k = i + 1; k < 6; ++k) x[i] -= m[packed(k, i)] * x[k];
  }
}

/// Sets the inverse of the mobility of b relative to a at a's centre, times the softness. The mobility's
/// columns are the motions by unit impulses and unit moments.
inline void set_inverse_mobility(BlockGroup& g) {
  Numbers m[21], zero{}, one = zero + 1;
  const Vector d = load(g.offset);
  const Vector unit[3] = {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  for (int j = 0; j < 3; ++j) {
    Vector turn = times(g.inverse_inertia_b, cross(d, unit[j]));
    const Vector shift = cross(turn, d) + unit[j] * g.inverse_mass[j];
    const Vector both = times(g.inverse_inertia_b, unit[j]) + times(g.inverse_inertia_a, unit[j]);
    const Numbers by_force[6] = {shift.x, shift.y, shift.z, turn.x, turn.y, turn.z};
    const Numbers by_moment[3] = {both.x, both.y, both.z};
    for (int i = j; i < 6; ++i) m[packed(i, j)] = by_force[i];
    for (int i = j; i < 3; ++i) m[packed(3 + i, 3 + j)] = by_moment[i];
    // rows i >= 3 of by_force fill the whole lower left block
  }
  factorise(m);
  for (int column = 0; column < 6; ++column) {
    Numbers x[6] = {};
    x[column] = g.softness;
    solve_factorised(m, x);
    for (int i = column; i < 6; ++i) g.inverse_mobility[packed(i, column)] = x[i];
  }
}

/// Adds the contribution of a contact to J^T J. Without friction J has one row, that of the normal.
template <bool frictionless>
void add_stiffness(const BlockContact& c, Mask on, Numbers* m) {
  const Vector r = choose(on, load(c.r), Vector{});
  if constexpr (frictionless) {
    const Vector n = choose(on, load(c.normal), Vector{}), turn = cross(r, n);
    const Numbers j[6] = {n.x, n.y, n.z, turn.x, turn.y, turn.z};
    for (int i = 0; i < 6; ++i)
      for (int k = 0; k <= i; ++k) m[packed(i, k)] += j[i] * j[k];
  } else {
    const Numbers one = choose(on, Numbers{} + 1, Numbers{});
    for (int i = 0; i < 3; ++i) m[packed(i, i)] += one;
    m[packed(3, 1)] -= r.z;
    m[packed(3, 2)] += r.y;
    m[packed(4, 0)] += r.z;
    m[packed(4, 2)] -= r.x;
    m[packed(5, 0)] -= r.y;
    m[packed(5, 1)] += r.x;
    m[packed(3, 3)] += r.y * r.y + r.z * r.z;
    m[packed(4, 4)] += r.x * r.x + r.z * r.z;
    m[packed(5, 5)] += r.x * r.x + r.y * r.y;
    m[packed(4, 3)] -= r.x * r.y;
    m[packed(5, 3)] -= r.x * r.z;
    m[packed(5, 4)] -= r.y * r.z;
  }
}

template <bool frictionless>
struct StickTrial {
  const BlockGroup& g;
  BlockContact* contacts;
  PairMotion motion;
  // of the contacts; set by start
  Mask on[most_stick_contacts];
  Numbers normal[most_stick_contacts];
  Vector tangential[most_stick_contacts];
  Vector excess[most_stick_contacts];
  Numbers factor[21];

  StickTrial(const BlockGroup& group, BlockContact* of_group, const PairMotion& now)
      : g(group), contacts(of_group), motion(now) {}

  /// Sets e_k, the velocity to be removed at each contact, zero if open. Returns the largest square.
  Numbers find_excess() {
    Numbers most{};
    for (std::uint32_t k = 0; k < g.count; ++k) {
      const BlockContact& c = contacts[k];
      const Vector n = load(c.normal), w = motion.at(load(c.r));
      excess[k] = choose(on[k], frictionless ? n * (dot(w, n) - c.target) : w - n * c.target, Vector{});
      most = larger(most, dot(excess[k], excess[k]));
    }
    return most;
  }

  /// Determines the contacts that press, and factorises the matrix.
  void start() {
    for (int i = 0; i < 21; ++i) factor[i] = g.inverse_mobility[i];
    for (std::uint32_t k = 0; k < g.count; ++k) {
      const BlockContact& c = contacts[k];
      normal[k] = c.normal_impulse;
      tangential[k] = load(c.tangential_impulse);
      on[k] = (normal[k] > 0) | (dot(motion.at(load(c.r)), load(c.normal)) < c.target);
      add_stiffness<frictionless>(c, on[k], factor);
    }
    factorise(factor);
  }

  /// Solves for the current excess and applies the result.
  void pass() {
    Numbers x[6] = {};
    for (std::uint32_t k = 0; k < g.count; ++k) {
      const Vector &e = excess[k], turn = cross(load(contacts[k].r), e);
      x[0] -= e.x;
      x[1] -= e.y;
      x[2] -= e.z;
      x[3] -= turn.x;
      x[4] -= turn.y;
      x[5] -= turn.z;
    }
    solve_factorised(factor, x);
    const Vector shift{x[0], x[1], x[2]}, turn{x[3], x[4], x[5]};
    const Numbers scale = -1 / Numbers(g.softness);
    Vector impulse{}, moment{};
    for (std::uint32_t k = 0; k < g.count; ++k) {
      const Vector r = load(contacts[k].r), n = load(contacts[k].normal);
      const Vector taken = choose(on[k], excess[k] + shift + cross(turn, r), Vector{});
      const Numbers along = scale * dot(taken, n);
      const Vector across = frictionless ? Vector{} : taken * scale - n * along, p = n * along + across;
      normal[k] += along;
      tangential[k] += across;
      impulse += p;
      moment += cross(r, p);
    }
    motion.push_about_a(g, impulse, moment);
  }

  /// Returns the lanes in which no contact pulls, slides or opens too slowly. scale: largest squared impulse.
  Mask is_right(Numbers& scale) const {
    Mask right = scale == scale;
    for (std::uint32_t k = 0; k < g.count; ++k) {
      const BlockContact& c = contacts[k];
      const Numbers square = dot(tangential[k], tangential[k]), limit = c.friction * normal[k];
      const Mask presses = (normal[k] >= 0) & (square <= limit * limit);
      const Mask stays_open = dot(motion.at(load(c.r)), load(c.normal)) >= c.target;
      right = right & choose(on[k], presses, stays_open);
      scale = larger(scale, normal[k] * normal[k] + square);
    }
    return right;
  }
};

/// Accepts the trial in the active lanes where it is right, and deactivates these. Pairs that are final after
/// this sweep are left to the exact solution.
template <bool frictionless>
void try_sticking(const BlockGroup& g, BlockContact* contacts, PairMotion& motion, Mask& active,
                  Numbers& scale) {
  if (g.count > most_stick_contacts) return;
  StickTrial<frictionless> trial(g, contacts, motion);
  trial.start();
  const Numbers before = trial.find_excess();
  Numbers after = before;
  for (int i = 0; i < stick_passes; ++i) trial.pass(), after = trial.find_excess();
  Numbers largest{};
  const Mask right = active & trial.is_right(largest) & needs_sweeps(g.bodies) &
                     (after <= stick_residual * stick_residual * before);
  for (std::uint32_t k = 0; k < g.count; ++k) {
    BlockContact& c = contacts[k];
    c.normal_impulse = choose(right, trial.normal[k], c.normal_impulse);
    store(c.tangential_impulse, choose(right, trial.tangential[k], load(c.tangential_impulse)));
  }
  motion = choose(right, trial.motion, motion);
  scale = choose(right, largest, scale);
  active = active & ~right;
}

}  // namespace
}  // namespace silt::rigid::SILT_BUILD
