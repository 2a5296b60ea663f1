#pragma once
// The part of check_case that looks at walls of triangles.
#include "coupler/case/body_check.hpp"
#include "coupler/case/boundary_spec.hpp"

namespace silt::coupler {

/// The path of a wall's key, walls[i].key.
std::string wall_key(std::size_t wall, const char* key);

/// Refuses a mesh that is not in the domain, crosses a periodic border as a vessel, or moves too fast; warns
/// of one with features that the cells do not resolve.
void find_mesh_faults(const Case&, Findings&, std::size_t wall);

}  // namespace silt::coupler
