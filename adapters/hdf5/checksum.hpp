#pragma once
// Private to adapters/hdf5: checksums of a checkpoint's datasets.
#include <xxhash.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace silt::adapters::hdf5 {

/// Mixes bits by splitmix64's finaliser (Steele, Lea, Flood 2014): every bit of x acts on every bit of the
/// result.
inline std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// What a run of values that starts at a global index (number of the value in the dataset) adds to a
/// dataset's checksum. The sum over all runs, modulo 2^64, does not depend on how the dataset is cut into
/// runs or on their order. Zero bits add nothing, so that cells that no rank holds need not be known.
template <class Bits>
std::uint64_t run_checksum(const void* values, std::size_t n, std::uint64_t index) {
  std::uint64_t sum = 0;
  const auto* bytes = static_cast<const unsigned char*>(values);
  for (std::size_t i = 0; i < n; ++i) {
    Bits bits;
    std::memcpy(&bits, bytes + i * sizeof(Bits), sizeof(Bits));
    const std::uint64_t term = mixed(std::uint64_t{bits} + 0x9e3779b97f4a7c15u * (index + i + 1));
    sum += bits ? term : 0;
  }
  return sum;
}

inline std::uint64_t run_checksum(std::size_t value_bytes, const void* values, std::size_t n,
                                  std::uint64_t index) {
  switch (value_bytes) {
    case 1:
      return run_checksum<std::uint8_t>(values, n, index);
    case 4:
      return run_checksum<std::uint32_t>(values, n, index);
    default:
      return run_checksum<std::uint64_t>(values, n, index);
  }
}

/// The checksum of a small dataset that one rank holds whole.
inline std::uint64_t block_checksum(const void* data, std::size_t bytes) {
  return XXH3_64bits(data, bytes);
}

}  // namespace silt::adapters::hdf5
