#include "lbm/blocks/large_memory.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <new>

namespace silt::lbm {

namespace {
constexpr std::size_t large_page = std::size_t{2} << 20;

void* mapped(std::size_t bytes) {
  void* const p = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (p == MAP_FAILED) throw std::bad_alloc();
  return p;
}
}  // namespace

void* zeroed_memory(std::size_t bytes) {
  if (bytes < large_page) return mapped(bytes);
  // A large page begins at a multiple of its size; memory before the first and after the last is unmapped.
  char* const from = static_cast<char*>(mapped(bytes + large_page));
  const std::size_t before = (large_page - reinterpret_cast<std::uintptr_t>(from) % large_page) % large_page;
  char* const p = from + before;
  const std::size_t page = std::size_t(sysconf(_SC_PAGESIZE));
  char* const end = p + (bytes + page - 1) / page * page;
  if (before) munmap(from, before);
  if (from + bytes + large_page > end) munmap(end, std::size_t(from + bytes + large_page - end));
#if defined(MADV_HUGEPAGE)
  // Only advice: without large pages the memory is the same. The rest behind the last one keeps small pages.
  madvise(p, bytes / large_page * large_page, MADV_HUGEPAGE);
#endif
  return p;
}

void FreeMemory::operator()(void* p) const {
  munmap(p, bytes);
}

}  // namespace silt::lbm
