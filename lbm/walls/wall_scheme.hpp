#pragma once
// The wall schemes (wall_formula.hpp) and the forms of the force on a surface, by name.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "lbm/collision/collision_model.hpp"

namespace silt::lbm {

/// `bounce_back` is equation 5 of Goetz et al. with rho_w = 1: the surface is taken to be half-way.
/// `cli` is the central linear interpolation of Ginzburg, Verhaeghe, d'Humieres 2008.
/// `parabolic` is central too, with the curvature of the flow at the wall (method.md, equation 14).
/// `multireflection` reads one cell further and holds the parabola in flow at any angle (method.md, equations
/// 19 and 20).
/// `single_cell_gap` reads the cell alone: for links of the others whose cell behind is not fluid (method.md,
/// equations 15 and 16); no case can choose it.
enum class WallScheme : std::uint8_t { bounce_back, cli, parabolic, multireflection, single_cell_gap };
/// The schemes that a case can choose, in the order of the enumerators.
inline constexpr std::array<std::string_view, 4> wall_scheme_names = {"bounce-back", "cli", "parabolic",
                                                                      "multireflection"};
static_assert(wall_scheme_names.size() == std::size_t(WallScheme::single_cell_gap), "a scheme has no name");

/// The share of a scheme beyond linear interpolation that is left at low viscosity (method.md, equation 20a).
constexpr double curved_share(const CollisionSpec& collision) {
  constexpr double enough = 0.01;  // tau - 1/2
  return std::min(1.0, collision.excess() * collision.excess() / (enough * enough));
}
/// The part of `multireflection` that does not amplify (method.md, equation 20); the rest is `cli` or
/// `parabolic`.
constexpr double stable_share(const CollisionSpec& collision) {
  constexpr double slope = 1.8;
  return curved_share(collision) *
         std::min(1.0, slope * collision.excess() * collision.excess() / collision.magic_in_effect());
}
/// How much of that rest is `parabolic` (method.md, equation 20b): `regularised` lowers Lambda, and with it
/// what `cli` makes of the curvature of the flow.
constexpr double parabolic_share(const CollisionSpec& collision) {
  constexpr double none = 0.02, all = 0.025;  // tau - 1/2
  if (collision.model != Collision::regularised) return 0;
  return (1 - collision.ghosts_as_trt()) * std::clamp((collision.excess() - none) / (all - none), 0.0, 1.0);
}

/// The Lambda with the best drag of spheres at a relaxation time (measurements.md, "Wall schemes").
constexpr double best_magic(WallScheme scheme, double tau) {
  if (scheme == WallScheme::parabolic) return 1.0 / 16;
  if (scheme != WallScheme::multireflection) return 1.0 / 6;
  return 1.0 / 6 - stable_share({tau, 2.0 / 15}) / 30;
}

/// Returns whether the formula reads f*_opp(x) and f*_i(x - c_i) at all.
constexpr bool reads_behind(WallScheme scheme) {
  return scheme == WallScheme::cli || scheme == WallScheme::parabolic ||
         scheme == WallScheme::multireflection;
}
/// Returns whether links of the scheme have a distance, which may be changed after they were built.
constexpr bool follows_distance(WallScheme scheme) {
  return scheme != WallScheme::bounce_back;
}
/// Returns whether links of a single-cell gap know the surface on its other side (method.md, equation 16).
constexpr bool knows_opposite_wall(WallScheme scheme) {
  return scheme == WallScheme::parabolic || scheme == WallScheme::multireflection;
}
/// Returns whether the formula reads f*_opp(x - c_i) and f*_i(x - 2 c_i) too.
constexpr bool reads_beyond(WallScheme scheme) {
  return scheme == WallScheme::multireflection;
}
/// How many cells from its own a link may read or write.
constexpr int link_reach(WallScheme scheme) {
  return reads_beyond(scheme) ? 2 : 1;
}
/// The scheme of a link whose cell behind is fluid and the one beyond that is not.
constexpr WallScheme two_cell_gap_scheme(WallScheme scheme) {
  return reads_beyond(scheme) ? WallScheme::cli : scheme;
}

/// `galilean` is the form of Wen et al. 2014, F = sum c (f* + f_opp) - u_w (f* - f_opp), over cut links.
/// `exact` is its first term alone (equation 6 of Goetz et al.): the momentum of cells that change sides has
/// to be handed over as well.
enum class ForceForm : std::uint8_t { galilean, exact };
inline constexpr std::array<std::string_view, 2> force_form_names = {"galilean", "exact"};

}  // namespace silt::lbm
