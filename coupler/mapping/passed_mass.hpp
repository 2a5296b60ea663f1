#pragma once
// The mass that cells which turn solid or fluid pass on: a covered cell gives its density deviation to the
// fluid around it and an uncovered cell takes it from there (method.md, equations 46 and 47), so that moving
// bodies conserve mass with any sides. A device weighs and shares the mass of cells all of whose fluid
// neighbours are in their block; the processor that of the others, with neighbours on any rank.
#include "coupler/mapping/refill.hpp"

namespace silt::coupler {

/// Masses for cells of this rank, in quanta of lbm/blocks/excess.hpp.
struct MassShares {
  std::vector<lbm::LocalCell> cells;
  std::vector<std::int64_t> masses;
};

template <class T>
class PassedMass {
 public:
  explicit PassedMass(Device device) : neighbours_(device), masses_(device), left_(device), listed_(device) {}

  /// Weighs the cells that changed. Call after refill(), before covered cells change. Returns the mass, in
  /// lbm::mass_quantum, of cells without a fluid neighbour. Collective over neighbour ranks.
  rigid::FixedSum weigh(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&);
  /// Gives the masses to the neighbours, once: after the collision, since their sum with an older excess
  /// would be rounded.
  void give(lbm::Fluid<T>&);

 private:
  std::vector<lbm::LocalCell> inner_;  // covered, then uncovered: all fluid neighbours are in the block
  Mirror<std::uint32_t> neighbours_;
  Mirror<std::int64_t> masses_, left_;
  lbm::CellLists<T> listed_;
  PassingCells<T> passing_{};
  MassShares others_;
};

}  // namespace silt::coupler
