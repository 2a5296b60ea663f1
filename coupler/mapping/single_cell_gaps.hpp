#pragma once
// Gaps of a single cell: what a link knows of the wall behind its cell.
#include <cstdint>
#include <vector>

#include "coupler/mapping/surface_links.hpp"
#include "lbm/domain.hpp"

namespace silt::coupler {

/// Links of `single_cell_gap` come in pairs, along i and against it from one cell, mostly of two surfaces; or
/// a side of the domain is there instead. Gives each link what the formula wants of the wall on the other
/// side.
template <class T>
class SingleCellGaps {
 public:
  /// Fills opposite_q of all links, and opposite_u where that is a side's; call when the links of the box
  /// were built.
  void pair(std::vector<SurfaceLinks<T>>&, const lbm::Domain&, const lbm::CellBox&);
  /// Fills the rest of opposite_u; call when the motions of a step are set, with the surfaces as they were
  /// paired.
  void set_velocities(std::vector<SurfaceLinks<T>>&) const;

 private:
  struct Link {
    std::uint64_t key;             // of the pair
    std::uint32_t surface, place;  // of opposite_q
    std::int32_t direction;
    lbm::Int3 cell;
    T q;
  };
  struct Opposite {
    std::uint32_t surface, place;  // that wants it
    std::uint32_t of;              // surface there
    std::int32_t direction;
    lbm::Int3 cell;
  };
  struct Group {
    std::uint32_t surface, first, count;  // of opposite_q and opposite_u
  };
  template <class F>
  void for_pairs(F&&);  // calls f with the two links of each pair
  void pad(std::vector<SurfaceLinks<T>>&, std::vector<T> lbm::CutLinks<T>::*values) const;

  std::vector<Link> links_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> table_;  // of links_, by key; 0: empty, else from 1 on
  std::vector<Opposite> opposites_;
};

}  // namespace silt::coupler
