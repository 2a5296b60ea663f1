#include "adapters/mesh/read_mesh.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "adapters/mesh/obj_triangles.hpp"
#include "adapters/mesh/ply_triangles.hpp"
#include "adapters/stl/foreign_format.hpp"
#include "adapters/stl/stl_triangles.hpp"

namespace silt::adapters {

namespace {

using rigid::Vec3;

constexpr double same_corner = 5e-7;  // of the size: a few roundings to single precision

Soup stl_soup(std::string_view bytes) {
  Soup soup;
  const StlTriangles read = stl_triangles(bytes);
  soup.is_single = read.is_binary;
  for (const Triangle& t : read.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    soup.points.insert(soup.points.end(), t.begin(), t.end());
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

Soup soup_of(std::string_view name, std::string_view bytes) {
  std::string ending(name.substr(std::min(name.rfind('.'), name.size())));
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".stl" && ending != ".obj" && ending != ".ply")
    throw std::invalid_argument("its name must end in .stl, .obj or .ply");
  refuse_foreign(bytes);
  bytes = ending == ".stl" ? bytes : without_mark(bytes);
  if (ending == ".stl") return stl_soup(bytes);
  return ending == ".obj" ? obj_triangles(bytes) : ply_triangles(bytes);
}

double size_of(const std::vector<Vec3>& points) {
  Vec3 lower = points[0], upper = lower;
  for (const Vec3& x : points) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
  return (upper - lower).maxCoeff();
}

/// Of two coordinates in single precision, the largest there are.
double single_step(const std::vector<Vec3>& points) {
  double largest = 0;
  for (const Vec3& x : points) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  const auto single = static_cast<float>(largest);
  return std::nextafter(single, std::numeric_limits<float>::infinity()) - single;
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
  leave_out_unused(soup);
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

}  // namespace silt::adapters
