#pragma once
// The makers of the engines that this build has (SILT_WITH_BULLET, SILT_WITH_FCL of CMake); nullptr for one
// that it was configured without.
#include <memory>
#include <string>
#include <string_view>

#include "rigid/collision/broad_phase.hpp"
#include "rigid/collision/collision_backend.hpp"
#ifdef SILT_WITH_BULLET
#include "adapters/bullet/bullet_backend.hpp"
#include "adapters/bullet/bullet_broad_phase.hpp"
#endif
#ifdef SILT_WITH_FCL
#include "adapters/fcl/fcl_backend.hpp"
#include "adapters/fcl/fcl_broad_phase.hpp"
#endif

namespace silt::adapters::engines {

using MakeBackend = std::unique_ptr<rigid::CollisionBackend> (*)();
using MakeBroadPhase = std::unique_ptr<rigid::BroadPhase> (*)();

#ifdef SILT_WITH_BULLET
inline constexpr MakeBackend bullet_backend = make_bullet_backend;
inline constexpr MakeBroadPhase bullet_broad_phase = make_bullet_broad_phase;
#else
inline constexpr MakeBackend bullet_backend = nullptr;
inline constexpr MakeBroadPhase bullet_broad_phase = nullptr;
#endif
#ifdef SILT_WITH_FCL
inline constexpr MakeBackend fcl_backend = make_fcl_backend;
inline constexpr MakeBroadPhase fcl_broad_phase = make_fcl_broad_phase;
#else
inline constexpr MakeBackend fcl_backend = nullptr;
inline constexpr MakeBroadPhase fcl_broad_phase = nullptr;
#endif

/// Returns "this build of silt has no fcl (SILT_WITH_FCL is OFF): ..." for an engine left out.
std::string left_out_text(std::string_view name);

}  // namespace silt::adapters::engines
