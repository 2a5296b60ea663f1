#pragma once
// Fields as VTKHDF 1.0, one file for each time (ParaView, vtkHDFReader, h5py): image data at cell centres, or
// overlapping AMR where cells have several widths.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "adapters/hdf5/result_file.hpp"

namespace silt::adapters {

/// The lattice in the units of the case. origin: the lower corner of cell (0, 0, 0).
struct ImageGrid {
  std::array<int, 3> cells;
  std::array<double, 3> origin{0, 0, 0}, spacing{1, 1, 1};
  std::string length_unit = "cells", time_unit = "steps";
};

/// A quantity in the units of the case, stored [z][y][x] or [z][y][x][3].
struct FieldQuantity {
  std::string name, unit;
  int components = 1;  // 1 or 3
  /// Writes planes [first, last) of one of this rank's boxes, from its lowest, x fastest after components.
  std::function<void(std::size_t box, int first, int last, double* out)> values;
  Storage storage = Storage::single;
};

/// FieldPlan lists the steps at which a series has files: the multiples of `every`, and the last step.
struct FieldPlan {
  std::int64_t every = 0, last_step = 0;  // every = 0: the file is of no series
  double time_step = 0;
};

/// FieldSnapshot is the content of one file: quantities on the lattice at one time.
struct FieldSnapshot {
  ImageGrid grid;
  std::vector<FieldQuantity> quantities;
  double time = 0;  // in the grid's time unit
  std::int64_t step = 0;
  FieldPlan plan = {};
};

/// The cells of one width. Boxes count such cells from the grid's origin. Levels do not overlap.
struct FieldLevel {
  int width;  // in cells of the grid, 2^level
  std::vector<CellBox> boxes;
  std::vector<FieldQuantity> quantities;
};

/// Writes a snapshot, each rank the values of its boxes. Collective; a rank without boxes joins with an empty
/// list. Names, units and the number of quantities must be the same on every rank. Cells that no rank holds
/// are zero. Also updates NAME.hdf.series, the list of times next to the file (fields_000100.hdf:
/// fields.hdf.series), in which it replaces entries at or after this time, and, for a series with a plan,
/// fields.vtkhdf, which shows all its files over time. The file gets its name only when it is complete.
/// Throws std::runtime_error on every rank, naming the file and the reason.
void write_fields(MPI_Comm, const std::filesystem::path&, const std::vector<CellBox>& boxes,
                  const FieldSnapshot&, const Provenance&);
/// Writes levels instead, the finest first: all but the quantities of the snapshot. They have no
/// fields.vtkhdf. Levels without a cell on any rank are omitted, since VTK's reader fails on them. The file
/// has the boxes of the ranks.
void write_fields(MPI_Comm, const std::filesystem::path&, const std::vector<FieldLevel>& levels,
                  const FieldSnapshot&, const Provenance&);

}  // namespace silt::adapters
