#pragma once
// Makes collision backends and broad phases by name; the only interface to the engines outside adapters/.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "rigid/collision/broad_phase.hpp"
#include "rigid/collision/collision_backend.hpp"

namespace silt::adapters {

/// Return the names that make_backend and make_broad_phase know in this build, the default ("auto") first.
std::vector<std::string_view> backend_names();
std::vector<std::string_view> broad_phase_names();

/// Returns a message if the name is that of a backend not in this build; otherwise "".
std::string missing_from_build(std::string_view name);

/// Makes a backend: "auto" (the best method for each pair), "analytic" (closed forms), or "bullet" or "fcl"
/// (that engine for every pair). Throws std::invalid_argument with the known names for any other name, and
/// std::runtime_error for an engine other than the one built against. An object serves one thread.
std::unique_ptr<rigid::CollisionBackend> make_backend(std::string_view name);

/// Makes a broad phase: "grid" (uniform grids), "bullet" or "fcl" (that engine's tree), "auto" (the backend's
/// tree if it has one, otherwise the grid). All give bitwise the same pairs. Throws as above.
std::unique_ptr<rigid::BroadPhase> make_broad_phase(std::string_view name, std::string_view backend = "auto");

}  // namespace silt::adapters
