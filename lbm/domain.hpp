#pragma once
// The global box of cells, its sides, how it is cut into blocks, and which rank holds which block.
#include <array>
#include <optional>
#include <vector>

#include "lbm/block.hpp"

namespace silt::lbm {

enum class SideKind { periodic, bounce, free_slip, pressure };
/// One side of the domain. `bounce` is no-slip, a moving wall and a velocity inlet alike: halfway bounce-back
/// with a wall velocity. `pressure` is an outlet (anti bounce-back) at a density deviation.
struct SideCondition {
  SideKind kind = SideKind::periodic;
  std::array<double, 3> velocity{};
  double density_deviation = 0;
};

struct BlockPlace {
  CellBox box;
  int rank;
};

class Domain {
 public:
  /// Sides are in the order x low, x high, y low, ... `block_cells` gives the cells of a block along each
  /// axis (the last one of an axis takes the rest); without it blocks are chosen for the number of ranks.
  /// Blocks are dealt out to ranks in contiguous runs, x fastest. Throws std::invalid_argument for fewer
  /// blocks than ranks.
  Domain(Int3 cells, const std::array<SideCondition, 6>& sides, std::optional<Int3> block_cells, int ranks);

  Int3 cells() const { return cells_; }
  bool periodic(int axis) const { return sides_[2 * axis].kind == SideKind::periodic; }
  const SideCondition& side(int axis, bool upper) const { return sides_[2 * axis + upper]; }
  const std::vector<BlockPlace>& blocks() const { return blocks_; }
  std::vector<int> blocks_of(int rank) const;
  /// The place of every block among blocks_of(rank); -1 for those of other ranks.
  std::vector<int> local_places(int rank) const;
  /// The block of a cell inside the domain.
  int block_at(Int3 cell) const;
  int rank_at(Int3 cell) const { return blocks_[block_at(cell)].rank; }
  /// The image of a cell that lies in the domain along the periodic axes.
  Int3 wrapped(Int3 cell) const;
  bool inside(Int3 cell) const;
  /// The bouncing sides behind which a cell lies: -1 or 1 along their axes, else 0.
  Int3 walls_met(Int3 cell) const;
  /// c_j . u of what meets these walls (as from walls_met). Through an edge each counts only with its
  /// velocity across it: the walls that meet there leave a corner at rest. With the lid's alone, the jets of
  /// a lid-driven square at Reynolds number 1000, 65 cells, are a tenth too weak.
  double wall_velocity_along(Int3 walls, int j) const;
  /// The blocks that share a face, edge or corner with block b, b itself included (sorted, each once).
  std::vector<int> neighbourhood(int b) const;
  /// The neighbourhoods of all blocks of a rank together (sorted, each block once): ranks that walk them in
  /// this order agree on what messages between them hold.
  std::vector<int> neighbourhood_of_rank(int rank) const;

 private:
  Int3 cells_;
  std::array<SideCondition, 6> sides_;
  std::array<std::vector<int>, 3> cuts_;  // first cell of each block along an axis, then the end
  std::vector<BlockPlace> blocks_;        // x fastest
};

}  // namespace silt::lbm
