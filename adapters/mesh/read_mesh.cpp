#include "adapters/mesh/read_mesh.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <stdexcept>
#include <string>

#include "adapters/mesh/obj_triangles.hpp"
#include "adapters/mesh/ply_triangles.hpp"
#include "adapters/stl/stl_triangles.hpp"

namespace silt::adapters {

namespace {

using rigid::Vec3;

constexpr double same_corner = 5e-7;  // of the size: a few roundings to single precision

Soup stl_soup(std::string_view bytes) {
  Soup soup;
  for (const Triangle& t : stl_triangles(bytes)) {
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
  if (ending == ".stl") return stl_soup(bytes);
  if (ending == ".obj") return obj_triangles(bytes);
  if (ending == ".ply") return ply_triangles(bytes);
  throw std::invalid_argument("its name must end in .stl, .obj or .ply");
}

double size_of(const std::vector<Vec3>& points) {
  Vec3 lower = points[0], upper = lower;
  for (const Vec3& x : points) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
  return (upper - lower).maxCoeff();
}

}  // namespace

ReadMesh read_mesh(std::string_view name, std::string_view bytes, double scale) {
  Soup soup = soup_of(name, bytes);
  ReadMesh read;
  read.triangles = soup.triangles.size();
  if (read.triangles < 4)
    throw std::invalid_argument("it has " + std::to_string(read.triangles) +
                                " triangles; a closed surface has at least 4");
  if (soup.points.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument("it has more than 1431655765 triangles");
  for (Vec3& x : soup.points) x *= scale;
  const double size = size_of(soup.points);
  constexpr double most = 1e100;  // its cube must not overflow
  if (!(size > 1 / most && size < most))
    throw std::invalid_argument("all its corners are the same point, or they are too far apart");
  read.welded = weld(soup, same_corner * size);
  if (soup.triangles.empty()) throw std::invalid_argument("all its triangles shrink to lines");
  read.closed = close(soup, scale);
  read.surface =
      std::make_shared<const rigid::TriangleMesh>(std::move(soup.points), std::move(soup.triangles));
  if (!(read.surface->mass_properties().volume > 0))
    throw std::invalid_argument(
        "its shells cut one another: what they enclose has no volume; take them apart");
  return read;
}

}  // namespace silt::adapters
