#pragma once
// Private to adapters/hdf5: NAME.vtkhdf, which shows files of many times as one to readers of VTKHDF 2.0. It
// has no values of its own: its arrays are HDF5's virtual datasets, made of those of the files beside it.
//
//   fields.vtkhdf  VTKHDF/PointData/velocity  --  rows of /pages/velocity/0, 128, ...  --  fields_STEP.hdf
//   bodies.vtkhdf  VTKHDF/PointData/velocity  --  bodies.h5, bodies_STEP.h5
//
// Such a file never changes: a new file with more times replaces it, so that a run may be killed at any
// moment and readers always find lists as long as NSteps. There is no file for fewer than two times, because
// VTK would read it as a file without times. Only rank 0 calls these functions.
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "adapters/hdf5/file.hpp"
#include "adapters/hdf5/table.hpp"

namespace silt::adapters::hdf5 {

/// ImageArray is an array of an image at one time.
struct ImageArray {
  std::string name, unit;
  hid_t type;
  Shape shape;
};

/// ImageTimes is what NAME.vtkhdf shows of the files NAME_STEP.hdf.
struct ImageTimes {
  std::vector<ImageArray> arrays;
  std::array<double, 3> origin;  // files with another one, or with other arrays, are left out
  std::int64_t every, last;      // files to come: of the multiples of `every` before the last step, and of it
  double time_step;
  std::function<void(File&, hid_t group)> write_grid;
};

/// Adds a step whose file exists. Removes steps at and after it, which the run had written before it was
/// resumed.
void add_image(const Path& folder, const std::string& name, std::int64_t step, const ImageTimes&);

/// TimeRow is a time of a series of bodies, the first of its rows and their number.
struct TimeRow {
  double time;
  std::int64_t step;
  std::uint64_t offset, count;
};

/// BodyFile is a file of a series of bodies, and its times.
struct BodyFile {
  std::string name;
  std::vector<TimeRow> times;
};

/// Rewrites the file for a series of these columns. With fewer than two times it only removes an existing
/// file.
void write_bodies_over_time(const Path&, const std::vector<Column>&, const std::vector<BodyFile>&);

}  // namespace silt::adapters::hdf5
