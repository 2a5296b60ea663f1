// A library to preload (LD_PRELOAD=libfault_at_write.so): the process kills itself at a chosen change of a
// file in a folder, half of a write done, or the change fails; or an allocation of memory does. Changes are
// write, pwrite, writev, pwritev, ftruncate, fallocate, rename, unlink and remove; of those that fail also
// fsync and close. Variables of the environment say which:
// - SILT_FAULT_FOLDER=PATH, SILT_FAULT_AT=n: the n-th change of any file there, from 1.
// - SILT_FAULT_RANK=r: only rank r counts.
// - SILT_FAULT_ERROR=errno: the change fails with this error; without, the process kills itself.
// - SILT_FAULT_LASTING=1: all later changes fail too.
// - SILT_FAULT_MEMORY=bytes: what counts and fails are allocations of so many bytes or more by the program
//   itself; libraries in C have their own.
// - SILT_FAULT_LOG=FILE: a line for each goes to FILE, with the rank at its end if there are several.
#include <dlfcn.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>

namespace {

std::atomic<long> counted{0};

const char* setting(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

const char* rank() {
  return setting("OMPI_COMM_WORLD_RANK");
}

bool is_inside(const char* path) {
  const char* folder = setting("SILT_FAULT_FOLDER");
  return *folder && std::strncmp(path, folder, std::strlen(folder)) == 0;
}

std::string path_of(int file) {
  char link[64], path[PATH_MAX + 1] = {};
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  return readlink(link, path, PATH_MAX) > 0 ? path : "";
}

void note(const char* what, const char* path) {
  const char* log = setting("SILT_FAULT_LOG");
  if (!*log) return;
  if (FILE* file = std::fopen((std::string(log) + rank()).c_str(), "a")) {
    std::fprintf(file, "%s %s\n", what, path);
    std::fclose(file);
  }
}

/// Counts one. Returns whether it is the chosen one.
bool chosen() {
  const char* only = setting("SILT_FAULT_RANK");
  if (*only && std::strcmp(only, rank()) != 0) return false;
  const long n = ++counted, at = std::atol(setting("SILT_FAULT_AT"));
  return n == at || (at > 0 && n > at && *setting("SILT_FAULT_LASTING"));
}

int error() {
  return std::atoi(setting("SILT_FAULT_ERROR"));
}

enum class Fate { none, kill, fail };

Fate fate_of_change(const char* what, const std::string& path) {
  if (!is_inside(path.c_str())) return Fate::none;
  note(what, path.c_str());
  if (*setting("SILT_FAULT_MEMORY") || !chosen()) return Fate::none;
  if (!error()) return Fate::kill;
  errno = error();
  return Fate::fail;
}

[[noreturn]] void die() {
  std::raise(SIGKILL);
  std::abort();
}

/// Does a change, or half of it and dies, or fails.
template <class Whole, class Half>
auto change(const char* what, const std::string& path, Whole&& whole, Half&& half) {
  switch (fate_of_change(what, path)) {
    case Fate::fail:
      return decltype(whole())(-1);
    case Fate::kill:
      half();
      die();
    default:
      return whole();
  }
}
template <class Whole>
auto change(const char* what, const std::string& path, Whole&& whole) {
  return change(what, path, whole, [] {});
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

bool memory_fails(size_t size) {
  static const long least = std::atol(setting("SILT_FAULT_MEMORY"));
  if (least <= 0 || size < size_t(least)) return false;
  note("allocates", std::to_string(size).c_str());
  if (!chosen()) return false;
  return true;
}

}  // namespace

void* operator new(size_t size) {
  void* memory = memory_fails(size) ? nullptr : std::malloc(size);
  if (!memory) throw std::bad_alloc();
  return memory;
}

extern "C" {

ssize_t write(int file, const void* data, size_t size) {
  static const auto real = next<decltype(write)>("write");
  return change(
      "write", path_of(file), [&] { return real(file, data, size); },
      [&] { return real(file, data, size / 2); });
}
ssize_t writev(int file, const iovec* parts, int n) {
  static const auto real = next<decltype(writev)>("writev");
  return change(
      "writev", path_of(file), [&] { return real(file, parts, n); },
      [&] { return real(file, parts, n / 2); });
}
ssize_t pwrite(int file, const void* data, size_t size, off_t at) {
  static const auto real = next<decltype(pwrite)>("pwrite");
  return change(
      "pwrite", path_of(file), [&] { return real(file, data, size, at); },
      [&] { return real(file, data, size / 2, at); });
}
ssize_t pwrite64(int file, const void* data, size_t size, off64_t at) {
  return pwrite(file, data, size, at);
}
ssize_t pwritev(int file, const iovec* parts, int n, off_t at) {
  static const auto real = next<decltype(pwritev)>("pwritev");
  return change(
      "pwritev", path_of(file), [&] { return real(file, parts, n, at); },
      [&] { return real(file, parts, n / 2, at); });
}
ssize_t pwritev64(int file, const iovec* parts, int n, off64_t at) {
  return pwritev(file, parts, n, at);
}
int ftruncate(int file, off_t size) {
  static const auto real = next<decltype(ftruncate)>("ftruncate");
  return change("ftruncate", path_of(file), [&] { return real(file, size); });
}
int ftruncate64(int file, off64_t size) {
  return ftruncate(file, size);
}
int fallocate(int file, int mode, off_t at, off_t size) {
  static const auto real = next<decltype(fallocate)>("fallocate");
  return change("fallocate", path_of(file), [&] { return real(file, mode, at, size); });
}
int fallocate64(int file, int mode, off64_t at, off64_t size) {
  return fallocate(file, mode, at, size);
}
int fsync(int file) {
  static const auto real = next<decltype(fsync)>("fsync");
  if (!error()) return real(file);
  return change("fsync", path_of(file), [&] { return real(file); });
}
int close(int file) {
  static const auto real = next<decltype(close)>("close");
  const int done = error() && fate_of_change("close", path_of(file)) == Fate::fail ? -1 : 0;
  const int why = errno;
  const int closed = real(file);
  if (done == 0) return closed;
  errno = why;
  return done;
}
int rename(const char* from, const char* to) {
  static const auto real = next<decltype(rename)>("rename");
  return change("rename", from, [&] { return real(from, to); });
}
int unlink(const char* path) {
  static const auto real = next<decltype(unlink)>("unlink");
  return change("unlink", path, [&] { return real(path); });
}
int remove(const char* path) {
  static const auto real = next<decltype(remove)>("remove");
  return change("remove", path, [&] { return real(path); });
}
}
