// The kernels that measure what the machine can do: memory updated in place, and arithmetic without memory.
#include <algorithm>

#include "cpu/lanes.hpp"
#include "tests/bench/fluid_kernels.hpp"

namespace silt::bench::SILT_BUILD {

namespace {

constexpr int line_bytes = 64;

template <class T>
void update_in_place(T* data, std::ptrdiff_t stride, std::ptrdiff_t cells, AccessShape shape) {
  using V = typename VectorOf<T>::type;
  constexpr int line = line_bytes / sizeof(T), width = vector_bytes / sizeof(T);
  const std::ptrdiff_t chunk = std::ptrdiff_t(shape.lines) * line, ahead = std::ptrdiff_t(shape.ahead) * line;
  for (int first = 0; first < lbm::D3Q19::directions; first += shape.streams)
    for (std::ptrdiff_t x = 0; x < cells; x += chunk)
      for (int i = first; i < std::min(first + shape.streams, lbm::D3Q19::directions); ++i) {
        T* const p = data + i * stride + x;
        for (std::ptrdiff_t k = 0; k < std::min(chunk, cells - x); k += line) {
          if (ahead) __builtin_prefetch(p + k + ahead, 1);
          for (int j = 0; j < line; j += width) {
            V v;
            __builtin_memcpy(&v, p + k + j, sizeof v);
            v *= T(0.999);
            __builtin_memcpy(p + k + j, &v, sizeof v);
          }
        }
      }
}

template <class T>
double add_and_multiply(T* result, int rounds) {
  using V = typename VectorOf<T>::type;
  constexpr int chains = 12;  // enough to hide the latency of either, few enough for 16 registers
  V v[chains];
#pragma GCC unroll 16
  for (int i = 0; i < chains; ++i) v[i] = V{} + T(i);
  for (int r = 0; r < rounds; ++r) {
#pragma GCC unroll 16
    for (int i = 0; i < chains; ++i) {
      v[i] = v[i] * T(0.5) + T(1);  // not contracted: two operations
#if defined(__x86_64__)
      asm("" : "+x"(v[i]));  // stays in a register, one round after the other
#elif defined(__aarch64__)
      asm("" : "+w"(v[i]));
#endif
    }
  }
#pragma GCC unroll 16
  for (int i = 1; i < chains; ++i) v[0] += v[i];
  const V sum = v[0];
  *result = sum[0];
  return 2.0 * rounds * chains * (vector_bytes / sizeof(T));
}

}  // namespace

template <class T>
BoundKernels<T> bound_kernels() {
  return {update_in_place<T>, add_and_multiply<T>};
}
template BoundKernels<float> bound_kernels();
template BoundKernels<double> bound_kernels();

}  // namespace silt::bench::SILT_BUILD
