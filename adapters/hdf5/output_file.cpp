#include "adapters/hdf5/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "adapters/hdf5/disk.hpp"

namespace silt::adapters::hdf5 {

namespace {

struct DrivenFile {
  H5FD_t hdf5;  // first: HDF5 knows a file by this part
  std::shared_ptr<OutputFile> out = std::make_shared<OutputFile>();
  haddr_t end = 0, allocated = 0;  // of what is written; of what HDF5 has given away

  static DrivenFile& of(H5FD_t* file) { return *reinterpret_cast<DrivenFile*>(file); }
  static const DrivenFile& of(const H5FD_t* file) { return *reinterpret_cast<const DrivenFile*>(file); }
  /// Does what may fail, unless something has, and remembers the error.
  template <class Work>
  herr_t attempt(Work&& work) {
    if (!out->error && !work()) out->error = errno;
    return 0;
  }
};

H5FD_t* open_file(const char* name, unsigned flags, hid_t, haddr_t) {
  const int how = (flags & H5F_ACC_RDWR ? O_RDWR : O_RDONLY) | (flags & H5F_ACC_CREAT ? O_CREAT : 0) |
                  (flags & H5F_ACC_TRUNC ? O_TRUNC : 0);
  try {
    auto owned = std::make_unique<DrivenFile>();
    struct stat status;
    owned->out->file = ::open(name, how | O_CLOEXEC, 0666);
    if (owned->out->file < 0 || ::fstat(owned->out->file, &status) != 0) return nullptr;
    owned->end = static_cast<haddr_t>(status.st_size);
    return &owned.release()->hdf5;
  } catch (const std::exception&) {
    return nullptr;
  }
}

herr_t close_file(H5FD_t* file) {
  delete &DrivenFile::of(file);
  return 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t allocated(const H5FD_t* file, H5FD_mem_t) {
  return DrivenFile::of(file).allocated;
}
herr_t allocate(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  DrivenFile::of(file).allocated = end;
  return 0;
}
haddr_t end_of(const H5FD_t* file, H5FD_mem_t) {
  return DrivenFile::of(file).end;
}
herr_t handle_of(H5FD_t* file, hid_t, void** handle) {
  *handle = file;
  return 0;
}

herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, void* to) {
  return read_all(DrivenFile::of(file).out->file, at, size, static_cast<char*>(to)) ? 0 : -1;
}

herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, const void* from) {
  DrivenFile& f = DrivenFile::of(file);
  f.end = std::max(f.end, at + size);
  return f.attempt([&] { return write_all(f.out->file, at, size, static_cast<const char*>(from)); });
}

herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  DrivenFile& f = DrivenFile::of(file);
  if (std::exchange(f.end, f.allocated) == f.allocated) return 0;
  return f.attempt([&] { return ::ftruncate(f.out->file, static_cast<off_t>(f.allocated)) == 0; });
}

constexpr H5FD_class_t make_driver() {
  H5FD_class_t driver{};
  driver.name = "in place";
  driver.maxaddr = haddr_t{1} << 62;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.open = open_file;
  driver.close = close_file;
  driver.query = query;
  driver.get_eoa = allocated;
  driver.set_eoa = allocate;
  driver.get_eof = end_of;
  driver.get_handle = handle_of;
  driver.read = read;
  driver.write = write;
  driver.truncate = truncate;
  constexpr H5FD_mem_t map[H5FD_MEM_NTYPES] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(map), std::end(map), driver.fl_map);
  return driver;
}
constexpr H5FD_class_t in_place = make_driver();

}  // namespace

OutputFile::~OutputFile() {
  close();
}

int OutputFile::close() {
  if (file < 0) return 0;
  return ::close(std::exchange(file, -1)) == 0 ? 0 : errno;
}

std::shared_ptr<OutputFile> OutputFile::of(hid_t file) {
  void* handle = nullptr;
  if (H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) < 0) throw Error("a file of another driver");
  return static_cast<DrivenFile*>(handle)->out;
}

hid_t OutputFile::driver() {
  static const hid_t id = H5FDregister(&in_place);
  return id;
}

}  // namespace silt::adapters::hdf5
