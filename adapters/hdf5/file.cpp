#include "adapters/hdf5/file.hpp"

#include <sys/mman.h>

#include <cerrno>
#include <new>

namespace silt::adapters::hdf5 {
namespace {

/// Extracts the system's message from a message of HDF5's file driver, if there is one.
std::string innermost_reason() {
  std::string reason;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned, const H5E_error2_t* e, void* out) -> herr_t {
        auto& text = *static_cast<std::string*>(out);
        if (text.empty() && e->desc) text = e->desc;
        return 0;
      },
      &reason);
  const std::string mark = "error message = '";
  if (const auto at = reason.find(mark); at != std::string::npos) {
    const auto from = at + mark.size();
    reason = reason.substr(from, reason.find('\'', from) - from);
  }
  return with_limit(reason);
}

constexpr unsigned most_in_header = 65535;  // HDF5's limit

/// Throws std::bad_alloc if memory does not suffice for HDF5 with a file: it follows null pointers.
void expect_memory() {
  constexpr std::size_t of_a_file = 8 << 20;  // in bytes
  void* const room = mmap(nullptr, of_a_file, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) throw std::bad_alloc();
  munmap(room, of_a_file);
}

/// Checks memory and switches off HDF5's own messages. Call before any other function of HDF5.
void quiet() {
  expect_memory();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

/// Returns the properties for opening or creating a file.
Handle access_list(const Path& file) {
  quiet();
  Handle list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, file, "file access list");
  H5Pset_fclose_degree(list, H5F_CLOSE_STRONG);  // otherwise an open group would keep the file open
  H5Pset_driver(list, OutputFile::driver(), nullptr);
  return list;
}

/// Returns a creation list without time stamps, so that equal data give equal bytes.
Handle without_times(hid_t kind, const Path& file) {
  quiet();
  Handle list(H5Pcreate(kind), H5Pclose, file, "creation list");
  H5Pset_obj_track_times(list, false);
  return list;
}

}  // namespace

void fail(const Path& file, const std::string& what) {
  const std::string reason = innermost_reason();
  H5Eclear2(H5E_DEFAULT);
  throw Error(file.string() + ": " + what + (reason.empty() ? "" : ": " + reason));
}

hid_t type_of(Storage storage) {
  return storage == Storage::single    ? H5T_IEEE_F32LE
         : storage == Storage::double_ ? H5T_IEEE_F64LE
                                       : H5T_STD_U8LE;
}

File File::create(const Path& path, Format format) {
  const Handle access = access_list(path);
  if (format == Format::checked) H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18);
  const Handle creation = without_times(H5P_FILE_CREATE, path);
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose, path,
              "cannot create the file");
  return File(path, std::move(file), true);
}

File File::open(const Path& path, bool writable) {
  const Handle access = access_list(path);
  std::error_code ignored;
  const std::string what = "cannot open the file as HDF5 (missing, truncated or altered)";
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
    throw Error(path.string() + ": is no regular file");
  // HDF5 would take an empty file for a new one
  if (writable && std::filesystem::file_size(path, ignored) == 0) throw Error(path.string() + ": " + what);
  Handle file(H5Fopen(path.c_str(), writable ? H5F_ACC_RDWR : H5F_ACC_RDONLY, access), H5Fclose, path, what);
  return File(path, std::move(file), writable);
}

File::File(Path path, Handle handle, bool writable) : path_(std::move(path)), handle_(std::move(handle)) {
  if (writable) output_ = OutputFile::of(handle_);
}

void File::check(herr_t status, const std::string& what) const {
  if (output_ && output_->error) fail_in_system(path_, what, output_->error);
  if (status >= 0) return;
  if (output_) output_->error = ECANCELED;
  fail(path_, what);
}

void File::flush() {
  check(H5Fflush(handle_, H5F_SCOPE_LOCAL), "cannot write (is the disk full?)");
}

void File::close() {
  const std::string what = "cannot close the file (is the disk full?)";
  flush();
  const bool closed = handle_.close();  // this may still write
  if (output_)
    if (const int error = output_->error ? output_->error : output_->close())
      fail_in_system(path_, what, error);
  if (!closed) fail(path_, what);
}

bool File::exists(const std::string& name) const {
  return H5Lexists(handle_, name.c_str(), H5P_DEFAULT) > 0;
}

void File::refuse(const std::string& what) const {
  throw Error(path_.string() + ": " + what);
}

Handle File::group(const std::string& name) const {
  return {H5Gopen2(handle_, name.c_str(), H5P_DEFAULT), H5Gclose, path_, "has no group " + name};
}

Handle File::create_group(const std::string& name) {
  const Handle list = without_times(H5P_GROUP_CREATE, path_);
  H5F_info2_t info;
  if (H5Fget_info2(handle_, &info) >= 0 && info.super.version >= 2) {
    // All links and attributes are in the header, which has a checksum: HDF5 can crash on a damaged heap.
    H5Pset_link_phase_change(list, most_in_header, most_in_header);
    H5Pset_attr_phase_change(list, most_in_header, most_in_header);
  }
  return {H5Gcreate2(handle_, name.c_str(), H5P_DEFAULT, list, H5P_DEFAULT), H5Gclose, path_,
          "cannot create group " + name};
}

Handle File::dataset(const std::string& name) const {
  return {H5Dopen2(handle_, name.c_str(), H5P_DEFAULT), H5Dclose, path_, "has no dataset " + name};
}

Handle File::dataset_to_append(const std::string& name) const {
  const Handle list(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose, path_, "dataset access list");
  H5Pset_chunk_cache(list, 0, 0, 0);
  return {H5Dopen2(handle_, name.c_str(), list), H5Dclose, path_, "has no dataset " + name};
}

Handle File::create_dataset(const std::string& name, hid_t type, const Shape& shape, const Layout& layout) {
  const int rank = int(shape.size());
  Shape most = shape;
  if (layout.grows) most[0] = layout.chunk[0];
  const Handle space(H5Screate_simple(rank, shape.data(), most.data()), H5Sclose, path_, "shape of " + name);
  const Handle list = without_times(H5P_DATASET_CREATE, path_);
  if (!layout.chunk.empty()) H5Pset_chunk(list, rank, layout.chunk.data());
  if (layout.chunk.empty() || layout.grows) H5Pset_alloc_time(list, H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(list, H5D_FILL_TIME_NEVER);
  return {H5Dcreate2(handle_, name.c_str(), type, space, H5P_DEFAULT, list, H5P_DEFAULT), H5Dclose, path_,
          "cannot create dataset " + name};
}

Handle File::write_list(const std::string& name, hid_t type, const Shape& shape, hid_t memory_type,
                        const void* data) {
  Handle dataset = create_dataset(name, type, shape);
  if (shape[0] > 0)
    check(H5Dwrite(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
          "cannot write " + name + " (is the disk full?)");
  return dataset;
}

Handle File::create_virtual(const std::string& name, hid_t type, const Shape& shape,
                            const std::vector<VirtualRows>& parts) {
  const Handle space(H5Screate_simple(int(shape.size()), shape.data(), nullptr), H5Sclose, path_,
                     "shape of " + name);
  const Handle list = without_times(H5P_DATASET_CREATE, path_);
  Shape start(shape.size(), 0), count = shape;
  for (const VirtualRows& part : parts) {
    start[0] = part.first, count[0] = part.n;
    const Handle source(H5Screate_simple(int(part.shape.size()), part.shape.data(), nullptr), H5Sclose, path_,
                        "shape of " + part.dataset);
    check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
          "cannot select rows");
    check(H5Sselect_hyperslab(source, H5S_SELECT_SET, Shape(part.shape.size(), 0).data(), nullptr,
                              part.shape.data(), nullptr),
          "cannot select rows");  // these alone, also when that dataset has grown
    check(H5Pset_virtual(list, space, part.file.c_str(), part.dataset.c_str(), source),
          "cannot take " + name + " from " + part.file);
  }
  H5Sselect_all(space);
  return {H5Dcreate2(handle_, name.c_str(), type, space, H5P_DEFAULT, list, H5P_DEFAULT), H5Dclose, path_,
          "cannot create dataset " + name};
}

void File::link(const std::string& name, const std::string& second) {
  check(H5Lcreate_hard(handle_, name.c_str(), handle_, second.c_str(), H5P_DEFAULT, H5P_DEFAULT),
        "cannot name " + name + " " + second);
}

Shape File::shape(hid_t dataset) const {
  const Handle space(H5Dget_space(dataset), H5Sclose, path_, "shape of a dataset");
  const int rank = H5Sget_simple_extent_ndims(space);
  Shape shape(rank < 0 ? 0 : rank);
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  return shape;
}

hsize_t File::room(hid_t dataset) const {
  const Handle space(H5Dget_space(dataset), H5Sclose, path_, "shape of a dataset");
  Shape most(shape(dataset).size());
  H5Sget_simple_extent_dims(space, nullptr, most.data());
  return most[0];
}

Handle File::type(hid_t dataset) const {
  return {H5Dget_type(dataset), H5Tclose, path_, "type of a dataset"};
}

std::uint64_t File::place_of(hid_t dataset) const {
  const haddr_t place = H5Dget_offset(dataset);
  return place == HADDR_UNDEF ? 0 : place;
}

Place File::place(const std::string& name) const {
  const Handle data = dataset(name), list(H5Dget_create_plist(data), H5Pclose, path_, "layout of " + name);
  const Place place{place_of(data), H5Tget_size(type(data)), shape(data)};
  if (place.shape.empty() || place.shape.size() > 4 || H5Pget_layout(list) != H5D_CONTIGUOUS ||
      (place.value_bytes != 1 && place.value_bytes != 4 && place.value_bytes != 8))
    refuse(name + " has another form than this version writes");
  std::uint64_t room = std::filesystem::file_size(path_) / place.value_bytes;
  for (const hsize_t n : place.shape) room = n > 0 ? room / n : room;
  if (room == 0 || (place.at == 0 && place.values() > 0))
    refuse(name + " declares more values than the file has room for");
  return place;
}

Place File::place(const std::string& name, hid_t wanted, const Shape& wanted_shape) const {
  const Place found = place(name);
  if (found.shape != wanted_shape) refuse(name + " has another shape than this version writes");
  if (H5Tequal(type(dataset(name)), wanted) <= 0) refuse(name + " has another type than this version writes");
  return found;
}

void File::attribute(hid_t owner, const std::string& name, hid_t type, const Shape& shape, const void* data) {
  const Handle space(
      shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(int(shape.size()), shape.data(), nullptr),
      H5Sclose, path_, "shape of attribute " + name);
  if (H5Aexists(owner, name.c_str()) > 0) H5Adelete(owner, name.c_str());
  const Handle attribute(H5Acreate2(owner, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         path_, "cannot create attribute " + name);
  check(H5Awrite(attribute, type, data), "cannot write attribute " + name);
}

namespace {
/// Makes a string type declared as ASCII (vtkHDFReader requires it) that may contain any bytes.
Handle string_type(std::size_t length, const Path& path) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, path, "string type");
  H5Tset_size(type, length ? length : 1);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  return type;
}
void mark_utf8(hid_t type, const std::string& text) {
  for (const unsigned char c : text)
    if (c > 127) {
      H5Tset_cset(type, H5T_CSET_UTF8);
      return;
    }
}
}  // namespace

void File::attribute(hid_t owner, const std::string& name, const std::string& value) {
  const Handle type = string_type(value.size(), path_);
  mark_utf8(type, value);
  attribute(owner, name, type, {}, value.empty() ? "\0" : value.data());
}

void File::attribute(hid_t owner, const std::string& name, const std::vector<std::string>& values) {
  const Handle type = string_type(H5T_VARIABLE, path_);
  H5Tset_strpad(type, H5T_STR_NULLTERM);
  H5Tset_cset(type, H5T_CSET_UTF8);
  std::vector<const char*> pointers;
  pointers.reserve(values.size());
  for (const auto& v : values) pointers.push_back(v.c_str());
  attribute(owner, name, type, {values.size()}, pointers.data());
}

void File::overwrite(hid_t owner, const std::string& name, std::int64_t value) {
  const Handle attribute(H5Aopen(owner, name.c_str(), H5P_DEFAULT), H5Aclose, path_,
                         "has no attribute " + name);
  check(H5Awrite(attribute, H5T_NATIVE_INT64, &value), "cannot write attribute " + name);
}

bool File::has_attribute(hid_t owner, const std::string& name) const {
  return H5Aexists(owner, name.c_str()) > 0;
}

std::string File::text_in(hid_t owner, const std::string& name) const {
  const Handle attribute(H5Aopen(owner, name.c_str(), H5P_DEFAULT), H5Aclose, path_,
                         "has no attribute " + name);
  const Handle type(H5Aget_type(attribute), H5Tclose, path_, "type of attribute " + name);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
    refuse("attribute " + name + " is not a text");
  std::string value(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, value.data()), "cannot read attribute " + name);
  while (!value.empty() && value.back() == '\0') value.pop_back();
  return value;
}

void File::read_number(hid_t owner, const std::string& name, hid_t type, void* value) const {
  const Handle attribute(H5Aopen(owner, name.c_str(), H5P_DEFAULT), H5Aclose, path_,
                         "has no attribute " + name);
  const Handle stored(H5Aget_type(attribute), H5Tclose, path_, "type of attribute " + name);
  if (H5Tequal(stored, type) <= 0 || H5Aget_storage_size(attribute) != H5Tget_size(type))
    refuse("attribute " + name + " is not a single number of the expected type");
  check(H5Aread(attribute, type, value), "cannot read attribute " + name);
}

void File::write_provenance(const Provenance& p) {
  const Handle g = create_group("/provenance");
  const std::pair<const char*, const std::string*> texts[] = {
      {"version", &p.version},     {"commit", &p.commit},       {"title", &p.title},
      {"backend", &p.backend},     {"compiler", &p.compiler},   {"flags", &p.flags},
      {"libraries", &p.libraries}, {"processor", &p.processor}, {"host", &p.host},
      {"created", &p.created}};
  for (const auto& [name, text] : texts) attribute(g, name, *text);
  number(g, "ranks", p.ranks);
  const Handle type = string_type(p.case_text.size(), path_);
  mark_utf8(type, p.case_text);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, path_, "scalar");
  const Handle list = without_times(H5P_DATASET_CREATE, path_);
  const Handle text(H5Dcreate2(g, "case_text", type, space, H5P_DEFAULT, list, H5P_DEFAULT), H5Dclose, path_,
                    "cannot create the case text");
  check(H5Dwrite(text, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, p.case_text.empty() ? "\0" : p.case_text.data()),
        "cannot write the case text");
}

std::string File::case_text() const {
  const Handle text = case_text_dataset(), type = this->type(text);
  std::string value(H5Tget_size(type), '\0');
  if (H5Dget_storage_size(text) != value.size())
    refuse("/provenance/case_text has another size than this version writes");
  check(H5Dread(text, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()),
        "cannot read /provenance/case_text");
  return value;
}

}  // namespace silt::adapters::hdf5
