#pragma once
// Room for what a coupler has to remember about a body. It travels with the body from rank to rank and into
// checkpoints; rigid/ carries the bytes along and never reads them.
#include <array>
#include <cstddef>
#include <new>
#include <type_traits>

namespace silt::rigid {

struct HolderState {
  static constexpr std::size_t size = 384;  // bytes
  alignas(8) std::array<std::byte, size> bytes{};

  /// Returns the bytes as the holder's own type, a plain struct of at most `size` bytes. All of them are zero
  /// until it sets them.
  template <class T>
  T& as() {
    check<T>();
    return *std::launder(reinterpret_cast<T*>(bytes.data()));
  }
  template <class T>
  const T& as() const {
    check<T>();
    return *std::launder(reinterpret_cast<const T*>(bytes.data()));
  }

 private:
  template <class T>
  static constexpr void check() {
    static_assert(std::is_trivially_copyable_v<T> && std::is_standard_layout_v<T>);
    static_assert(sizeof(T) <= size);
    static_assert(alignof(T) <= 8);
  }
};
static_assert(std::is_trivially_copyable_v<HolderState>);

}  // namespace silt::rigid
