#pragma once
// "fcl": the Flexible Collision Library with libccd.
#include "adapters/common/engine_backend.hpp"
#include "rigid/collision/broad_phase.hpp"

namespace silt::adapters {

std::unique_ptr<rigid::CollisionBackend> make_fcl_backend();
/// FCL's dynamic tree of boxes.
std::unique_ptr<rigid::BroadPhase> make_fcl_broad_phase();

/// A BVHModel of oriented boxes. Its nodes and their test of overlap are FCL's, the walk down the tree is
/// not: FCL's own ends at each triangle in libccd, which loses triangles that touch. OBBRSS serve distances
/// only and take twice the memory, some 300 bytes a triangle as it is.
std::unique_ptr<MeshTree> make_fcl_tree(const SharedMesh&);

}  // namespace silt::adapters
