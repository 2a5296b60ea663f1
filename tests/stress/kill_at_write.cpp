// A library to preload: the process kills itself at a chosen change of a file in a folder, half of a write
// done.
//   LD_PRELOAD=libkill_at_write.so SILT_KILL_FOLDER=... SILT_KILL_AT=n: at the n-th change of any file there,
//   from 1; SILT_KILL_AT=0 only counts them, and the number is written to the file SILT_KILL_COUNT at the
//   end.
// Changes are write, pwrite, writev, pwritev, ftruncate, fallocate, rename and unlink.
#include <dlfcn.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

std::atomic<long> changes{0};

const char* setting(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

bool is_inside(const char* path) {
  const char* folder = setting("SILT_KILL_FOLDER");
  return *folder && std::strncmp(path, folder, std::strlen(folder)) == 0;
}

std::string path_of(int file) {
  char link[64], path[PATH_MAX + 1] = {};
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  return readlink(link, path, PATH_MAX) > 0 ? path : "";
}

/// Counts a change of a file. Returns whether it is the chosen one.
bool chosen(const char* what, const std::string& path) {
  if (!is_inside(path.c_str())) return false;
  if (const char* log = setting("SILT_KILL_LOG"); *log)
    if (FILE* file = std::fopen(log, "a")) {
      std::fprintf(file, "%s %s\n", what, path.c_str());
      std::fclose(file);
    }
  return ++changes == std::atol(setting("SILT_KILL_AT"));
}

[[noreturn]] void die() {
  std::raise(SIGKILL);
  std::abort();
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* data, size_t size) {
  static const auto real = next<decltype(write)>("write");
  if (!chosen("write", path_of(file))) return real(file, data, size);
  real(file, data, size / 2);
  die();
}
ssize_t writev(int file, const iovec* parts, int n) {
  static const auto real = next<decltype(writev)>("writev");
  if (!chosen("writev", path_of(file))) return real(file, parts, n);
  real(file, parts, n / 2);
  die();
}
ssize_t pwrite(int file, const void* data, size_t size, off_t at) {
  static const auto real = next<decltype(pwrite)>("pwrite");
  if (!chosen("pwrite", path_of(file))) return real(file, data, size, at);
  real(file, data, size / 2, at);
  die();
}
ssize_t pwrite64(int file, const void* data, size_t size, off64_t at) {
  return pwrite(file, data, size, at);
}
ssize_t pwritev(int file, const iovec* parts, int n, off_t at) {
  static const auto real = next<decltype(pwritev)>("pwritev");
  if (!chosen("pwritev", path_of(file))) return real(file, parts, n, at);
  real(file, parts, n / 2, at);
  die();
}
ssize_t pwritev64(int file, const iovec* parts, int n, off64_t at) {
  return pwritev(file, parts, n, at);
}
int ftruncate(int file, off_t size) {
  static const auto real = next<decltype(ftruncate)>("ftruncate");
  if (chosen("ftruncate", path_of(file))) die();
  return real(file, size);
}
int ftruncate64(int file, off64_t size) {
  return ftruncate(file, size);
}
int fallocate(int file, int mode, off_t at, off_t size) {
  static const auto real = next<decltype(fallocate)>("fallocate");
  if (chosen("fallocate", path_of(file))) die();
  return real(file, mode, at, size);
}
int fallocate64(int file, int mode, off64_t at, off64_t size) {
  return fallocate(file, mode, at, size);
}
int rename(const char* from, const char* to) {
  static const auto real = next<decltype(rename)>("rename");
  if (chosen("rename", from)) die();
  return real(from, to);
}
int unlink(const char* path) {
  static const auto real = next<decltype(unlink)>("unlink");
  if (chosen("unlink", path)) die();
  return real(path);
}
int remove(const char* path) {
  static const auto real = next<decltype(remove)>("remove");
  if (chosen("remove", path)) die();
  return real(path);
}
}
