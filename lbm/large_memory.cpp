#include "lbm/large_memory.hpp"

#include <cstring>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace silt::lbm {

namespace {
constexpr std::size_t cache_line = 64, large_page = std::size_t{2} << 20;

std::size_t rounded_up(std::size_t n, std::size_t to) {
  return (n + to - 1) / to * to;
}
}  // namespace

void* zeroed_memory(std::size_t bytes) {
  const std::size_t alignment = bytes >= large_page ? large_page : cache_line;
  void* const p = std::aligned_alloc(alignment, rounded_up(bytes, alignment));
  if (!p) throw std::bad_alloc();
#if defined(__linux__)
  // A wish: without large pages it is the same memory. What does not fill the last one stays on small pages.
  if (const std::size_t whole = bytes / large_page * large_page) madvise(p, whole, MADV_HUGEPAGE);
#endif
  std::memset(p, 0, bytes);
  return p;
}

}  // namespace silt::lbm
