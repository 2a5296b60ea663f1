#pragma once
// The vectors of the instruction set a kernel is being built for. Only for *_kernel.cpp files, which are
// built once each (SILT_ISA).

namespace silt::lbm::SILT_ISA {

#if defined(SILT_ISA_avx512)
inline constexpr int vector_bytes = 64;
#elif defined(SILT_ISA_avx2)
inline constexpr int vector_bytes = 32;
#else
inline constexpr int vector_bytes = 16;
#endif

/// n elements; without n as many as a register has.
template <class E, int n = vector_bytes / int(sizeof(E))>
struct VectorOf {
  typedef E type __attribute__((vector_size(n * sizeof(E))));
};

}  // namespace silt::lbm::SILT_ISA
