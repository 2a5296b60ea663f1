#pragma once
// The wall schemes (wall_formula.hpp) and the forms of the force on a surface, by name.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "lbm/collision/collision_model.hpp"

namespace silt::lbm {

/// `bounce_back`: equation 5 of Goetz et al. with rho_w = 1; the wall is assumed half-way.
/// `cli`: central linear interpolation of Ginzburg, Verhaeghe, d'Humieres 2008.
/// `parabolic`: central, with the curvature of the flow at the wall (method.md, equation 14).
/// `multireflection`: reads one cell further; exact for parabolic flow at any angle (equations 19 and 20).
/// `single_cell_gap`: reads one cell; for links of the others without fluid behind their cell (equations 15
/// and 16). Not for use in cases.
enum class WallScheme : std::uint8_t { bounce_back, cli, parabolic, multireflection, single_cell_gap };
/// The names of schemes that cases may choose, in the order of the enumerators.
inline constexpr std::array<std::string_view, 4> wall_scheme_names = {"bounce-back", "cli", "parabolic",
                                                                      "multireflection"};
static_assert(wall_scheme_names.size() == std::size_t(WallScheme::single_cell_gap), "a scheme has no name");

/// Returns the share of the curvature terms that is kept at low viscosity (method.md, equation 20a).
constexpr double curved_share(const CollisionSpec& collision) {
  constexpr double enough = 0.01;  // tau - 1/2
  return std::min(1.0, collision.excess() * collision.excess() / (enough * enough));
}
/// Returns the stable share of `multireflection` (method.md, 20); the rest is `cli` or `parabolic`.
constexpr double stable_share(const CollisionSpec& collision) {
  constexpr double slope = 1.8;
  return curved_share(collision) *
         std::min(1.0, slope * collision.excess() * collision.excess() / collision.magic_in_effect());
}
/// Returns the share of `parabolic` in that remainder (method.md, equation 20b): `regularised` lowers Lambda
/// and with it the error of `cli` in curved flow.
constexpr double parabolic_share(const CollisionSpec& collision) {
  constexpr double none = 0.02, all = 0.025;  // tau - 1/2
  if (collision.model != Collision::regularised) return 0;
  return (1 - collision.ghosts_as_trt()) * std::clamp((collision.excess() - none) / (all - none), 0.0, 1.0);
}

/// Returns the Lambda that gives the best drag of spheres (measurements.md, "Wall schemes").
constexpr double best_magic(WallScheme scheme, double tau) {
  if (scheme == WallScheme::parabolic) return 1.0 / 16;
  if (scheme != WallScheme::multireflection) return 1.0 / 6;
  return 1.0 / 6 - stable_share({tau, 2.0 / 15}) / 30;
}

/// Returns whether the formula reads f*_opp(x) and f*_i(x - c_i).
constexpr bool reads_behind(WallScheme scheme) {
  return scheme == WallScheme::cli || scheme == WallScheme::parabolic ||
         scheme == WallScheme::multireflection;
}
/// Returns whether links of the scheme have wall distances, which may change after they were built.
constexpr bool follows_distance(WallScheme scheme) {
  return scheme != WallScheme::bounce_back;
}
/// Returns whether links in gaps of one cell use the wall on the other side (method.md, equation 16).
constexpr bool knows_opposite_wall(WallScheme scheme) {
  return scheme == WallScheme::parabolic || scheme == WallScheme::multireflection;
}
/// Returns whether the formula also reads f*_opp(x - c_i) and f*_i(x - 2 c_i).
constexpr bool reads_beyond(WallScheme scheme) {
  return scheme == WallScheme::multireflection;
}
/// Returns the number of cells from its own that a link may read or write.
constexpr int link_reach(WallScheme scheme) {
  return reads_beyond(scheme) ? 2 : 1;
}
/// Returns the scheme of a link whose cell behind is fluid and whose cell beyond that is solid.
constexpr WallScheme two_cell_gap_scheme(WallScheme scheme) {
  return reads_beyond(scheme) ? WallScheme::cli : scheme;
}

/// `galilean`: F = sum c (f* + f_opp) - u_w (f* - f_opp) over cut links (Wen et al. 2014). `exact`: the first
/// term alone (equation 6 of Goetz et al.); the momentum of cells that change sides is then added.
enum class ForceForm : std::uint8_t { galilean, exact };
inline constexpr std::array<std::string_view, 2> force_form_names = {"galilean", "exact"};

}  // namespace silt::lbm
