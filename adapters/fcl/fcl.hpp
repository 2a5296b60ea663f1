#pragma once
// "fcl": the Flexible Collision Library with libccd.
#include "adapters/common/engine_backend.hpp"
#include "rigid/collision/broad_phase.hpp"

namespace silt::adapters {

std::unique_ptr<rigid::CollisionBackend> make_fcl_backend();
/// FCL's dynamic tree of boxes.
std::unique_ptr<rigid::BroadPhase> make_fcl_broad_phase();

/// A BVHModel of oriented boxes, with FCL's nodes and overlap test but its own traversal: FCL's traversal
/// calls libccd for each triangle, which misses touching triangles. OBBRSS would serve distances only and
/// double the memory (some 300 bytes per triangle as it is).
std::unique_ptr<MeshTree> make_fcl_tree(const SharedMesh&);

}  // namespace silt::adapters
