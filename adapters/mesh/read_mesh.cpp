#include "adapters/mesh/read_mesh.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "adapters/qhull/convex_hull.hpp"

namespace silt::adapters {

namespace {

using rigid::Vec3;

constexpr double same_corner = 5e-7;  // relative to the size: some roundings of single precision

Soup soup_of(std::string_view name, std::string_view bytes) {
  std::string ending(name.substr(std::min(name.rfind('.'), name.size())));
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  if (ending != ".stl" && ending != ".obj" && ending != ".ply")
    throw std::invalid_argument("its name must end in .stl, .obj or .ply");
  refuse_foreign(bytes);
  if (ending == ".stl") return stl_triangles(bytes);
  bytes = without_mark(bytes);
  return ending == ".obj" ? obj_triangles(bytes) : ply_triangles(bytes);
}

double size_of(const std::vector<Vec3>& points) {
  Vec3 lower = points[0], upper = lower;
  for (const Vec3& x : points) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
  return (upper - lower).maxCoeff();
}

/// Returns the spacing of numbers in single precision at the largest coordinate.
double single_step(const std::vector<Vec3>& points) {
  double largest = 0;
  for (const Vec3& x : points) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  const auto single = float(largest);
  return std::nextafter(single, std::numeric_limits<float>::infinity()) - single;
}

double area_of(const rigid::TriangleMesh& surface) {
  double twice = 0;
  for (std::uint32_t t = 0; t < surface.triangles().size(); ++t) twice += surface.area_normal(t).norm();
  return twice / 2;
}

/// Returns the depth of dents in flat faces that single precision may cause.
double rounding_of(const ReadMesh& read) {
  constexpr double rounding = 2e-7;  // relative to the size
  const rigid::BoundingBox& box = read.surface->box();
  return std::max(rounding * (box.upper - box.lower).maxCoeff(), read.coordinate_step);
}

}  // namespace

ReadMesh read_mesh(std::string_view name, std::string_view bytes, double scale) {
  Soup soup = soup_of(name, bytes);
  ReadMesh read;
  read.triangles = soup.triangles.size();
  if (read.triangles < 4)
    throw std::invalid_argument("it has " + std::to_string(read.triangles) + " triangles" +
                                (read.triangles > 0    ? ""
                                 : soup.points.empty() ? " and no points"
                                                       : " (but points)") +
                                "; a closed surface has at least 4");
  if (soup.points.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument("it has more than 1431655765 triangles");
  remove_unused(soup);
  if (soup.is_single) read.coordinate_step = scale * single_step(soup.points);
  for (Vec3& x : soup.points) x *= scale;
  const double size = size_of(soup.points);
  constexpr double most = 1e100;  // its cube must not overflow
  if (!(size > 1 / most && size < most))
    throw std::invalid_argument("all its corners are the same point, or they are too far apart");
  read.welded = weld(soup, same_corner * size);
  if (soup.triangles.empty())
    throw std::invalid_argument(
        "all its triangles shrink to lines, or lie back to back: they enclose nothing");
  read.closed = close(soup, scale);
  read.surface =
      std::make_shared<const rigid::TriangleMesh>(std::move(soup.points), std::move(soup.triangles));
  if (!(read.surface->mass_properties().volume > 0))
    throw std::invalid_argument(
        "its shells cut one another: what they enclose has no volume; take them apart");
  return read;
}

ReadPolyhedron read_polyhedron(std::string_view name, std::string_view bytes, double scale) {
  const ReadMesh read = read_mesh(name, bytes, scale);
  const auto hull = convex_hull(read.surface->vertices()).mesh;
  const double volume = read.surface->mass_properties().volume, whole = rigid::integrals(*hull).volume;
  if (!(std::abs(volume - whole) <= rounding_of(read) * area_of(*read.surface))) {
    char shown[32];
    std::snprintf(shown, sizeof shown, "%.6g", volume / whole);
    throw std::invalid_argument("the surface is not convex: it encloses " + std::string(shown) +
                                " of the volume of its hull; make the shape a mesh, or cut the body into "
                                "convex pieces, one file each, and put them together as a compound");
  }
  return {hull, read.coordinate_step};
}

}  // namespace silt::adapters
