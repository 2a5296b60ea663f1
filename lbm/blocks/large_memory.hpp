#pragma once
// Memory for populations. A pass reads and writes nineteen arrays at once, each on pages of its own. Large
// pages need fewer page-table look-ups and keep neighbouring elements in one DRAM row.
#include <cstddef>
#include <memory>
#include <type_traits>

namespace silt::lbm {

struct FreeMemory {
  std::size_t bytes = 0;
  void operator()(void* p) const;
};
template <class T>
using LargeMemory = std::unique_ptr<T[], FreeMemory>;

/// Allocates zeros that begin at a page, on large pages where they fill one and the system has any. Pages
/// that are never written take no memory, e.g. in a block without fluid. Throws std::bad_alloc.
void* zeroed_memory(std::size_t bytes);

template <class T>
LargeMemory<T> zeroed(std::size_t elements) {
  static_assert(std::is_trivial_v<T>);
  const std::size_t bytes = elements * sizeof(T);
  return LargeMemory<T>(static_cast<T*>(zeroed_memory(bytes)), FreeMemory{bytes});
}

}  // namespace silt::lbm
