#pragma once
// The forms of the momentum exchange between the fluid and a surface.
#include <array>
#include <cstdint>
#include <string_view>

namespace silt::lbm {

/// `galilean` is the form of Wen et al. 2014, F = sum c (f* + f_opp) - u_w (f* - f_opp), over cut links.
/// `exact` is its first term alone (equation 6 of Goetz et al.): the momentum of cells that change sides has
/// to be handed over as well.
enum class ForceForm : std::uint8_t { galilean, exact };
inline constexpr std::array<std::string_view, 2> force_form_names = {"galilean", "exact"};

}  // namespace silt::lbm
