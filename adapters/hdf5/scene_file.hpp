#pragma once
// scene.h5: the parts of a case, with its overrides and files, that pictures show, in the units of the case.
// cases/OUTPUT.md has the layout; scripts/silt_results/scene.py reads it.
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace silt::adapters {

/// A group of the file: the scene, or a wall, which has a surface if it is a mesh.
struct SceneGroup {
  using Value = std::variant<std::string, std::vector<std::string>, double, std::vector<double>>;
  std::vector<std::pair<std::string, Value>> attributes;
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
  std::vector<std::array<double, 7>> table;             // time, displacement, rotation vector
};

/// Writes the file under a temporary name and renames it. Throws std::runtime_error with file and reason.
void write_scene(const std::filesystem::path&, const SceneGroup& scene, const std::vector<SceneGroup>& walls);

}  // namespace silt::adapters
