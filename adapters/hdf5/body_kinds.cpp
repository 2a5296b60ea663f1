#include "adapters/hdf5/body_kinds.hpp"

#include "adapters/hdf5/file.hpp"

namespace silt::adapters {
namespace {

using hdf5::File;
using hdf5::Handle;

/// Meshes holds the meshes of all parts, one after the other.
struct Meshes {
  std::vector<std::int32_t> part_kind;
  std::vector<std::array<double, 3>> vertex, normal;
  std::vector<std::array<std::int32_t, 3>> triangle, triangle_normal;
  std::vector<std::int64_t> vertex_offset{0}, normal_offset{0}, triangle_offset{0};

  explicit Meshes(std::span<const BodyKind> kinds) {
    for (std::size_t k = 0; k < kinds.size(); ++k)
      for (const TriangleMesh& part : kinds[k].parts) {
        part_kind.push_back(static_cast<std::int32_t>(k));
        add(part);
      }
  }

 private:
  void add(const TriangleMesh& part) {
    const auto append = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
    append(vertex, part.vertices);
    append(normal, part.normals);
    append(triangle, part.triangles);
    append(triangle_normal, part.triangle_normals);
    vertex_offset.push_back(static_cast<std::int64_t>(vertex.size()));
    normal_offset.push_back(static_cast<std::int64_t>(normal.size()));
    triangle_offset.push_back(static_cast<std::int64_t>(triangle.size()));
  }
};

/// Dataset describes a dataset of /kinds: the types of its numbers in memory and in the file, and their
/// meaning.
struct Dataset {
  const char* name;
  hid_t memory_type, file_type;
  hsize_t columns;
  std::string unit, meaning;
};

void write(File& file, const Dataset& d, const void* data, hsize_t rows) {
  const auto shape = d.columns > 1 ? std::vector<hsize_t>{rows, d.columns} : std::vector<hsize_t>{rows};
  const Handle handle = file.create_contiguous(std::string("/kinds/") + d.name, d.file_type, shape);
  if (!d.unit.empty()) file.attribute(handle, "unit", d.unit);
  file.attribute(handle, "meaning", d.meaning);
  if (rows > 0)
    file.check(H5Dwrite(handle, d.memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
               "cannot write the kinds");
}

/// Describes lengths or directions, which are for pictures: single precision is enough.
Dataset vectors(const char* name, const std::string& unit, const char* meaning) {
  return {name, H5T_NATIVE_DOUBLE, H5T_IEEE_F32LE, 3, unit, meaning};
}
Dataset corners(const char* name, const char* meaning) {
  return {name, H5T_NATIVE_INT32, H5T_STD_I32LE, 3, "", meaning};
}
Dataset offsets(const char* name, const char* meaning) {
  return {name, H5T_NATIVE_INT64, H5T_STD_I64LE, 1, "", meaning};
}

void write_meshes(File& file, const Meshes& m, const std::string& length_unit) {
  write(file, {"part_kind", H5T_NATIVE_INT32, H5T_STD_I32LE, 1, "", "kind that each convex part belongs to"},
        m.part_kind.data(), m.part_kind.size());
  write(file,
        vectors("vertex", length_unit,
                "vertices of the parts' surfaces in the frame of the body, origin at its centre of mass"),
        m.vertex.data(), m.vertex.size());
  write(file, vectors("normal", "1", "outward unit normals of the surfaces, in the frame of the body"),
        m.normal.data(), m.normal.size());
  write(file,
        corners(
            "triangle",
            "vertices of each triangle, counted from the part's first, counter-clockwise seen from outside"),
        m.triangle.data(), m.triangle.size());
  write(file,
        corners("triangle_normal", "normals at the corners of each triangle, counted from the part's first"),
        m.triangle_normal.data(), m.triangle_normal.size());
  write(file,
        offsets("vertex_offset", "part p has the vertices vertex_offset[p] to vertex_offset[p + 1] - 1"),
        m.vertex_offset.data(), m.vertex_offset.size());
  write(file, offsets("normal_offset", "part p has the normals normal_offset[p] to normal_offset[p + 1] - 1"),
        m.normal_offset.data(), m.normal_offset.size());
  write(
      file,
      offsets("triangle_offset", "part p has the triangles triangle_offset[p] to triangle_offset[p + 1] - 1"),
      m.triangle_offset.data(), m.triangle_offset.size());
}

}  // namespace

void write_kinds(File& file, std::span<const BodyKind> kinds, const std::string& length_unit,
                 const std::string& density_unit) {
  const Handle group = file.group("/kinds", true);
  const Handle bodies = file.group("/bodies", false);
  std::vector<std::string> names;
  std::vector<double> radii, densities;
  for (const BodyKind& kind : kinds) {
    names.push_back(kind.name);
    radii.push_back(kind.bounding_radius);
    densities.push_back(kind.density);
  }
  if (!names.empty()) {
    file.attribute(group, "kind_names", names);
    file.attribute(bodies, "kind_names", names);
  }
  write(file,
        {"bounding_radius", H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, 1, length_unit,
         "largest distance of a point of the body from its centre of mass"},
        radii.data(), radii.size());
  write(file, {"density", H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, 1, density_unit, "mass over volume"},
        densities.data(), densities.size());
  write_meshes(file, Meshes(kinds), length_unit);
}

std::uint64_t mesh_bytes(std::span<const BodyKind> kinds) {
  std::uint64_t bytes = 0;
  for (const BodyKind& kind : kinds)
    for (const TriangleMesh& part : kind.parts)
      bytes += 12 * (part.vertices.size() + part.normals.size()) + 24 * part.triangles.size() + 28;
  return bytes;
}

}  // namespace silt::adapters
