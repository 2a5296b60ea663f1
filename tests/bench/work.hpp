#pragma once
// What the hot passes have to do: operations (additions, multiplications, divisions; a maximum, a choice or a
// rounding is none) and bytes, counted by hand in lbm/*_kernel.cpp, each expression once. The coefficients of
// a wall scheme are counted by running them (Counted). Bytes are those that the pass must read and write even
// if all else stays in cache: the least, not what the machine moves.
#include "lbm/blocks/lattice.hpp"
#include "lbm/walls/wall_formula.hpp"

namespace silt::bench {

/// The operations of a cell of the dense pass, two relaxation times, without a force and with one (a body
/// force). The compiled loop of the 256-bit build has as many.
inline constexpr double flops_per_cell = 141, flops_per_cell_with_force = 158;
template <class T>
inline constexpr double bytes_per_cell = 2 * lbm::D3Q19::directions * sizeof(T);

/// A number that counts what is done with it.
struct Counted {
  double x = 0;
  static inline int operations = 0;
  constexpr Counted() = default;
  constexpr Counted(double value) : x(value) {}
  friend Counted operator+(Counted a, Counted b) { return ++operations, a.x + b.x; }
  friend Counted operator-(Counted a, Counted b) { return ++operations, a.x - b.x; }
  friend Counted operator-(Counted a) { return ++operations, -a.x; }
  friend Counted operator*(Counted a, Counted b) { return ++operations, a.x * b.x; }
  friend Counted operator/(Counted a, Counted b) { return ++operations, a.x / b.x; }
  friend constexpr bool operator<(Counted a, Counted b) { return a.x < b.x; }
  friend constexpr bool operator>(Counted a, Counted b) { return a.x > b.x; }
  friend constexpr bool operator<=(Counted a, Counted b) { return a.x <= b.x; }
};

template <lbm::WallScheme scheme>
int operations_of_coefficients() {
  const lbm::WallFluid<Counted> fluid(
      lbm::CollisionSpec{1.2, lbm::best_magic(scheme, 1.2), lbm::Collision::trt, {}});
  Counted::operations = 0;
  lbm::coefficients<scheme>(Counted(0.4), Counted(1.0 / 3), fluid);
  return Counted::operations;
}

struct LinkWork {
  double flops, bytes;
};
/// Returns the work of a cut link in a step: what comes back, the excess, force and torque; with implicit
/// coupling also the correction. (The resistance is part of the object mapping.)
inline LinkWork link_work(std::string_view scheme, bool implicit, std::size_t bytes_of_a_population) {
  using enum lbm::WallScheme;
  const bool behind = scheme != "bounce-back", beyond = scheme == "multireflection";
  const double coefficients = beyond                  ? operations_of_coefficients<multireflection>()
                              : scheme == "cli"       ? operations_of_coefficients<cli>()
                              : scheme == "parabolic" ? operations_of_coefficients<parabolic>()
                                                      : operations_of_coefficients<bounce_back>();
  constexpr double arm = 2, velocity = 12, along = 5, weight = 5, back = 3, from_behind = 15, exchange = 12,
                   torque = 9, sums = 6, in_range = 1, change = 2, excess = 8;
  const double entry = 4 + double(bytes_of_a_population), value = double(bytes_of_a_population);
  LinkWork work{arm + velocity + along + weight + coefficients + back + (behind ? from_behind : 0) +
                    exchange + torque + sums + in_range + excess,
                entry + (beyond   ? 6
                         : behind ? 4
                                  : 2) *
                            value};
  if (implicit) {
    work.flops += arm + velocity + along + weight + coefficients + change + excess;
    work.bytes += entry + 2 * value;
  }
  return work;
}

}  // namespace silt::bench
