// The passes over a border between levels, built once per instruction set (SILT_BUILD).
#include "lbm/passes/border_kernel.hpp"

#include "lbm/passes/cross_border.hpp"

namespace silt::lbm::SILT_BUILD {
namespace {

template <class Step, class T, class Entries>
void over_patches(const Step& step, const BorderPatches<T>& border, const Entries& entries) {
  for (const auto& entry : entries) step(border, entry, PatchPart::all_of(entry.size));
}

template <class T>
void carry_packets(const BorderPatches<T>& border,
                   std::span<const typename BorderPatches<T>::Carried> carried) {
  over_patches(Carry(), border, carried);
}

template <class T>
void cross_border(const BorderPatches<T>& given, const BorderLists<T>& lists,
                  std::span<const typename BorderPatches<T>::Passing> passing) {
  BorderPatches<T> border = given;
  border.refer_to(lists);
  in_steps<T>(lists, passing,
              [&](const auto& step, const auto& entries) { over_patches(step, border, entries); });
}

}  // namespace

template <class T>
BorderKernels<T> border_kernels() {
  return {carry_packets<T>, cross_border<T>};
}
template BorderKernels<float> border_kernels();
template BorderKernels<double> border_kernels();

}  // namespace silt::lbm::SILT_BUILD
