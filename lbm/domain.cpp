#include "lbm/domain.hpp"

#include <algorithm>
#include <cstdlib>
#include <set>
#include <stdexcept>
#include <string>

namespace silt::lbm {

namespace {

/// The blocks along each axis, one a rank, that have the smallest surface between them, where a cut across x
/// counts double (short rows are slow). Throws std::invalid_argument where blocks would have fewer than 2
/// cells an edge.
Int3 blocks_per_axis(Int3 cells, int ranks) {
  Int3 best{};
  double best_surface = 0;
  for (int nx = 1; nx <= ranks; ++nx)
    for (int ny = 1; nx * ny <= ranks; ++ny) {
      if (ranks % (nx * ny)) continue;
      const int nz = ranks / (nx * ny);
      if (cells.x < 2 * nx || cells.y < 2 * ny || cells.z < 2 * nz) continue;
      const double surface = 2.0 * (nx - 1) * cells.y * cells.z +
                             1.01 * (ny - 1) * double(cells.x) * cells.z +
                             1.0 * (nz - 1) * double(cells.x) * cells.y;
      if (best.x == 0 || surface < best_surface) {
        best = {nx, ny, nz};
        best_surface = surface;
      }
    }
  if (best.x == 0)
    throw std::invalid_argument("the domain of " + std::to_string(cells.x) + " x " + std::to_string(cells.y) +
                                " x " + std::to_string(cells.z) + " cells cannot be cut into " +
                                std::to_string(ranks) +
                                " blocks of at least 2 cells an edge; use fewer ranks");
  return best;
}

std::vector<int> even_cuts(int cells, int parts) {
  std::vector<int> cuts;
  for (int k = 0; k <= parts; ++k) cuts.push_back(int(std::int64_t(cells) * k / parts));
  return cuts;
}

}  // namespace

Domain::Domain(Int3 cells, const std::array<SideCondition, 6>& sides, std::optional<Int3> block_cells,
               int ranks)
    : cells_(cells), sides_(sides) {
  const Int3 parts = block_cells ? Int3{} : blocks_per_axis(cells, ranks);
  for (int d = 0; d < 3; ++d)
    cuts_[d] =
        even_cuts(cells[d], block_cells ? std::max(1, (cells[d] + (*block_cells)[d] - 1) / (*block_cells)[d])
                                        : parts[d]);
  for (std::size_t k = 0; k + 1 < cuts_[2].size(); ++k)
    for (std::size_t j = 0; j + 1 < cuts_[1].size(); ++j)
      for (std::size_t i = 0; i + 1 < cuts_[0].size(); ++i) {
        const Int3 lower{cuts_[0][i], cuts_[1][j], cuts_[2][k]};
        const Int3 upper{cuts_[0][i + 1], cuts_[1][j + 1], cuts_[2][k + 1]};
        blocks_.push_back({{lower, upper - lower}, 0});
      }
  const int count = int(blocks_.size());
  if (count < ranks)
    throw std::invalid_argument("the domain is cut into " + std::to_string(count) +
                                " blocks, fewer than the " + std::to_string(ranks) +
                                " ranks; make domain.blocks smaller or use fewer ranks");
  // Contiguous runs of equal cell counts, at least one block a rank.
  std::int64_t total = 0, before = 0;
  for (const auto& b : blocks_) total += b.box.cells();
  int last = -1;
  for (int b = 0; b < count; ++b) {
    const std::int64_t middle = before + blocks_[b].box.cells() / 2;
    int rank = std::min<int>(ranks - 1, int(middle * ranks / total));
    rank = std::clamp(rank, std::max(last, ranks - (count - b)), last + 1);
    blocks_[b].rank = last = rank;
    before += blocks_[b].box.cells();
  }
}

std::vector<int> Domain::blocks_of(int rank) const {
  std::vector<int> mine;
  for (int b = 0; b < int(blocks_.size()); ++b)
    if (blocks_[b].rank == rank) mine.push_back(b);
  return mine;
}

std::vector<int> Domain::local_places(int rank) const {
  std::vector<int> place(blocks_.size(), -1);
  int k = 0;
  for (const int b : blocks_of(rank)) place[b] = k++;
  return place;
}

int Domain::block_at(Int3 cell) const {
  int index = 0;
  for (int d = 2; d >= 0; --d) {
    const auto& cuts = cuts_[d];
    const int k = int(std::upper_bound(cuts.begin(), cuts.end(), cell[d]) - cuts.begin()) - 1;
    index = index * int(cuts.size() - 1) + k;
  }
  return index;
}

Int3 Domain::wrapped(Int3 x) const {
  for (int d = 0; d < 3; ++d)
    if (periodic(d)) x[d] = ((x[d] % cells_[d]) + cells_[d]) % cells_[d];
  return x;
}

bool Domain::inside(Int3 x) const {
  return CellBox{{}, cells_}.contains(x);
}

Int3 Domain::walls_met(Int3 x) const {
  Int3 walls{0, 0, 0};
  for (int d = 0; d < 3; ++d) {
    if (periodic(d) || (x[d] >= 0 && x[d] < cells_[d])) continue;
    const bool upper = x[d] >= cells_[d];
    if (side(d, upper).kind == SideKind::bounce) walls[d] = upper ? 1 : -1;
  }
  return walls;
}

double Domain::wall_velocity_along(Int3 walls, int j) const {
  const bool edge = std::abs(walls.x) + std::abs(walls.y) + std::abs(walls.z) > 1;
  double cu = 0;
  for (int d = 0; d < 3; ++d) {
    if (walls[d] == 0) continue;
    const auto& u = side(d, walls[d] > 0).velocity;
    for (int e = 0; e < 3; ++e)
      if (!edge || e == d) cu += c[j][e] * u[e];
  }
  return cu;
}

std::vector<int> Domain::neighbourhood(int b) const {
  const CellBox& box = blocks_[b].box;
  std::set<int> found{b};
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        Int3 cell;
        const Int3 delta{dx, dy, dz};
        for (int d = 0; d < 3; ++d)
          cell[d] = delta[d] < 0   ? box.lower[d] - 1
                    : delta[d] > 0 ? box.lower[d] + box.size[d]
                                   : box.lower[d];
        cell = wrapped(cell);
        if (inside(cell)) found.insert(block_at(cell));
      }
  return {found.begin(), found.end()};
}

std::vector<int> Domain::neighbourhood_of_rank(int rank) const {
  std::set<int> found;
  for (const int b : blocks_of(rank))
    for (const int n : neighbourhood(b)) found.insert(n);
  return {found.begin(), found.end()};
}

}  // namespace silt::lbm
