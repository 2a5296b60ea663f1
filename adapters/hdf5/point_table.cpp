#include "adapters/hdf5/point_table.hpp"

#include "adapters/hdf5/file.hpp"

namespace silt::adapters {
namespace {

using hdf5::File;
using hdf5::Handle;

/// Opens a dataset of points and sets their number.
Handle open_points(const File& file, const std::string& name, std::uint64_t& rows) {
  Handle data = file.dataset(name);
  const H5T_class_t kind = H5Tget_class(file.type(data));
  const bool of_numbers = kind == H5T_FLOAT || kind == H5T_INTEGER;
  const auto shape = file.shape(data);
  std::string text;
  for (const hsize_t n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
  if (!of_numbers || shape.size() != 2 || shape[1] != 3)
    file.refuse("dataset " + name + " is " + (text.empty() ? "a single value" : text) +
                (of_numbers ? "" : ", not of numbers") + "; it must be n x 3 numbers, a point a row");
  rows = shape[0];
  return data;
}

}  // namespace

std::uint64_t count_points(const std::filesystem::path& path, const std::string& dataset) {
  std::uint64_t rows = 0;
  const File file = File::open(path, false);
  open_points(file, dataset, rows);
  return rows;
}

std::vector<double> read_points(const std::filesystem::path& path, const std::string& dataset,
                                std::uint64_t first, std::uint64_t n) {
  std::uint64_t rows = 0;
  std::vector<double> points(3 * n);
  const File file = File::open(path, false);
  const Handle data = open_points(file, dataset, rows);
  if (first + n > rows)
    file.refuse("dataset " + dataset + " has " + std::to_string(rows) +
                " points now, fewer than when it was first looked at");
  if (n == 0) return points;
  const hsize_t start[2] = {first, 0}, count[2] = {n, 3};
  const Handle space(H5Dget_space(data), H5Sclose, path, "shape of " + dataset);
  file.check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr),
             "cannot select rows");
  const Handle memory(H5Screate_simple(2, count, nullptr), H5Sclose, path, "memory shape");
  file.check(H5Dread(data, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, points.data()),
             "cannot read dataset " + dataset + " (truncated?)");
  return points;
}

}  // namespace silt::adapters
