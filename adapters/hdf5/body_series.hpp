#pragma once
// bodies.h5: where every body was at every output time, as a series that may be ragged (the number of bodies
// may change). Layout, T times and R rows in all:
//   /time [T]  /step [T]  /offset [T]  /count [T]     time t has the rows offset[t] .. offset[t] + count[t]
//   /bodies/id [R]  kind [R]  position [R][3]  image [R][3]  orientation [R][4]  velocity [R][3]
//           angular_velocity [R][3]  force [R][3]  torque [R][3]  mass [R]    sorted by id within a time
//   and what BodyColumns says: buoyancy [R][3]; contact_force [R][3]  contact_torque [R][3]; scale [R]
//   /kinds/bounding_radius [K]  density [K]    of the kinds, whose names are the attribute kind_names
//   /kinds/part_kind [P]                       of the convex parts of all kinds, in their order
//   /kinds/vertex_offset [P+1]  vertex [V][3]  part p has the vertices vertex_offset[p] .. vertex_offset[p+1]
//   /kinds/normal_offset [P+1]  normal [N][3]  ... and normals and triangles alike
//   /kinds/triangle_offset [P+1]  triangle [T][3]  triangle_normal [T][3]: vertices and normals of the same
//                                              part, counted from its first
//   /provenance
// The attributes `unit` and `meaning` of a dataset say it again.
// With a constant number n of bodies, position.reshape(T, n, 3) has the time axis first:
// scripts/body_series.py
#include <mpi.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "adapters/hdf5/result_file.hpp"

namespace silt::adapters {

/// TriangleMesh is the closed surface of a piece of a body, in the frame of the body (origin at the
/// centre of mass).
struct TriangleMesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<double, 3>> normals;                 // unit, outward
  std::vector<std::array<std::int32_t, 3>> triangles;         // vertices, counter-clockwise seen from outside
  std::vector<std::array<std::int32_t, 3>> triangle_normals;  // of the surface at the triangles' corners
};

/// BodyKind holds what all bodies of a kind share, in the units of the case.
struct BodyKind {
  std::string name;  // "light spheres"
  double bounding_radius = 0, density = 0;
  std::vector<TriangleMesh> parts;
};

/// BodyRow is one body at one time, in the units of the case.
struct BodyRow {
  std::uint64_t id;
  std::int32_t kind;                  // index into BodySeriesInfo::kinds
  std::array<std::int32_t, 3> image;  // position + image * period is the unwrapped path
  std::array<double, 3> position;     // of the centre of mass, wrapped into the domain
  std::array<double, 4> orientation;  // w, x, y, z; body to world
  std::array<double, 3> velocity, angular_velocity, force,
      torque;  // world frame; torque about the centre of mass
  double mass;
  std::array<double, 3> buoyancy, contact_force, contact_torque;
  double scale = 1;  // its size over that of the surface of its kind
};

/// BodyColumns says which columns a series has besides those that all have.
struct BodyColumns {
  bool buoyancy = false, contacts = false, scale = false;  // contact_force and contact_torque
};

struct BodySeriesInfo {
  std::vector<BodyKind> kinds;
  std::array<double, 3> domain_lower{0, 0, 0}, domain_upper{0, 0, 0};
  // Units of the case, SI: "m", "s", "kg"; lattice: "cells", "steps", "reference masses".
  std::string length = "cells", time = "steps", mass = "reference masses";
  BodyColumns columns;
};

/// BodySeries is the open series, of which a file has one at a time. Every call is collective. The file can
/// be read while the run goes on, and an append comes whole or not at all, whenever the run is killed
/// (journal.hpp; one killed at the very end leaves FILE.journal, which open_for_append and
/// scripts/body_series.py see to). Errors are std::runtime_error on every rank, naming the file and the
/// reason.
class BodySeries {
 public:
  /// Starts an empty series; replaces a file of that name.
  static BodySeries create(MPI_Comm, const std::filesystem::path&, const BodySeriesInfo&, const Provenance&);
  /// Opens a series to continue it: drops what was written after `step` and any unfinished rest. An error
  /// where the file does not have these columns.
  static BodySeries open_for_append(MPI_Comm, const std::filesystem::path&, std::int64_t step,
                                    BodyColumns = {});

  /// Appends one time: row(i) makes the row of the i-th of the n bodies that this rank owns, in any order,
  /// and is asked for it more than once. An id that two ranks hand over is an error. Steps must increase. The
  /// ranks sort slices of the rows, a column at a time, and rank 0 writes them in pieces: it holds no more
  /// than its own slice and a piece.
  void append(std::int64_t step, double time, std::size_t n, const std::function<BodyRow(std::size_t)>& row);

  /// Returns the number of times in the file (rank 0 knows it; 0 elsewhere).
  std::size_t times() const { return times_; }

 private:
  BodySeries(MPI_Comm comm, std::filesystem::path path, BodyColumns with)
      : comm_(comm), path_(std::move(path)), with_(with) {}
  MPI_Comm comm_;
  std::filesystem::path path_;
  BodyColumns with_;
  struct Open;
  std::shared_ptr<Open> open_;  // on rank 0, from the first append on
  std::size_t times_ = 0, rows_ = 0;
  std::int64_t last_step_ = -1;
};

}  // namespace silt::adapters
