#pragma once
// The guess that comes true in piles at rest: every contact of a pair that presses sticks. Then the impulses
// follow from one linear system for the pair's relative motion, however many contacts share the load, where
// Gauss-Seidel needs many rounds (contacts close to one another, long levers). Only for *_kernel.cpp.
//
// (C6) of rigid/README.md. With J_k the map from relative motion (u, omega at a's centre) to the velocity at
// contact k, G the mobility and e_k the velocity to be taken away: (J G J^T + s) dp = -e. The softness s
// shares the load evenly where the contacts are more than needed; by Woodbury it takes a 6 x 6 system,
//   (s G^-1 + J^T J) x = -J^T e,   dp = -(e + J x) / s.
#include "rigid/response/pair_motion_kernel.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

constexpr std::uint32_t most_stick_contacts = 16;  // of a pair; more are left to Gauss-Seidel
constexpr int stick_passes = 2;                    // each leaves the softness' share of the error
constexpr double stick_residual = 1e-7;  // of the velocity to be taken away: else the guess is wrong

/// Where element (i, j) of a symmetric 6 x 6 matrix stands among its 21.
constexpr int packed(int i, int j) {
  return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
}

/// In place: M = L D L^T, with 1 / D on the diagonal (that of L is 1). Without roots, for which a column
/// would wait as long again as for its quotient.
inline void factorise(Lanes* m) {
#pragma GCC unroll 6
  for (int j = 0; j < 6; ++j) {
    const Lanes inverse = 1 / m[packed(j, j)];
#pragma GCC unroll 6
    for (int i = 5; i > j; --i) {
      const Lanes l = m[packed(i, j)] * inverse;
#pragma GCC unroll 6
      for (int k = j + 1; k <= i; ++k) m[packed(i, k)] -= l * m[packed(k, j)];
      m[packed(i, j)] = l;
    }
    m[packed(j, j)] = inverse;
  }
}

/// x becomes the solution.
inline void solve_factorised(const Lanes* m, Lanes* x) {
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

/// softness x the inverse of the mobility of b seen from a, at a's centre: its columns are what unit impulses
/// and unit moments do.
inline void set_inverse_mobility(BlockGroup& g) {
  Lanes m[21], zero{}, one = zero + 1;
  const Vector d = load(g.offset);
  const Vector unit[3] = {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  for (int j = 0; j < 3; ++j) {
    Vector turn = times(g.inverse_inertia_b, cross(d, unit[j]));
    const Vector shift = cross(turn, d) + unit[j] * g.inverse_mass;
    const Vector both = times(g.inverse_inertia_b, unit[j]) + times(g.inverse_inertia_a, unit[j]);
    const Lanes by_force[6] = {shift.x, shift.y, shift.z, turn.x, turn.y, turn.z};
    const Lanes by_moment[3] = {both.x, both.y, both.z};
    for (int i = j; i < 6; ++i) m[packed(i, j)] = by_force[i];
    for (int i = j; i < 3; ++i) m[packed(3 + i, 3 + j)] = by_moment[i];
    // i >= 3 of by_force covers all nine of the lower left block
  }
  factorise(m);
  for (int column = 0; column < 6; ++column) {
    Lanes x[6] = {};
    x[column] = g.softness;
    solve_factorised(m, x);
    for (int i = column; i < 6; ++i) g.inverse_mobility[packed(i, column)] = x[i];
  }
}

/// Adds one contact's part of J^T J. Without friction J has one row, the normal's.
template <bool frictionless>
void add_stiffness(const BlockContact& c, Mask on, Lanes* m) {
  const Vector r = choose(on, load(c.r), Vector{});
  if constexpr (frictionless) {
    const Vector n = choose(on, load(c.normal), Vector{}), turn = cross(r, n);
    const Lanes j[6] = {n.x, n.y, n.z, turn.x, turn.y, turn.z};
    for (int i = 0; i < 6; ++i)
      for (int k = 0; k <= i; ++k) m[packed(i, k)] += j[i] * j[k];
  } else {
    const Lanes one = choose(on, Lanes{} + 1, Lanes{});
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
  Lanes normal[most_stick_contacts];
  Vector tangential[most_stick_contacts];
  Vector excess[most_stick_contacts];
  Lanes factor[21];

  StickTrial(const BlockGroup& group, BlockContact* of_group, const PairMotion& now)
      : g(group), contacts(of_group), motion(now) {}

  /// Sets e_k, what the velocity at a contact is to lose: zero where it does not press. Returns the largest
  /// square.
  Lanes find_excess() {
    Lanes most{};
    for (std::uint32_t k = 0; k < g.count; ++k) {
      const BlockContact& c = contacts[k];
      const Vector n = load(c.normal), w = motion.at(load(c.r));
      excess[k] = choose(on[k], frictionless ? n * (dot(w, n) - c.target) : w - n * c.target, Vector{});
      most = larger(most, dot(excess[k], excess[k]));
    }
    return most;
  }

  /// Which contacts press, and the matrix.
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

  /// From the excess there is.
  void pass() {
    Lanes x[6] = {};
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
    const Lanes scale = -1 / g.softness;
    Vector impulse{}, moment{};
    for (std::uint32_t k = 0; k < g.count; ++k) {
      const Vector r = load(contacts[k].r), n = load(contacts[k].normal);
      const Vector taken = choose(on[k], excess[k] + shift + cross(turn, r), Vector{});
      const Lanes along = scale * dot(taken, n);
      const Vector across = frictionless ? Vector{} : taken * scale - n * along, p = n * along + across;
      normal[k] += along;
      tangential[k] += across;
      impulse += p;
      moment += cross(r, p);
    }
    motion.push_about_a(g, impulse, moment);
  }

  /// Lanes where no contact pulls, slides, or is passed through. scale: largest squared impulse.
  Mask is_right(Lanes& scale) const {
    Mask right = scale == scale;
    for (std::uint32_t k = 0; k < g.count; ++k) {
      const BlockContact& c = contacts[k];
      const Lanes square = dot(tangential[k], tangential[k]), limit = c.friction * normal[k];
      const Mask presses = (normal[k] >= 0) & (square <= limit * limit);
      const Mask stays_open = dot(motion.at(load(c.r)), load(c.normal)) >= c.target;
      right = right & choose(on[k], presses, stays_open);
      scale = larger(scale, normal[k] * normal[k] + square);
    }
    return right;
  }
};

/// The active lanes where the guess is right take its impulses and are active no longer. Leaves alone what is
/// final after this sweep: that is solved exactly.
template <bool frictionless>
void try_sticking(const BlockGroup& g, BlockContact* contacts, PairMotion& motion, Mask& active,
                  Lanes& scale) {
  if (g.count > most_stick_contacts) return;
  StickTrial<frictionless> trial(g, contacts, motion);
  trial.start();
  const Lanes before = trial.find_excess();
  Lanes after = before;
  for (int i = 0; i < stick_passes; ++i) trial.pass(), after = trial.find_excess();
  Lanes largest{};
  const Mask right = active & trial.is_right(largest) & goes_on(g.bodies) &
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
}  // namespace silt::rigid::SILT_ISA
