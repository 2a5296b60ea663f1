#include "adapters/hdf5/over_time.hpp"

#include <algorithm>
#include <numeric>

namespace silt::adapters::hdf5 {
namespace {

const std::string steps_group = "/VTKHDF/Steps/", point_data = "/VTKHDF/PointData/",
                  point_offsets = "/VTKHDF/Steps/PointDataOffsets/";

/// Begins a file of so many times, and of others to come.
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

template <class Write>
void write_anew(const Path& path, Write&& write) {
  TemporaryFile part(path.string() + ".part", true);
  write(part.path()).close();
  part.rename_to(path);
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

/// Adds a step to a file that is there and has foreseen it. Returns whether it could.
bool add_in_place(const Path& path, std::int64_t step, const ImageTimes& images) {
  if (!std::filesystem::exists(path)) return false;
  try {
    File file = File::open(path, true);
    if (!shows(file, images, true)) return false;
    const Handle group = file.group(steps_group), data = file.dataset("/step");
    std::vector<std::int64_t> steps(file.shape(data)[0]);
    file.check(H5Dread(data, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, steps.data()),
               "cannot read the steps");
    const auto n = std::find(steps.begin(), steps.end(), step) - steps.begin();
    if (n == 0 || n == std::ssize(steps) || n > file.number_in<std::int64_t>(group, "NSteps")) return false;
    file.overwrite(group, "NSteps", n + 1);
    file.close();
    return true;
  } catch (const Error&) {
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
  if (add_in_place(path, step, images)) return;
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
  std::vector<double> times;
  for (const std::int64_t s : steps) times.push_back(double(s) * images.time_step);
  write_anew(path, [&](const Path& part) {
    File file = start_file(part, "ImageData", n);
    file.write_list(steps_group + "Values", H5T_IEEE_F64LE, times);
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

const std::vector<Column> row_columns{column_of<TimeRow>(steps_group + "Values", &TimeRow::time),
                                      column_of<TimeRow>(steps_group + "PointOffsets", &TimeRow::offset),
                                      column_of<TimeRow>("/VTKHDF/NumberOfPoints", &TimeRow::count)};

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

bool write_bodies_over_time(const Path& path, const std::vector<Column>& columns,
                            const std::vector<BodyFile>& files, hsize_t time_room) {
  std::vector<TimeRow> times;
  std::vector<std::uint64_t> first_rows;
  std::uint64_t rows = 0, most = 0;
  for (const BodyFile& file : files) {
    first_rows.push_back(rows);
    for (TimeRow time : file.times) {
      time.offset = rows;
      rows += time.count;
      times.push_back(time);
    }
    most = std::max<std::uint64_t>(most, file.row_room);
  }
  const std::size_t n = times.size(), room = n + time_room;
  if (n < 2) {
    std::filesystem::remove(path);
    return false;
  }
  times.resize(room);
  write_anew(path, [&](const Path& part) {
    File file = start_file(part, "PolyData", n);
    for (const Column& c : row_columns) {
      std::vector<std::byte> bytes;
      gather_column<TimeRow>(
          c, room, [&](std::size_t k) { return times[k]; }, bytes);
      write_rows(file, file.create_dataset(c.name, c.stored_type(), {room}), c, 0, bytes);
    }
    file.write_list(steps_group + "PartOffsets", H5T_STD_I64LE, numbers_from(0, room));
    file.write_list(steps_group + "NumberOfParts", H5T_STD_I64LE, std::vector<std::int64_t>(room, 1));
    const std::uint64_t all = first_rows.back() + files.back().row_room;
    write_vertices(file, room, most, all);
    for (const Column& c : columns) {
      const bool points = c.name == "position";
      std::vector<VirtualRows> parts;
      for (std::size_t k = 0; k < files.size(); ++k) {
        const std::uint64_t end = k + 1 < files.size() ? first_rows[k + 1] : all;
        if (end > first_rows[k])
          parts.push_back({first_rows[k], end - first_rows[k], files[k].name, "/bodies/" + c.name,
                           table_shape(end - first_rows[k], c.components)});
      }
      const Handle data = file.create_virtual(points ? "/VTKHDF/Points" : point_data + c.name,
                                              c.stored_type(), table_shape(all, c.components), parts);
      if (!c.unit.empty()) file.attribute(data, "unit", c.unit);
      if (!points) file.link(steps_group + "PointOffsets", point_offsets + c.name);
    }
    return file;
  });
  H5garbage_collect();  // HDF5 would keep the memory of the lists for the next file
  return true;
}

void add_bodies(const Path& path, std::size_t n, const TimeRow& time) {
  File file = File::open(path, true);
  for (const Column& c : row_columns) {
    std::vector<std::byte> value;
    gather_column<TimeRow>(
        c, 1, [&](auto) { return time; }, value);
    write_rows(file, file.dataset(c.name), c, n, value);
  }
  file.flush();
  file.overwrite(file.group(steps_group), "NSteps", std::int64_t(n + 1));
  file.close();
}

}  // namespace silt::adapters::hdf5
