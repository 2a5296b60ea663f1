#include "adapters/hdf5/over_time.hpp"

#include <algorithm>
#include <numeric>

namespace silt::adapters::hdf5 {
namespace {

const std::string steps_group = "/VTKHDF/Steps/", point_data = "/VTKHDF/PointData/",
                  point_offsets = "/VTKHDF/Steps/PointDataOffsets/";

/// Begins a file of so many times.
File start_file(const Path& path, const std::string& type, std::size_t n) {
  File file = File::create(path, Format::classic);
  const Handle vtk = file.create_group("/VTKHDF"), steps = file.create_group(steps_group);
  const std::int64_t version[2] = {2, 0};
  file.attribute(vtk, "Version", H5T_NATIVE_INT64, {2}, version);
  file.attribute(vtk, "Type", type);
  file.number(steps, "NSteps", std::int64_t(n));
  file.create_group(point_data);
  file.create_group(point_offsets);
  return file;
}

std::vector<std::int64_t> numbers_from(std::int64_t first, std::size_t n) {
  std::vector<std::int64_t> numbers(n);
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

/// Puts a file that write(its path) makes in the place of another. It does not wait for the disk: if the
/// machine fails, a run that goes on writes the file anew.
template <class Write>
void replace(const Path& path, Write&& write) {
  TemporaryFile part(path.string() + ".part", true);
  write(part.path()).close();
  std::filesystem::rename(part.path(), path);
}

// ---- images ----

constexpr std::size_t page = 128;        // HDF5 takes long for many parts of a virtual dataset
constexpr std::size_t least_room = 256;  // times, those to come included

/// Returns whether a file, of one time or over time, has the grid and the arrays, and over time no others.
bool shows(const File& file, const ImageTimes& images, bool over_time) {
  const Handle vtk = file.group("/VTKHDF"), data = file.group(point_data);
  const Handle attribute(H5Aopen(vtk, "Origin", H5P_DEFAULT), H5Aclose, file.path(), "has no origin");
  std::array<double, 3> origin{};
  file.check(H5Aread(attribute, H5T_NATIVE_DOUBLE, origin.data()), "cannot read the origin");
  H5G_info_t info;
  file.check(H5Gget_info(data, &info), "cannot count the arrays");
  if (origin != images.origin || (over_time && info.nlinks != images.arrays.size())) return false;
  return std::all_of(images.arrays.begin(), images.arrays.end(), [&](const ImageArray& array) {
    if (!file.exists(point_data + array.name)) return false;
    const Handle dataset = file.dataset(point_data + array.name);
    Shape shape = file.shape(dataset);
    if (over_time) shape.erase(shape.begin());
    return shape == array.shape && H5Tequal(file.type(dataset), array.type) > 0;
  });
}

bool is_of(const Path& path, const ImageTimes& images) {
  try {
    return shows(File::open(path, false), images, false);
  } catch (const Error&) {
    return false;
  }
}

/// Makes the first of the foreseen steps, now n of them, those that the file has. Readers copy all of Values
/// to a list of NSteps numbers, so both must change at once: do this before the file gets its name.
void write_times(File& file, const std::vector<std::int64_t>& steps, std::size_t n, double time_step) {
  const Handle values = file.dataset(steps_group + "Values");
  const hsize_t size = n;
  std::vector<double> times;
  for (std::size_t k = 0; k < n; ++k) times.push_back(double(steps[k]) * time_step);
  file.check(H5Dset_extent(values, &size), "cannot resize the list of times");
  file.check(H5Dwrite(values, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, times.data()),
             "cannot write the times (is the disk full?)");
  file.overwrite(file.group(steps_group), "NSteps", std::int64_t(n));
}

/// Adds a step to a copy of a file that has foreseen it, which takes its place. Returns whether it could.
bool add_to_copy(const Path& path, std::int64_t step, const ImageTimes& images) {
  if (!std::filesystem::exists(path)) return false;
  try {
    TemporaryFile part(path.string() + ".part", true);
    std::filesystem::copy_file(path, part.path(), std::filesystem::copy_options::overwrite_existing);
    File file = File::open(part.path(), true);
    if (!shows(file, images, true)) return false;
    const Handle group = file.group(steps_group), data = file.dataset("/step");
    std::vector<std::int64_t> steps(file.shape(data)[0]);
    file.check(H5Dread(data, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, steps.data()),
               "cannot read the steps");
    const auto n = std::find(steps.begin(), steps.end(), step) - steps.begin();
    if (n == 0 || n == std::ssize(steps) || n > file.number_in<std::int64_t>(group, "NSteps")) return false;
    write_times(file, steps, n + 1, images.time_step);
    file.close();
    std::filesystem::rename(part.path(), path);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

/// Creates an array over time: a virtual dataset of pages, which are virtual datasets of files.
void create_array(File& file, const std::string& name, const ImageArray& array,
                  const std::vector<std::int64_t>& steps) {
  const std::string pages = "/pages/" + array.name + "/";
  file.create_group(pages);
  const auto shape_of = [&](std::size_t times) {
    Shape shape = array.shape;
    shape.insert(shape.begin(), times);
    return shape;
  };
  std::vector<VirtualRows> all;
  for (std::size_t first = 0; first < steps.size(); first += page) {
    const std::size_t n = std::min(page, steps.size() - first);
    std::vector<VirtualRows> rows;
    for (std::size_t k = 0; k < n; ++k)
      rows.push_back(
          {k, 1, step_path("", name, steps[first + k], ".hdf"), point_data + array.name, array.shape});
    all.push_back({first, n, ".", pages + std::to_string(first), shape_of(n)});
    file.create_virtual(all.back().dataset, array.type, shape_of(n), rows);
  }
  const Handle data = file.create_virtual(point_data + array.name, array.type, shape_of(steps.size()), all);
  file.attribute(data, "unit", array.unit);
}

}  // namespace

void add_image(const Path& folder, const std::string& name, std::int64_t step, const ImageTimes& images) {
  const Path path = folder / (name + ".vtkhdf");
  if (add_to_copy(path, step, images)) return;
  std::vector<std::int64_t> steps{step};
  for (const StepFile& file : step_files(folder, name, ".hdf"))
    if (file.step < step && is_of(file.path, images)) steps.push_back(file.step);
  std::reverse(steps.begin(), steps.end());
  const std::size_t n = steps.size(), room = std::max(least_room, 2 * n);
  if (n < 2) {
    std::filesystem::remove(path);
    return;
  }
  for (step += images.every - step % images.every; step < images.last && steps.size() + 1 < room;
       step += images.every)
    steps.push_back(step);
  if (steps.back() < images.last) steps.push_back(std::min(step, images.last));
  replace(path, [&](const Path& part) {
    File file = start_file(part, "ImageData", n);
    file.create_dataset(steps_group + "Values", H5T_IEEE_F64LE, {n}, {{steps.size()}, true});
    write_times(file, steps, n, images.time_step);
    images.write_grid(file, file.group("/VTKHDF"));
    file.write_list("/step", H5T_STD_I64LE, steps);
    file.write_list("/offset", H5T_STD_I64LE, numbers_from(0, steps.size()));
    file.create_group("/pages");
    for (const ImageArray& array : images.arrays) {
      create_array(file, name, array, steps);
      file.link("/offset", point_offsets + array.name);
    }
    return file;
  });
}

// ---- bodies ----

namespace {

/// Makes each body a vertex, at most `most` of them at a time, of `rows` in all. All times share one list of
/// numbers. Where a time's begin in Offsets VTK counts from its cell offset on, one more for each part
/// before: some versions for all, later ones for those before the first whose cells reach the offset. So
/// offsets are larger than the number of all cells, and lead to the same place in either way.
void write_vertices(File& file, std::size_t times, std::size_t most, std::size_t rows) {
  const std::size_t begin = rows + times + 1;
  file.write_list("/vertex", H5T_STD_I64LE, numbers_from(0, most + 1));
  file.create_group("/VTKHDF/Vertices");
  file.create_virtual("/VTKHDF/Vertices/Offsets", H5T_STD_I64LE, {begin + most + 1},
                      {{begin, most + 1, ".", "/vertex", {most + 1}}});
  file.link("/VTKHDF/NumberOfPoints", "/VTKHDF/Vertices/NumberOfCells");
  file.write_list("/none", H5T_STD_I64LE, std::vector<std::int64_t>(times, 0));
  for (const std::string topology : {"Vertices", "Lines", "Polygons", "Strips"}) {
    const std::string group = "/VTKHDF/" + topology + "/";
    if (topology != "Vertices") {
      file.create_group(group);
      file.link("/VTKHDF/Vertices/Offsets", group + "Offsets");
      file.link("/none", group + "NumberOfCells");
    }
    file.link(group + "NumberOfCells", group + "NumberOfConnectivityIds");
    file.link("/vertex", group + "Connectivity");
  }
  std::vector<std::array<std::int64_t, 4>> offsets(times);
  for (std::size_t k = 0; k < times; ++k) offsets[k].fill(std::int64_t(begin - k));
  file.write_list(steps_group + "CellOffsets", H5T_STD_I64LE, offsets);
  offsets.assign(times, {0, 0, 0, 0});
  file.write_list(steps_group + "ConnectivityIdOffsets", H5T_STD_I64LE, offsets);
}

}  // namespace

void write_bodies_over_time(const Path& path, const std::vector<Column>& columns,
                            const std::vector<BodyFile>& files) {
  std::vector<double> times;
  std::vector<std::uint64_t> counts, offsets, first_rows{0};
  std::uint64_t rows = 0, most = 0;
  for (const BodyFile& file : files) {
    for (const TimeRow& time : file.times) {
      times.push_back(time.time);
      counts.push_back(time.count);
      offsets.push_back(rows);
      rows += time.count;
      most = std::max(most, time.count);
    }
    first_rows.push_back(rows);
  }
  const std::size_t n = times.size();
  if (n < 2) {
    std::filesystem::remove(path);
    return;
  }
  replace(path, [&](const Path& part) {
    File file = start_file(part, "PolyData", n);
    file.write_list(steps_group + "Values", H5T_IEEE_F64LE, times);
    file.write_list("/VTKHDF/NumberOfPoints", H5T_STD_I64LE, counts);
    file.write_list(steps_group + "PointOffsets", H5T_STD_I64LE, offsets);
    file.write_list(steps_group + "PartOffsets", H5T_STD_I64LE, numbers_from(0, n));
    file.write_list(steps_group + "NumberOfParts", H5T_STD_I64LE, std::vector<std::int64_t>(n, 1));
    write_vertices(file, n, most, rows);
    for (const Column& c : columns) {
      const bool points = c.name == "position";
      std::vector<VirtualRows> parts;
      for (std::size_t k = 0; k < files.size(); ++k)
        if (const std::uint64_t of_file = first_rows[k + 1] - first_rows[k])
          parts.push_back({first_rows[k], of_file, files[k].name, "/bodies/" + c.name,
                           table_shape(of_file, c.components)});
      const Handle data = file.create_virtual(points ? "/VTKHDF/Points" : point_data + c.name,
                                              c.stored_type(), table_shape(rows, c.components), parts);
      if (!c.unit.empty()) file.attribute(data, "unit", c.unit);
      if (!points) file.link(steps_group + "PointOffsets", point_offsets + c.name);
    }
    return file;
  });
  H5garbage_collect();  // HDF5 would keep the memory of the lists for the next file
}

}  // namespace silt::adapters::hdf5
