#pragma once
// Memory for populations. Nineteen arrays are read and written at once, each on pages of its own; on large
// pages the machine looks fewer of them up, and what lies together there lies together in the memory's rows.
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

/// Allocates zeros from the start of a page on, on large pages as far as they are filled and the system has
/// them. What is never written takes no memory: a block without fluid. Throws std::bad_alloc.
void* zeroed_memory(std::size_t bytes);

template <class T>
LargeMemory<T> zeroed(std::size_t elements) {
  static_assert(std::is_trivial_v<T>);
  const std::size_t bytes = elements * sizeof(T);
  return LargeMemory<T>(static_cast<T*>(zeroed_memory(bytes)), FreeMemory{bytes});
}

}  // namespace silt::lbm
