#pragma once
// Which build of the contact kernels runs here. All builds round alike (no contraction), so the choice never
// changes a result. lbm/isa.hpp says the same for the fluid, and names the sets in reports: neither folder
// sees the other.

namespace silt::rigid {

enum class Isa { portable, avx2, avx512 };
/// The widest one this machine has; the environment variable SILT_ISA may name a lesser one.
Isa chosen_isa();

/// The one that runs here of the three builds of a table of kernels.
template <class Build>
Build chosen(Build portable, Build avx2, Build avx512) {
  const Isa isa = chosen_isa();
  return isa == Isa::avx512 ? avx512 : isa == Isa::avx2 ? avx2 : portable;
}

}  // namespace silt::rigid
