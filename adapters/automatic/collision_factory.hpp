#pragma once
// Collision backends and broad phases by name: all that is seen of the engines from outside adapters/.
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

/// Returns the message about a backend that this build was configured without; "" for any other name.
std::string left_out_of_this_build(std::string_view name);

/// Makes a backend. "auto" is the best answer pair by pair, "analytic" closed forms, "bullet" and "fcl" that
/// engine for every pair. Throws std::invalid_argument that lists the known names for any other name, and
/// std::runtime_error for an engine other than the one built against. One object serves one thread.
std::unique_ptr<rigid::CollisionBackend> make_backend(std::string_view name);

/// Makes a broad phase; throws likewise. "grid" is uniform grids, "bullet" and "fcl" are that engine's tree;
/// "auto" is the tree of that backend if it has one, otherwise the grid. All give the same pairs, bitwise.
std::unique_ptr<rigid::BroadPhase> make_broad_phase(std::string_view name, std::string_view backend = "auto");

}  // namespace silt::adapters
