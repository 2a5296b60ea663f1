#include "lbm/levels/level_border.hpp"

#include <array>
#include <span>

#include "lbm/heat/temperature.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::lbm {

namespace {

template <class Field>
std::size_t arrays_of(const Field& fluid) {
  return fluid.blocks().size() * Field::Lattice::directions;
}

/// Sets a table of arrays per block and direction: what left by `parity`, then what arrives; then `more`.
template <class T, class Field>
void set_table(std::pmr::vector<T*>& arrays, Field& fluid, Parity parity, std::array<T*, 2> more) {
  for (auto& block : fluid.blocks())
    for (int i = 0; i < Field::Lattice::directions; ++i)
      arrays.push_back(block.data() + block.leaving(i, parity));
  for (auto& block : fluid.blocks())
    for (int i = 0; i < Field::Lattice::directions; ++i)
      arrays.push_back(block.data() + block.arriving(i, parity));
  arrays.insert(arrays.end(), more.begin(), more.end());
}

}  // namespace

template <class Field>
LevelBorder<Field>::LevelBorder(Field& fine, Field& coarse, std::pmr::polymorphic_allocator<> memory)
    : fine_(fine),
      coarse_(coarse),
      before_(fine.comm(), fine.device(), memory),
      coarse_left_(fine.comm(), fine.device(), memory),
      fine_left_{{fine.comm(), fine.device(), memory}, {fine.comm(), fine.device(), memory}},
      carried_(memory),
      sums_(memory),
      coarse_arrays_{std::pmr::vector<T*>(memory), std::pmr::vector<T*>(memory)},
      fine_arrays_{std::pmr::vector<T*>(memory), std::pmr::vector<T*>(memory)},
      carry_(memory),
      passing_(memory),
      late_(memory.resource()) {
  make_lists();
  for (const Parity parity : {Parity::settled, Parity::crossed}) {
    set_table(coarse_arrays_[int(parity)], coarse, parity,
              {coarse_left_.values.data(), before_.values.data()});
    set_table(fine_arrays_[int(parity)], fine, parity,
              {fine_left_[0].values.data(), fine_left_[1].values.data()});
  }
}
template <class Field>
LevelBorder<Field>::LevelBorder(Field& fine, Field& coarse)
    : LevelBorder(fine, coarse, memory_of(fine.device())) {}

template <class Field>
void LevelBorder<Field>::before_coarse_pass() {
  before_.fetch(std::span<T* const>(coarse_arrays_[int(coarse_.parity())]).subspan(arrays_of(coarse_)));
}

template <class Field>
void LevelBorder<Field>::after_coarse_pass() {
  const std::pmr::vector<T*>& arrays = coarse_arrays_[int(coarse_.parity())];
  coarse_left_.fetch(arrays);
  now_.coarse_left = arrays.data(), now_.coarse_arriving = arrays.data() + arrays_of(coarse_);
  now_.coarse_before = before_.values.data(), now_.carried = carried_.data(), now_.sums = sums_.data();
  passes_on<T>(fine_.device()).carry_packets(now_, carry_);
}

template <class Field>
void LevelBorder<Field>::begin_fine_pass() {
  const std::pmr::vector<T*>& arrays = fine_arrays_[int(flipped(fine_.parity()))];
  now_.sub_step = int(fine_.passes() % 2);
  now_.fine_left = arrays.data(), now_.fine_arriving = arrays.data() + arrays_of(fine_);
  by_parts_.assign(ready_.size(), false);
}

template <class Field>
void LevelBorder<Field>::after_part(int block, int part) {
  by_parts_[block] = true;
  cross(ready_[block][part], {});
}

template <class Field>
void LevelBorder<Field>::end_fine_pass() {
  for (std::size_t b = 0; b < ready_.size(); ++b)
    for (const Lists& part : ready_[b])
      if (!by_parts_[b]) cross(part, {});
  fine_left_[now_.sub_step].fetch(fine_arrays_[int(fine_.parity())]);
  cross(late_, passing_);
}

template <class Field>
void LevelBorder<Field>::cross(const Lists& lists, std::span<const typename Patches::Passing> passing) {
  passes_on<T>(fine_.device()).cross_border(now_, lists, passing);
}

template class LevelBorder<Fluid<float>>;
template class LevelBorder<Fluid<double>>;
template class LevelBorder<Temperature<float>>;
template class LevelBorder<Temperature<double>>;

}  // namespace silt::lbm
