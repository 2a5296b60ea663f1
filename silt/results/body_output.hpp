#pragma once
// Writes the files for visualisation: scene.h5, and the time series of the bodies, bodies.h5.
#include <filesystem>
#include <vector>

#include "adapters/hdf5/body_series.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// Writes scene.h5: sides, gravity, walls and driven kinds of a case. Throws std::runtime_error.
void write_scene_file(const Case&, const std::filesystem::path& folder);

/// Returns the kinds of bodies of a case with their surfaces, as bodies.h5 stores them.
std::vector<adapters::BodyKind> drawn_kinds(const Case&);

/// Writes bodies.h5, in units of the case.
class BodyOutput {
 public:
  /// Starts a series in the folder, or, if `resumed`, continues it at the simulation's step. Collective.
  BodyOutput(const Simulation&, const std::filesystem::path& folder, const adapters::Provenance&,
             bool resumed);
  /// Appends the present bodies with forces and torques of the last step. Collective.
  void append(const Simulation&);
  /// Makes bodies.vtkhdf show all times, at the end of a run. Collective.
  void finish() { series_.show_all_times(); }

 private:
  std::filesystem::path path_;
  adapters::BodySeries series_;
};

/// Returns a closed triangle mesh of a part's surface in the frame of its body, lengths times `unit`, found
/// from the support function of its shape. It lies inside the surface, with a gap below
/// `tessellation_tolerance` times the local half width; corners, edges and flat faces are exact; faces of
/// polyhedra are cut into triangles. Throws std::invalid_argument for an unbounded part (a half-space).
adapters::TriangleMesh tessellation(const rigid::Part&, double unit);

/// Returns the triangles of a mesh, each with its own normal, lengths times `unit`.
adapters::TriangleMesh tessellation(const rigid::TriangleMesh&, double unit);

/// Largest gap between a curved surface and its mesh, relative to half the shape's width along the normal or,
/// if smaller, to the middle one of its half extents.
inline constexpr double tessellation_tolerance = 0.006;

}  // namespace silt
