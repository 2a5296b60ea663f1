#pragma once
// Passes: loops over entries in any order. Only for files built for a device (SILT_BUILD: cpu, gpu, or an
// instruction set, for `host`), which include this first; functions that run there are SILT_DEVICE. The build
// for `cpu` (SILT_AT_ONCE) runs a pass when it is called, those for `host` at the next wait().
#include <algorithm>
#include <bit>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "cpu/device_code.hpp"
#include "device/host_device.hpp"

namespace silt::inline SILT_BUILD {

/// One thread of a team of `size` threads that process an entry together.
struct Team {
  int lane, size;
  /// Combines the terms of all threads, each of which must call it; the result is valid in thread 0.
  template <class X, class Join>
  SILT_DEVICE X joined(X term, [[maybe_unused]] Join join) const {
#if defined(__CUDA_ARCH__)
    for (int half = size / 2; half > 0; half /= 2) term = join(term, __shfl_down_sync(~0u, term, half));
#endif
    return term;
  }
  /// Adds the terms of all threads to `sum`, of which each has a copy; returns the sum before this one's.
  SILT_DEVICE std::uint32_t before(std::uint32_t term, std::uint32_t& sum) const {
    std::uint32_t through = term, all = term;  // sum over the threads up to this one; over all threads
#if defined(__CUDA_ARCH__)
    for (int step = 1; step < size; step *= 2) {
      const std::uint32_t lower = __shfl_up_sync(~0u, through, step);
      if (lane >= step) through += lower;
    }
    all = __shfl_sync(~0u, through, size - 1);
#endif
    sum += all;
    return sum - all + through - term;
  }
  /// Adds the terms of all threads, each of which must call it, to a sum shared with other teams.
  SILT_DEVICE void add(std::int64_t term, std::int64_t& sum) const {
    term = joined(term, [](std::int64_t a, std::int64_t b) { return a + b; });
#if defined(__CUDA_ARCH__)
    if (lane == 0 && term != 0)
      atomicAdd(reinterpret_cast<unsigned long long*>(&sum), static_cast<unsigned long long>(term));
#else
    sum += term;
#endif
  }
};

SILT_DEVICE inline int bits_in(std::uint64_t word) {
#if defined(__CUDA_ARCH__)
  return __popcll(word);
#else
  return std::popcount(word);
#endif
}
/// Returns the index of the lowest set bit.
SILT_DEVICE inline int lowest_bit(std::uint64_t word) {
#if defined(__CUDA_ARCH__)
  return __ffsll(static_cast<long long>(word)) - 1;
#else
  return std::countr_zero(word);
#endif
}

#if defined(__CUDACC__)

template <class Body>
__global__ void one_of(std::int64_t entries, const Body body) {
  const std::int64_t k = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (k < entries) body(k);
}

template <class Body>
__global__ void one_of_rows(int entries, const Body body) {
  const int k = int(blockIdx.y * blockDim.x + threadIdx.x);
  if (k < entries) body(k, int(blockIdx.x), 1);
}

template <class Body>
__global__ void one_of_teams(std::int64_t entries, const Body body) {
  const std::int64_t k = (std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x) / warpSize;
  if (k < entries) body(k, Team{int(threadIdx.x) % warpSize, warpSize});
}

inline void check(cudaError_t found) {
  if (found != cudaSuccess)
    throw std::runtime_error(std::string("the graphics processor failed: ") + cudaGetErrorString(found));
}

/// Calls body(k) for 0 <= k < entries. Passes run one after another.
template <class Body>
void for_each(std::int64_t entries, const Body& body) {
  constexpr int threads = 256;
  if (entries == 0) return;
  one_of<<<unsigned((entries + threads - 1) / threads), threads>>>(entries, body);
  check(cudaGetLastError());
}
/// Calls body(k, row, 1) for 0 <= k < entries and 0 <= row < rows.
template <class Body>
void for_rows(int entries, int rows, const Body& body) {
  constexpr int warp = 32, most = 256;
  if (entries == 0 || rows == 0) return;
  const int parts = (entries + most - 1) / most;  // of a row, of equal length
  const int threads = ((entries + parts - 1) / parts + warp - 1) / warp * warp;
  one_of_rows<<<dim3(unsigned(rows), unsigned(parts)), threads>>>(entries, body);
  check(cudaGetLastError());
}
/// Calls body(k, thread) for each entry and each thread of its team.
template <class Body>
void for_teams(std::int64_t entries, const Body& body) {
  constexpr int teams = 8, warp = 32;  // of a block of threads
  if (entries == 0) return;
  one_of_teams<<<unsigned((entries + teams - 1) / teams), teams * warp>>>(entries, body);
  check(cudaGetLastError());
}
/// Waits until all passes have finished and their results may be read.
inline void wait() {
  check(cudaDeviceSynchronize());
}
/// Adds to a number that other threads may add to simultaneously.
template <class Whole>
SILT_DEVICE void add_to(Whole& sum, Whole term) {
#if defined(__CUDA_ARCH__)
  using Bits = std::conditional_t<sizeof(Whole) == 4, unsigned, unsigned long long>;
  atomicAdd(reinterpret_cast<Bits*>(&sum), static_cast<Bits>(term));
#else
  sum += term;
#endif
}
/// Flip and set bits of a word, others of which other threads may change simultaneously.
SILT_DEVICE inline void flip_bits(std::uint64_t& word, std::uint64_t bits) {
#if defined(__CUDA_ARCH__)
  atomicXor(reinterpret_cast<unsigned long long*>(&word), static_cast<unsigned long long>(bits));
#else
  word ^= bits;
#endif
}
SILT_DEVICE inline void set_bits(std::uint64_t& word, std::uint64_t bits) {
#if defined(__CUDA_ARCH__)
  atomicOr(reinterpret_cast<unsigned long long*>(&word), static_cast<unsigned long long>(bits));
#else
  word |= bits;
#endif
}
/// Sets a word that is 0 to a value; returns what it was before. Other threads may do so simultaneously.
SILT_DEVICE inline std::uint64_t set_if_zero(std::uint64_t& word, std::uint64_t value) {
#if defined(__CUDA_ARCH__)
  return atomicCAS(reinterpret_cast<unsigned long long*>(&word), 0ull,
                   static_cast<unsigned long long>(value));
#else
  const std::uint64_t before = word;
  if (before == 0) word = value;
  return before;
#endif
}
/// Increments a count and returns its previous value.
SILT_DEVICE inline unsigned next_of(unsigned* count) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(count, 1u);
#else
  return (*count)++;
#endif
}

#else

#if defined(SILT_AT_ONCE)
template <class Work>
void in_turn(const Work& work) {
  work();
}
inline void wait() {}
#else
template <class Work>
void in_turn(const Work& work) {
  defer_work(work);
}
inline void wait() {
  run_deferred_work();
}
#endif
/// A body may have fetch(k), which is called this number of entries ahead, so that the data of entry k has
/// arrived when it is processed.
template <class Body>
void for_each(std::int64_t entries, const Body& body) {
  in_turn([entries, body] {
    for (std::int64_t k = 0; k < entries; ++k) {
      if constexpr (requires { body.fetch(k); })
        if (k + Body::ahead < entries) body.fetch(k + Body::ahead);
      body(k);
    }
  });
}
/// Calls body(k, row, count) for up to Body::together entries at a time, from k on.
template <class Body>
void for_rows(int entries, int rows, const Body& body) {
  in_turn([entries, rows, body] {
    const Body own = body;  // in registers
    for (int row = 0; row < rows; ++row)
      for (int k = 0; k < entries; k += Body::together) own(k, row, std::min(Body::together, entries - k));
  });
}
template <class Body>
void for_teams(std::int64_t entries, const Body& body) {
  in_turn([entries, body] {
    for (std::int64_t k = 0; k < entries; ++k) body(k, Team{0, 1});
  });
}
template <class Whole>
void add_to(Whole& sum, Whole term) {
  sum += term;
}
inline void flip_bits(std::uint64_t& word, std::uint64_t bits) {
  word ^= bits;
}
inline void set_bits(std::uint64_t& word, std::uint64_t bits) {
  word |= bits;
}
inline std::uint64_t set_if_zero(std::uint64_t& word, std::uint64_t value) {
  const std::uint64_t before = word;
  if (before == 0) word = value;
  return before;
}
inline unsigned next_of(unsigned* count) {
  return (*count)++;
}

#endif

}  // namespace silt::inline SILT_BUILD
