#include "adapters/hdf5/journal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

namespace {

using Page = std::array<char, journal_page>;
using Pages = std::map<std::uint64_t, Page>;

struct JournaledFile {
  H5FD_t hdf5;  // first: HDF5 knows a file by this part
  std::shared_ptr<OutputFile> out = std::make_shared<OutputFile>();
  bool in_place;  // all is written at once
  struct stat status {};
  haddr_t end = 0, allocated = 0;  // of what is written; of what HDF5 has given away
  Pages pages;                     // that are to be written
  std::vector<char> there;         // what the file has at some place

  haddr_t old_end() const {
    if (in_place) return 0;
    const auto size = static_cast<haddr_t>(status.st_size);
    return (size + journal_page - 1) / journal_page * journal_page;
  }
  bool keep(haddr_t at, std::size_t size, const char* from);
};

JournaledFile& of(H5FD_t* file) {
  return *reinterpret_cast<JournaledFile*>(file);
}
const JournaledFile& of(const H5FD_t* file) {
  return *reinterpret_cast<const JournaledFile*>(file);
}

/// Calls visit(page, first byte in it, bytes, bytes from `at` on) for the parts of a range.
template <class Visit>
void for_pages(haddr_t at, std::size_t size, Visit&& visit) {
  for (std::size_t done = 0; done < size;) {
    const std::size_t first = (at + done) % journal_page, bytes = std::min(journal_page - first, size - done);
    visit((at + done) / journal_page, first, bytes, done);
    done += bytes;
  }
}

/// Keeps what is to be written to a place that the file has, but for pages that it does not change. (HDF5
/// writes whole chunks; an append changes few pages of one.) Returns whether the file could be read.
bool JournaledFile::keep(haddr_t at, std::size_t size, const char* from) {
  if (size == 0) return true;
  const haddr_t begin = at / journal_page * journal_page;
  const std::size_t room = (at + size - begin + journal_page - 1) / journal_page * journal_page;
  there.resize(std::max(there.size(), room));
  if (!read_all(out->file, begin, room, there.data())) return false;
  for_pages(at, size, [&](std::uint64_t number, std::size_t first, std::size_t bytes, std::size_t done) {
    const char* const old = there.data() + (number * journal_page - begin);
    auto page = pages.find(number);
    if (page == pages.end()) {
      if (std::memcmp(old + first, from + done, bytes) == 0) return;
      page = pages.try_emplace(number).first;
      std::copy_n(old, journal_page, page->second.data());
    }
    std::memcpy(page->second.data() + first, from + done, bytes);
  });
  return true;
}

Pages pages_of_journal(const Path& path) {
  const Path journal = journal_of(path);
  std::ifstream in(journal, std::ios::binary);
  char mark[8] = {};
  in.read(mark, sizeof mark);
  Pages pages;
  for (std::uint64_t number = 0; in.read(reinterpret_cast<char*>(&number), sizeof number);)
    in.read(pages[number].data(), journal_page);
  if (std::memcmp(mark, journal_mark, sizeof mark) != 0 || (in.gcount() != 0 && in.gcount() != journal_page))
    throw Error(journal.string() + ": is no journal of this version; move it away and try again");
  return pages;
}

bool write_pages(int file, const Pages& pages) {
  return std::all_of(pages.begin(), pages.end(), [&](const auto& page) {
    return write_all(file, page.first * journal_page, journal_page, page.second.data());
  });
}

/// Descriptor closes itself.
struct Descriptor {
  int file;
  ~Descriptor() {
    if (file >= 0) ::close(file);
  }
};

void write_journal(const Path& path, const Pages& pages) {
  TemporaryFile part(journal_of(path).string() + ".part", true);
  {
    const Descriptor out{::open(part.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)};
    std::string bytes(journal_mark, 8);
    for (const auto& [number, page] : pages) {
      bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
      bytes.append(page.data(), page.size());
    }
    if (out.file < 0 || !write_all(out.file, 0, bytes.size(), bytes.data()))
      fail_in_system(part.path(), "cannot write the journal (is the disk full?)", errno);
  }
  if (::rename(part.path().c_str(), journal_of(path).c_str()) != 0)
    fail_in_system(part.path(), "cannot rename the journal", errno);
}

// ---- what HDF5 calls ----

H5FD_t* open_file(const char* name, unsigned flags, bool in_place) {
  try {
    auto owned = std::make_unique<JournaledFile>();
    owned->in_place = in_place;
    const int how = (flags & H5F_ACC_RDWR ? O_RDWR : O_RDONLY) | (flags & H5F_ACC_CREAT ? O_CREAT : 0) |
                    (flags & H5F_ACC_TRUNC ? O_TRUNC : 0);
    owned->out->file = ::open(name, how | O_CLOEXEC, 0666);
    if (owned->out->file < 0 || ::fstat(owned->out->file, &owned->status) != 0) return nullptr;
    owned->end = static_cast<haddr_t>(owned->status.st_size);
    if (!in_place && std::filesystem::exists(journal_of(name))) owned->pages = pages_of_journal(name);
    return &owned.release()->hdf5;
  } catch (const std::exception&) {
    return nullptr;
  }
}

H5FD_t* open_journaled(const char* name, unsigned flags, hid_t, haddr_t) {
  return open_file(name, flags, false);
}
H5FD_t* open_in_place(const char* name, unsigned flags, hid_t, haddr_t) {
  return open_file(name, flags, true);
}

herr_t close_file(H5FD_t* file) {
  JournaledFile& f = of(file);
  if (!f.in_place && f.out->error && ::ftruncate(f.out->file, f.status.st_size) != 0)
    errno = 0;  // it only takes room
  delete &f;
  return 0;
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  const struct stat &x = of(a).status, &y = of(b).status;
  if (x.st_dev != y.st_dev) return x.st_dev < y.st_dev ? -1 : 1;
  return x.st_ino < y.st_ino ? -1 : x.st_ino > y.st_ino;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t allocated(const H5FD_t* file, H5FD_mem_t) {
  return of(file).allocated;
}
herr_t allocate(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  of(file).allocated = end;
  return 0;
}
haddr_t end_of(const H5FD_t* file, H5FD_mem_t) {
  return of(file).end;
}
herr_t handle_of(H5FD_t* file, hid_t, void** handle) {
  *handle = file;
  return 0;
}

herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, void* buffer) {
  JournaledFile& f = of(file);
  auto* to = static_cast<char*>(buffer);
  if (!read_all(f.out->file, at, size, to)) return -1;
  for_pages(at, size, [&](std::uint64_t number, std::size_t first, std::size_t bytes, std::size_t done) {
    if (const auto page = f.pages.find(number); page != f.pages.end())
      std::memcpy(to + done, page->second.data() + first, bytes);
  });
  return 0;
}

/// Does what may fail, unless something has, and remembers the error.
template <class Work>
herr_t attempt(OutputFile& out, Work&& work) {
  if (out.error) return 0;
  try {
    if (!work()) out.error = errno;
  } catch (const std::bad_alloc&) {
    out.error = ENOMEM;
  }
  return 0;
}

herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, const void* buffer) {
  JournaledFile& f = of(file);
  const auto* from = static_cast<const char*>(buffer);
  f.end = std::max(f.end, at + size);
  const std::size_t kept = at < f.old_end() ? std::min<haddr_t>(size, f.old_end() - at) : 0;
  return attempt(*f.out, [&] {
    return f.keep(at, kept, from) && write_all(f.out->file, at + kept, size - kept, from + kept);
  });
}

herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  JournaledFile& f = of(file);
  const bool same = f.end == f.allocated;
  f.end = f.allocated;
  if (!f.in_place || same) return 0;
  return attempt(*f.out, [&] { return ::ftruncate(f.out->file, static_cast<off_t>(f.allocated)) == 0; });
}

constexpr H5FD_class_t make_driver(const char* name, decltype(open_journaled) open) {
  H5FD_class_t driver{};
  driver.name = name;
  driver.maxaddr = haddr_t{1} << 62;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.open = open;
  driver.close = close_file;
  driver.cmp = compare;
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
constexpr H5FD_class_t of_journaled = make_driver("journaled", open_journaled);
constexpr H5FD_class_t of_in_place = make_driver("in place", open_in_place);

JournaledFile* journaled_file(hid_t file) {
  void* handle = nullptr;
  if (H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) < 0) throw Error("a file of another driver");
  return static_cast<JournaledFile*>(handle);
}

}  // namespace

Path journal_of(const Path& path) {
  return path.string() + ".journal";
}

hid_t journaled_driver() {
  static const hid_t id = H5FDregister(&of_journaled);
  return id;
}

hid_t in_place_driver() {
  static const hid_t id = H5FDregister(&of_in_place);
  return id;
}

OutputFile::~OutputFile() {
  close();
}

int OutputFile::close() {
  if (file < 0) return 0;
  return ::close(std::exchange(file, -1)) == 0 ? 0 : errno;
}

std::shared_ptr<OutputFile> output_of(hid_t file) {
  return journaled_file(file)->out;
}

void finish_journal(const Path& path) {
  const Path journal = journal_of(path);
  if (!std::filesystem::exists(journal)) return;
  const Pages pages = pages_of_journal(path);
  const Descriptor out{::open(path.c_str(), O_WRONLY | O_CLOEXEC)};
  if (out.file < 0 || !write_pages(out.file, pages))
    fail_in_system(path, "cannot finish an append that was cut off", errno);
  if (::unlink(journal.c_str()) != 0) fail_in_system(journal, "cannot remove the journal", errno);
}

void commit_journaled(hid_t file, const Path& path) {
  JournaledFile& f = *journaled_file(file);
  if (!f.pages.empty()) {
    struct stat now;
    if (::fstat(f.out->file, &now) != 0) fail_in_system(path, "cannot look at the file", errno);
    // HDF5 takes a file that ends before what it has given away for a truncated one.
    if (static_cast<haddr_t>(now.st_size) < f.allocated && ::ftruncate(f.out->file, f.allocated) != 0)
      fail_in_system(path, "cannot make the file longer (is the disk full?)", errno);
    write_journal(path, f.pages);
    f.status.st_size =
        static_cast<off_t>(f.allocated);  // what the journal refers to stays, whatever fails now
    if (!write_pages(f.out->file, f.pages)) fail_in_system(path, "cannot finish an append", errno);
    if (::unlink(journal_of(path).c_str()) != 0)
      fail_in_system(journal_of(path), "cannot remove the journal", errno);
    if (::ftruncate(f.out->file, f.allocated) != 0) errno = 0;  // what is behind the end only takes room
  }
  f.pages.clear();
  if (::fstat(f.out->file, &f.status) != 0) fail_in_system(path, "cannot look at the file", errno);
}

}  // namespace silt::adapters::hdf5
