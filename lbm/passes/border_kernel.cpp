// The passes over a border between levels, built once per instruction set (SILT_BUILD).
#include "lbm/passes/level_border_patches.hpp"

#include "lbm/passes/cross_border.hpp"

namespace silt::lbm::SILT_BUILD {
namespace {

struct OneByOne {
  template <class Step, class T, class Entries>
  void operator()(const Step& step, const BorderPatches<T>& border, const Entries& entries) const {
    for (const auto& entry : entries) step(border, entry, PatchPart::all_of(entry.size));
  }
};

}  // namespace

template <class T>
BorderKernels<T> border_kernels() {
  return {carry_over<OneByOne, T>, cross_over<OneByOne, T>};
}
template BorderKernels<float> border_kernels();
template BorderKernels<double> border_kernels();

}  // namespace silt::lbm::SILT_BUILD
