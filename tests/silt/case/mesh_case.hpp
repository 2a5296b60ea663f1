#pragma once
// Cases with walls of triangles whose files are in memory.
#include <map>

#include "silt/case/case_file.hpp"
#include "silt/simulation.hpp"
#include "tests/rigid/shapes/meshes.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::testing {

/// A binary PLY file in double precision.
inline std::string ply_of(const rigid::TriangleMesh& mesh) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertices().size()) +
      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
      std::to_string(mesh.triangles().size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto put = [&](const void* from, std::size_t size) {
    bytes.append(static_cast<const char*>(from), size);
  };
  for (const rigid::Vec3& x : mesh.vertices()) put(x.data(), 3 * sizeof(double));
  for (const auto& t : mesh.triangles()) bytes += '\3', put(t.data(), sizeof t);
  return bytes;
}

using Files = std::map<std::string, std::string>;  // what is in them, by name

inline Case read_with(const CaseText& text, const Files& files, const Overrides& overrides = {}) {
  CaseSource source;
  source.file = "case.toml", source.text = text.text();
  for (const auto& [name, bytes] : files) source.attached[name] = {bytes, name, 0};
  return read_case(source, overrides);
}

/// A case of nothing but fluid and one mesh; `wall`: the other lines of its entry.
inline CaseText mesh_case(const std::string& file, const std::string& wall) {
  CaseText c;
  c.shapes = c.bodies = "";
  c.rest = "[[walls]]\ntype = \"mesh\"\nname = \"mesh\"\nfile = \"" + file + "\"\n" + wall + "\n";
  return c;
}

}  // namespace silt::testing
