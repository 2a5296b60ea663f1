#pragma once
// Broad phases by name.
#include <memory>
#include <string_view>
#include <vector>

#include "rigid/collision/broad_phase.hpp"

namespace silt::adapters {

/// The names make_broad_phase knows, the default ("auto") first.
std::vector<std::string_view> broad_phase_names();

/// Makes a broad phase. "grid" is uniform grids, "bullet" and "fcl" are that engine's tree; "auto" is the
/// tree of the backend of that name if it has one, otherwise the grid. All give the same pairs to the bit.
/// Throws std::invalid_argument that lists the known names for any other name, and std::runtime_error where
/// the engine found at run time is not the one built against. One object serves one thread.
std::unique_ptr<rigid::BroadPhase> make_broad_phase(std::string_view name, std::string_view backend = "auto");

}  // namespace silt::adapters
