#include "coupler/mapping/mesh_distances.hpp"

#include <algorithm>

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

constexpr std::size_t least_entries = 1024;
constexpr std::int64_t rounding = 4;  // units: a crossing so near a lattice point is at it

}  // namespace

void MeshDistances::find(const rigid::Mesh& mesh, const BlockMap& map, const BodyMask& mask) {
  mesh_ = &mesh, map_ = &map, mask_ = &mask;
  origin_ = map.box.lower - mask.shift;
  entries_.assign(std::max(entries_.size(), least_entries), {});
  used_ = 0;
  placed_.place(*mesh.surface, mask.pose);
  const Int3 low = origin_ + mask.frame().low, high = low + mask.frame().size;
  const auto& triangles = placed_.near(Vec3(low.x, low.y, low.z), Vec3(high.x, high.y, high.z));
  for (int direction = 1; direction < lbm::directions; direction += 2)
    meet_lines(Lines(direction), triangles);
}

/// Of the lines through cells next to those of the block, and in the window.
void MeshDistances::meet_lines(const Lines& lines, std::span<const std::uint32_t> triangles) {
  const BitFrame& f = mask_->frame();
  Int3 low, high;
  for (int d = 0; d < 3; ++d) {
    low[d] = origin_[d] + std::max(-1, f.low[d]);
    high[d] = origin_[d] + std::min(map_->box.size[d], f.low[d] + f.size[d] - 1);
  }
  const auto range = [&](int d, int slope) {
    const int first = slope * low[lines.axis], last = slope * high[lines.axis];
    return Range{low[d] - std::max(first, last), high[d] - std::min(first, last)};
  };
  const Range us = range(lines.a, lines.c_a), vs = range(lines.b, lines.c_b);
  for (const std::uint32_t triangle : triangles) {
    const SeenTriangle seen(placed_.corners(triangle), lines);
    const Range u = us.within(seen.u_range());
    if (u.empty()) continue;
    const Range v = vs.within(seen.v_range());
    if (v.empty()) continue;
    seen.meet<Touching::counts>(u, v, [&](std::int64_t at_u, std::int64_t at_v, std::int64_t w) {
      for (std::int64_t k = (w - rounding) >> cell_bits; k <= (w + rounding) >> cell_bits; ++k) {
        if (k < low[lines.axis] || k >= high[lines.axis]) continue;
        const Int3 from = lines.cell(at_u, at_v, k), to = lines.cell(at_u, at_v, k + 1);
        const std::int64_t distance = std::clamp<std::int64_t>(w - (k << cell_bits), 0, cell_units);
        note(from - origin_, to - origin_, lines.forward, distance);
        note(to - origin_, from - origin_, lines.backward, cell_units - distance);
      }
    });
  }
}

/// If the link leads from fluid of the block into the mask.
void MeshDistances::note(Int3 from, Int3 to, int direction, std::int64_t distance) {
  const lbm::CellBox block{{}, map_->box.size};
  if (block.contains(from) && mask_->bits.test(to) && !map_->solid.test(from))
    keep_least(key(from, direction), std::uint32_t(distance));
}

std::uint64_t MeshDistances::key(Int3 x, int direction) const {
  const Int3 n = map_->box.size;
  return ((std::uint64_t(x.z) * n.y + x.y) * n.x + x.x) * 32 + std::uint64_t(direction);  // none is 0
}

/// Where it is, or would be.
std::size_t MeshDistances::place_of(std::uint64_t key) const {
  constexpr std::uint64_t spread = 0x9E3779B97F4A7C15;  // Fibonacci hashing
  const std::size_t mask = entries_.size() - 1;
  std::size_t at = (key * spread >> 32) & mask;
  while (entries_[at].key != 0 && entries_[at].key != key) at = (at + 1) & mask;
  return at;
}

void MeshDistances::keep_least(std::uint64_t key, std::uint32_t distance) {
  Entry& entry = entries_[place_of(key)];
  if (entry.key == key) {
    entry.distance = std::min(entry.distance, distance);
    return;
  }
  entry = {key, distance};
  if (++used_ * 2 > entries_.size()) grow();
}

void MeshDistances::grow() {
  std::vector<Entry> before(entries_.size() * 2);
  before.swap(entries_);
  for (const Entry& entry : before)
    if (entry.key != 0) entries_[place_of(entry.key)] = entry;
}

double MeshDistances::of(Int3 cell, int direction) const {
  const std::uint64_t wanted = key(cell, direction);
  const Entry& entry = entries_[place_of(wanted)];
  if (entry.key == wanted) return double(entry.distance) / double(cell_units);
  const auto from_surface = [&](Int3 x) {
    const Vec3 in_world = mask_->arm(map_->box.lower + x) + mask_->pose.position;
    return mesh_->surface->nearest(mask_->pose.to_body(in_world)).distance;
  };
  const double near = from_surface(cell), far = from_surface(cell + lbm::c[direction]);
  return near + far > 0 ? near / (near + far) : 0;
}

}  // namespace silt::coupler
