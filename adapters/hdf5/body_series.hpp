#pragma once
// bodies.h5: all bodies at every output time; their number may change. When a file is full, bodies_STEP.h5
// continues it from STEP on, without /kinds and /provenance. Rows are sorted by time, then id.
// cases/OUTPUT.md and the attributes `unit` and `meaning` of the datasets describe the layout.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/hdf5/result_file.hpp"

namespace silt::adapters {

/// The closed surface of a part of a body, about the body's centre of mass.
struct TriangleMesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<double, 3>> normals;                 // unit, outward
  std::vector<std::array<std::int32_t, 3>> triangles;         // vertices, counter-clockwise seen from outside
  std::vector<std::array<std::int32_t, 3>> triangle_normals;  // indices of normals at the triangles' corners
};

/// Data common to all bodies of a kind, in the units of the case.
struct BodyKind {
  std::string name;  // "light spheres"
  double bounding_radius = 0, density = 0;
  std::vector<TriangleMesh> parts;
};

/// A force and a torque about the centre of mass; world frame.
struct Wrench {
  std::array<double, 3> force, torque;
};

/// A body at one time, in the units of the case.
struct BodyRow {
  std::uint64_t id;
  std::int32_t kind;                  // index into BodySeriesInfo::kinds
  std::array<std::int32_t, 3> image;  // position + image * period is the unwrapped path
  std::array<double, 3> position;     // of the centre of mass, wrapped into the domain
  std::array<double, 4> orientation;  // w, x, y, z; body to world
  std::array<double, 3> velocity, angular_velocity, buoyancy;  // world frame
  Wrench load, contacts, springs;                              // load: of the fluid, and added by a program
  double mass;
  double scale = 1;  // size relative to the surface of its kind
};

/// Selects optional columns of a series.
struct BodyColumns {
  bool buoyancy = false, contacts = false, scale = false, springs = false;  // force and torque of these two
};

struct BodySeriesInfo {
  std::vector<BodyKind> kinds;
  std::array<double, 3> domain_lower{0, 0, 0}, domain_upper{0, 0, 0};
  // The names of the units of the case.
  std::string length = "m", time = "s", mass = "kg", density = "kg/m3", force = "N", torque = "N m";
  BodyColumns columns;
};

/// Returns the existing files of a series in their order, bodies.h5 first.
std::vector<std::filesystem::path> body_series_files(const std::filesystem::path& first);

/// BodySeries is the open series. Every call is collective. The files can be read during the run. A reader
/// sees an append as a whole or not at all, even if the run is killed: a file gets its name with its first
/// time and has space for all rows it will hold, so an append writes the rows and then changes only the
/// lengths of the columns in their headers; a time is valid once every column reaches it. Each file has twice
/// the space of the one before, within bounds: N rows take fewer than 10 + N / 2^20 files unless one time has
/// more. bodies.vtkhdf, which shows all files to VTK (over_time.hpp), is rewritten with each of the first
/// times, and later whenever it lacks a 64th of all times. Errors are std::runtime_error on every rank,
/// naming the file and the reason.
class BodySeries {
 public:
  /// Starts a series and removes an existing one; with `after`, continues an existing one after that step and
  /// removes later steps. Throws if its columns differ.
  BodySeries(MPI_Comm, const std::filesystem::path& first, BodySeriesInfo, Provenance,
             std::optional<std::int64_t> after = {});

  /// Appends one time: row(i) returns the i-th of the n bodies that this rank owns, in any order, and is
  /// called more than once for each. The same id on two ranks is an error. Steps must increase. The ranks
  /// sort slices of the rows, column by column; rank 0 writes them, with one slice and one piece in memory.
  void append(std::int64_t step, double time, std::size_t n, const std::function<BodyRow(std::size_t)>& row);

  /// Makes bodies.vtkhdf show all times, at the end of a run.
  void show_all_times();

  /// Returns the step of the last time, -1 if there is none (known on rank 0).
  std::int64_t last_step() const { return last_step_; }

 private:
  struct Open;
  void write_over_time();
  std::shared_ptr<Open> begin_file(const Open* last, std::int64_t step, std::uint64_t rows) const;
  MPI_Comm comm_;
  std::filesystem::path path_;
  BodySeriesInfo info_;
  Provenance provenance_;
  std::shared_ptr<Open> open_;  // on rank 0, between two appends
  std::int64_t last_step_ = -1;
  std::size_t times_ = 0, times_shown_ = 0;  // of all files, of bodies.vtkhdf (on rank 0)
};

}  // namespace silt::adapters
