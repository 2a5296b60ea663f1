#pragma once
// "bullet": Bullet in double precision.
#include "adapters/common/engine_backend.hpp"
#include "rigid/collision/broad_phase.hpp"

namespace silt::adapters {

/// All throw std::runtime_error if the Bullet found at run time does not compute in double precision.
void check_bullet_precision();
std::unique_ptr<rigid::CollisionBackend> make_bullet_backend();
/// The dynamic tree of boxes of Bullet's btDbvtBroadphase.
std::unique_ptr<rigid::BroadPhase> make_bullet_broad_phase();

/// A btBvhTriangleMeshShape. Bullet rounds boxes outward to 2^-16 of the mesh's box. For two meshes each
/// triangle of the smaller one queries the tree of the larger.
std::unique_ptr<MeshTree> make_bullet_tree(const SharedMesh&);

}  // namespace silt::adapters
