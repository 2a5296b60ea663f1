#pragma once
// scene.h5: what a picture has to know of a case as it was run, with its overrides and with the files that it
// names as they were read. Layout, numbers in the units of the case:
//   attributes of /: title, length_unit, time_unit, domain_upper [3], gravity [3], sides [6], driven_kinds
//   /walls/0, /walls/1, ...: attributes name, type; of a hollow (tube) also position, axis and its sizes
//   (radius); of a mesh solid, position, orientation, velocity, angular_velocity, amplitude, frequency,
//   phase, and the datasets vertices [V][3], triangles [T][3], table [rows][7]
// scripts/silt_results/scene.py reads it.
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace silt::adapters {

/// SceneWall is one of [[walls]]. Of a mesh the vertices are in the frame of the wall, and its pose at a time
/// t is that of rigid::PrescribedMotion: position + velocity t + amplitude sin(2 pi frequency t + phase) +
/// what the table says, turned by angular_velocity t and by the rotation of the table.
struct SceneWall {
  using Vector = std::array<double, 3>;
  std::string name, type;  // type: of a hollow, "tube", or "mesh"
  Vector position{};
  Vector axis{};                                      // of a hollow
  std::vector<std::pair<std::string, double>> sizes;  // of a hollow
  bool hollow = false;
  std::array<double, 4> orientation{1, 0, 0, 0};
  Vector velocity{}, angular_velocity{}, amplitude{};
  double frequency = 0, phase = 0;
  std::vector<Vector> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
  std::vector<std::array<double, 7>> table;             // time, displacement, rotation vector
};

struct SceneInfo {
  std::string title, length_unit = "cells", time_unit = "steps";
  SceneWall::Vector domain_upper{}, gravity{};
  std::vector<std::string> sides;         // x-low, x-high, y-low, ...
  std::vector<std::string> driven_kinds;  // of bodies that are fixed, or whose motion is given
  std::vector<SceneWall> walls;
};

/// Writes the file under a temporary name and renames it. Throws std::runtime_error naming file and reason.
void write_scene(const std::filesystem::path&, const SceneInfo&);

}  // namespace silt::adapters
