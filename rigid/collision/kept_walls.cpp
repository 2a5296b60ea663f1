// Walls that bodies may come to meet.
#include <algorithm>

#include "rigid/collision/kept_pairs.hpp"

namespace silt::rigid {

/// Lists the walls within its slack, and notes how far it is to the others.
template <class List>
void KeptPairs::look_at_walls(const Surroundings& around, std::span<const WallSurface> walls, std::uint32_t n,
                              List&& list) {
  Seen& seen = seen_[n];
  const std::size_t row = row_of_seen_[n];
  seen.at_walls = displacement_of(around, n);
  seen.to_next_wall = unlimited;
  if (!seen.dynamic) return;
  const double near = around.reach[row].sum() + seen.slack.to_walls;
  for (std::uint32_t w = 0; w < walls.size(); ++w) {
    const double distance = walls[w].distance(around.bodies.position[row]);
    if (distance > near)
      seen.to_next_wall = std::min(seen.to_next_wall, distance - seen.reach);
    else
      list(w);
  }
}

/// All bodies that have used up their room, or have come.
void KeptPairs::look_at_walls(const Surroundings& around, std::span<const WallSurface> walls) {
  if (walls.empty() || to_look_at_.empty()) return;
  const auto before = [&](const NearWall& p, const NearWall& q) {
    return std::tuple(seen_[p.seen].id, p.seen, p.wall) < std::tuple(seen_[q.seen].id, q.seen, q.wall);
  };
  const auto known = static_cast<std::ptrdiff_t>(near_walls_.size());
  for (const std::uint32_t n : to_look_at_)
    look_at_walls(around, walls, n, [&](std::uint32_t wall) {
      const NearWall near{n, wall};
      if (!std::binary_search(near_walls_.begin(), near_walls_.begin() + known, near, before))
        near_walls_.push_back(near);
    });
  std::sort(near_walls_.begin() + known, near_walls_.end(), before);
  std::inplace_merge(near_walls_.begin(), near_walls_.begin() + known, near_walls_.end(), before);
}

}  // namespace silt::rigid
