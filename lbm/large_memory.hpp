#pragma once
// Memory for populations. Nineteen arrays are read and written at once, each on pages of its own; on large
// pages the machine looks fewer of them up, and what lies together there lies together in the memory's rows.
#include <cstddef>
#include <cstdlib>
#include <memory>

namespace silt::lbm {

struct FreeMemory {
  void operator()(void* p) const { std::free(p); }
};
template <class T>
using LargeMemory = std::unique_ptr<T[], FreeMemory>;

/// Allocates zeros from the start of a cache line on, on large pages as far as they are filled and the system
/// has them. Throws std::bad_alloc.
void* zeroed_memory(std::size_t bytes);

template <class T>
LargeMemory<T> zeroed(std::size_t elements) {
  return LargeMemory<T>(static_cast<T*>(zeroed_memory(elements * sizeof(T))));
}

}  // namespace silt::lbm
