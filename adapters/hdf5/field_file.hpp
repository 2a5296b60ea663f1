#pragma once
// Fields as VTKHDF 1.0 image data, one file a time (ParaView, vtkHDFReader, h5py): at cell centres.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "adapters/hdf5/boxes.hpp"
#include "adapters/hdf5/provenance.hpp"

namespace silt::adapters {

/// The lattice in the units of the case. `origin` is the lower corner of cell (0, 0, 0), not its centre.
struct ImageGrid {
  std::array<int, 3> cells;
  std::array<double, 3> origin{0, 0, 0}, spacing{1, 1, 1};
  std::string length_unit = "cells", time_unit = "steps";
};

/// One quantity, in the units of the case. Stored [z][y][x] or [z][y][x][3], as float unless
/// double_precision.
struct FieldQuantity {
  std::string name, unit;
  int components = 1;  // 1 or 3
  /// Writes all cells of one of this rank's boxes: x fastest, components innermost. Called once a box.
  std::function<void(std::size_t box, double* out)> values;
  bool double_precision = false;
};

/// The path FOLDER/fields_000000000100.hdf of a step: names sort like steps.
std::filesystem::path field_path(const std::filesystem::path& folder, std::int64_t step);

/// Writes the file of one time. Collective; a rank without boxes joins with an empty list. Names, units and
/// the number of quantities must be the same on every rank. Cells no rank holds are zero. Also keeps
/// NAME.hdf.series, the list of times next to the file (fields_000100.hdf: fields.hdf.series), in which
/// entries at or after this time are replaced. The file appears under its name only when it is whole. Throws
/// std::runtime_error on every rank, naming the file and the reason (a full disk, a missing folder).
void write_fields(MPI_Comm, const std::filesystem::path&, const ImageGrid&, const std::vector<CellBox>& boxes,
                  const std::vector<FieldQuantity>&, double time, std::int64_t step, const Provenance&);

}  // namespace silt::adapters
