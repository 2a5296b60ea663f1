#pragma once
// Which build of the hot kernels runs here. All builds round alike (no contraction), so the choice never
// changes a result.

namespace silt::lbm {

enum class Isa { portable, avx2, avx512 };
/// The widest one this machine has; the environment variable SILT_ISA may name a lesser one.
Isa chosen_isa();
/// For this thread, from now on: results too small for a normal number become zero (they are slow, and mean
/// nothing in populations). Does nothing where the machine has no such mode.
void flush_denormals_to_zero();

}  // namespace silt::lbm

/// Calls silt::lbm::<isa>::function(...) of the chosen build.
#define SILT_DISPATCH(function, ...)          \
  switch (chosen_isa()) {                     \
    case Isa::avx512:                         \
      return avx512::function(__VA_ARGS__);   \
    case Isa::avx2:                           \
      return avx2::function(__VA_ARGS__);     \
    default:                                  \
      return portable::function(__VA_ARGS__); \
  }
