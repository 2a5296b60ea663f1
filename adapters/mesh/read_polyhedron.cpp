#include "adapters/mesh/read_polyhedron.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "adapters/mesh/read_mesh.hpp"
#include "adapters/qhull/convex_hull.hpp"

namespace silt::adapters {

namespace {

double area_of(const rigid::TriangleMesh& surface) {
  double twice = 0;
  for (std::uint32_t t = 0; t < surface.triangles().size(); ++t) twice += surface.area_normal(t).norm();
  return twice / 2;
}

/// How deep a dent in a flat face may be: what single precision leaves.
double rounding_of(const ReadMesh& read) {
  constexpr double rounding = 2e-7;  // of the size
  const rigid::BoundingBox& box = read.surface->box();
  return std::max(rounding * (box.upper - box.lower).maxCoeff(), read.coordinate_step);
}

}  // namespace

ReadPolyhedron read_polyhedron(std::string_view name, std::string_view bytes, double scale) {
  const ReadMesh read = read_mesh(name, bytes, scale);
  const auto hull = convex_hull(read.surface->vertices()).mesh;
  const double volume = read.surface->mass_properties().volume, whole = rigid::integrals(*hull).volume;
  if (!(std::abs(volume - whole) <= rounding_of(read) * area_of(*read.surface))) {
    char shown[32];
    std::snprintf(shown, sizeof shown, "%.6g", volume / whole);
    throw std::invalid_argument("the surface is not convex: it encloses " + std::string(shown) +
                                " of the volume of its hull; make the shape a mesh, or cut the body into "
                                "convex pieces, one file each, and "
                                "put them together as a compound");
  }
  return {hull, read.coordinate_step};
}

}  // namespace silt::adapters
