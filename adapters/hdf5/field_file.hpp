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

/// FieldPlan says of which steps a series has files: of the multiples of `every`, and of the last one.
struct FieldPlan {
  std::int64_t every = 0, last_step = 0;  // every = 0: the file is of no series
  double time_step = 0;
};

/// FieldSnapshot is what one file holds: quantities on the lattice at one time.
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
/// list. Names, units and the number of quantities must be the same on every rank. Cells no rank holds are
/// zero. Also keeps NAME.hdf.series, the list of times next to the file (fields_000100.hdf:
/// fields.hdf.series), in which entries at or after this time are replaced, and, of a series with
/// a plan, fields.vtkhdf, which shows all its files over time. The file appears under its name only when it
/// is whole. Throws std::runtime_error on every rank, naming the file and the reason.
void write_fields(MPI_Comm, const std::filesystem::path&, const std::vector<CellBox>& boxes,
                  const FieldSnapshot&, const Provenance&);
/// Writes levels instead, the finest first: all but the quantities of the snapshot. They have no
/// fields.vtkhdf. Levels without a cell on any rank are left out: VTK's reader of them fails. Boxes lie in
/// the file as the ranks have them.
void write_fields(MPI_Comm, const std::filesystem::path&, const std::vector<FieldLevel>& levels,
                  const FieldSnapshot&, const Provenance&);

}  // namespace silt::adapters
