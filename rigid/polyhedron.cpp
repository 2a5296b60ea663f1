#include "rigid/polyhedron.hpp"

#include <stdexcept>

namespace silt::rigid {

std::shared_ptr<const PolyhedronMesh> make_polyhedron_mesh(std::vector<Vec3>,
                                                           const std::vector<std::vector<int>>&, double) {
  throw std::logic_error("not there yet");
}

std::shared_ptr<const PolyhedronMesh> shifted(const PolyhedronMesh&, const Vec3&) {
  throw std::logic_error("not there yet");
}

}  // namespace silt::rigid
