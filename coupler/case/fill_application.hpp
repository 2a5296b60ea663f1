#pragma once
// A fill may be applied again and again: bodies come.
#include <cstddef>
#include <cstdint>

namespace silt::coupler {

/// Which fill is applied, and how often it has been before.
struct FillApplication {
  std::size_t fill;
  std::uint64_t number;

  FillApplication(std::size_t fill, std::uint64_t number = 0) : fill(fill), number(number) {}
  bool is_first() const { return number == 0; }
  /// Tells the random numbers of one application from those of any other of the same seed.
  std::uint64_t stream() const { return fill | number << 24; }
};

}  // namespace silt::coupler
