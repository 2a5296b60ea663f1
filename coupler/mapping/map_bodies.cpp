#include "coupler/mapping/map_bodies.hpp"

#include <algorithm>
#include <cmath>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/bit_kernels.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

CellBits wall_bits(const lbm::Domain& domain, const lbm::CellBox& box) {
  CellBits bits(box.size);
  for (int z = -1; z <= box.size.z; ++z)
    for (int y = -1; y <= box.size.y; ++y)
      for (int x = -1; x <= box.size.x; ++x) {
        const Int3 cell = domain.wrapped(box.lower + Int3{x, y, z});
        if (!domain.inside(cell)) bits.set({x, y, z});
      }
  return bits;
}

bool same(const rigid::Pose& a, const rigid::Pose& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

/// The first n of some cells (all, if there are more).
std::uint64_t first_cells(std::uint64_t cells, int n) {
  return n >= 64 ? cells : cells & ((std::uint64_t{1} << n) - 1);
}

/// Gives the mask those of its cells that no one has yet.
void take_cells(CellBits& solid, BodyMask& mask) {
  const BitFrame& f = mask.inside.frame();
  mask.bits = mask.inside;
  mask.any = false;
  for (int z = f.low.z + 2; z < f.low.z + f.size.z - 2; ++z)
    for (int y = f.low.y + 2; y < f.low.y + f.size.y - 2; ++y) {
      const std::size_t row = f.row(y, z);
      for (int x = 0; x < f.pitch; x += 64) {
        const std::uint64_t mine = mask.inside.row(x, y, z);
        if (!mine) continue;
        const std::uint64_t taken = mine & solid.from(f.low.x + x, y, z);
        mask.bits.words()[(row + x) >> 6] &= ~(taken << (row & 63));
        solid.add(f.low.x + x, y, z, mine & ~taken);
        mask.any |= (mine & ~taken) != 0;
      }
    }
}

}  // namespace

MapBodies::MapBodies(const lbm::Domain& domain, const rigid::World& world,
                     std::span<const lbm::CellBox> boxes)
    : domain_(domain), world_(world) {
  for (const auto& box : boxes) {
    BlockMap map;
    map.box = box;
    map.walls = map.solid = map.before = wall_bits(domain, box);
    blocks_.push_back(std::move(map));
  }
}

void renew_mapping_poses(rigid::BodySet& bodies, const rigid::World& world, double tolerance) {
  for (std::size_t row = 0; row < bodies.first_wall(); ++row) {
    const rigid::Pose now = bodies.pose(row);
    const rigid::Pose then = mapping_pose(bodies, row);
    if (same(now, then)) continue;
    // |q - q'| of two unit quaternions is half the angle between them, or that of q and -q'
    const auto a = now.orientation.coeffs(), b = then.orientation.coeffs();
    const double angle = 2 * std::min((a - b).norm(), (a + b).norm());
    const double moved =
        (now.position - then.position).norm() + angle * world.bounding_radii[bodies.shape[row]];
    if (moved > tolerance) set_mapping_pose(bodies, row, now);
  }
}

void MapBodies::operator()(const rigid::BodySet& bodies) {
  for (auto& block : blocks_) map_block(block, bodies);
}

bool MapBodies::changed() const {
  return std::any_of(blocks_.begin(), blocks_.end(), [](const BlockMap& b) { return b.changed; });
}

/// Every image of every body whose cells may lie in the block or its ghost layer, and every wall, by (id,
/// shift).
void MapBodies::find_images(const BlockMap& block, const rigid::BodySet& bodies) {
  found_.clear();
  for (std::size_t row = 0; row < bodies.first_wall(); ++row) add_images(block, bodies, row);
  for (std::size_t row = bodies.first_wall(); row < bodies.size(); ++row) {
    if (!std::holds_alternative<rigid::Tube>(world_.shapes[bodies.shape[row]])) continue;
    const Int3 n =
        block.box.size;  // no images: it is alike on both sides of a periodic border, or solid there
    found_.push_back({bodies.id[row], row, {}, BitFrame({-3, -3, -3}, n + Int3{6, 6, 6})});
  }
  const auto before = [](const Image& a, const Image& b) {
    return std::tie(a.id, a.shift.z, a.shift.y, a.shift.x) < std::tie(b.id, b.shift.z, b.shift.y, b.shift.x);
  };
  if (!std::is_sorted(found_.begin(), found_.end(), before)) std::sort(found_.begin(), found_.end(), before);
}

void MapBodies::add_images(const BlockMap& block, const rigid::BodySet& bodies, std::size_t row) {
  constexpr double rounding = 1e-6;  // cells: a centre that the box only touches may be inside
  const rigid::BoundingBox box =
      rigid::bounding_box(world_.shapes[bodies.shape[row]], mapping_pose(bodies, row));
  Int3 low, high, first, last;  // cells the box may cover, then the images that reach the block
  for (int d = 0; d < 3; ++d) {
    low[d] = int(std::ceil(box.lower[d] - 0.5 - rounding));
    high[d] = int(std::floor(box.upper[d] - 0.5 + rounding));
    const int n = domain_.cells()[d], from = block.box.lower[d] - 1,
              to = block.box.lower[d] + block.box.size[d];
    const auto floor_div = [](int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); };
    first[d] = domain_.periodic(d) ? -floor_div(high[d] - from, n) : 0;
    last[d] = domain_.periodic(d) ? floor_div(to - low[d], n) : 0;
    if (!domain_.periodic(d) && (high[d] < from || low[d] > to)) last[d] = -1;
  }
  for (int kz = first.z; kz <= last.z; ++kz)
    for (int ky = first.y; ky <= last.y; ++ky)
      for (int kx = first.x; kx <= last.x; ++kx) {
        const Int3 n = domain_.cells(), shift{kx * n.x, ky * n.y, kz * n.z};
        Int3 corner, size;
        for (int d = 0; d < 3; ++d) {
          corner[d] = std::max(low[d] + shift[d] - block.box.lower[d], -1) - 2;
          size[d] = std::min(high[d] + shift[d] - block.box.lower[d], block.box.size[d]) + 3 - corner[d];
        }
        if (size.x > 4 && size.y > 4 && size.z > 4)
          found_.push_back({bodies.id[row], row, shift, BitFrame(corner, size)});
      }
}

/// Row by row: where the line of cell centres is inside, in closed form, relative to the body's centre.
void MapBodies::mark(const BlockMap& block, const rigid::Shape& shape, BodyMask& mask) {
  const BitFrame& frame = mask.inside.frame();
  const Vec3& x = mask.pose.position;
  const PointInFrame centre{x[0], x[1], x[2], block.box.lower + frame.low - mask.shift};
  if (const auto* ball = std::get_if<rigid::Sphere>(&shape))
    return bit_kernels().mark_sphere(frame, centre, ball->radius, mask.inside.words());
  surface_.reset(shape, mask.pose.orientation);
  bit_kernels().mark_parts(frame, centre, surface_.view(), mask.inside.words());
}

bool MapBodies::nothing_changed(const BlockMap& block, const rigid::BodySet& bodies) const {
  if (found_.size() != block.masks.size()) return false;
  for (std::size_t k = 0; k < found_.size(); ++k) {
    const BodyMask& mask = block.masks[k];
    if (found_[k].id != mask.id || !(found_[k].shift == mask.shift) ||
        !same(mapping_pose(bodies, found_[k].row), mask.pose))
      return false;
  }
  return true;
}

void MapBodies::map_block(BlockMap& block, const rigid::BodySet& bodies) {
  find_images(block, bodies);
  const bool was_changed = block.changed;
  block.changed = !nothing_changed(block, bodies);
  if (!block.changed) {
    for (std::size_t k = 0; k < found_.size(); ++k) block.masks[k].row = found_[k].row;
    if (was_changed) block.before.all() = block.solid.all();
    return;
  }
  block.masks_before.swap(block.masks);
  block.before.all() = block.solid.all();
  block.solid.all() = block.walls.all();
  block.masks.resize(found_.size());
  auto old = block.masks_before.begin();
  for (std::size_t k = 0; k < found_.size(); ++k) {
    const Image& image = found_[k];
    BodyMask& mask = block.masks[k];
    mask.id = image.id, mask.row = image.row, mask.shift = image.shift;
    mask.pose = mapping_pose(bodies, image.row);
    while (old != block.masks_before.end() && old->id < mask.id) ++old;
    auto match = old;
    while (match != block.masks_before.end() && match->id == mask.id && !(match->shift == mask.shift))
      ++match;
    const bool known = match != block.masks_before.end() && match->id == mask.id;
    mask.before = known ? int(match - block.masks_before.begin()) : -1;
    mask.kept = known && same(match->pose, mask.pose);
    if (mask.kept) {
      mask.inside = match->inside;
    } else {
      mask.inside.reset(image.frame);
      mark(block, world_.shapes[bodies.shape[mask.row]], mask);
    }
    take_cells(block.solid, mask);
    mask.kept = mask.kept && mask.bits == match->bits;
  }
  find_kept(block);
}

/// Of the masks that are what they were, those around which others changed cells are not kept.
void MapBodies::find_kept(BlockMap& block) {
  const int rows = block.box.size.y + 2, words = block.solid.words();
  changed_rows_.assign(std::size_t(rows) * (block.box.size.z + 2), 0);
  for (int z = -1; z <= block.box.size.z; ++z)
    for (int y = -1; y <= block.box.size.y; ++y)
      changed_rows_[std::size_t(z + 1) * rows + (y + 1)] =
          !std::equal(block.solid.at(y, z), block.solid.at(y, z) + words, block.before.at(y, z));
  for (BodyMask& mask : block.masks) {
    const BitFrame& f = mask.frame();
    const int low = std::max(f.low.y, -1), high = std::min(f.low.y + f.size.y, block.box.size.y + 1);
    for (int z = std::max(f.low.z, -1); mask.kept && z < std::min(f.low.z + f.size.z, block.box.size.z + 1);
         ++z)
      for (int y = low; mask.kept && y < high; ++y)
        if (changed_rows_[std::size_t(z + 1) * rows + (y + 1)])
          for (int x = 0; x < f.pitch; x += 64)
            mask.kept &=
                first_cells(block.solid.from(f.low.x + x, y, z) ^ block.before.from(f.low.x + x, y, z),
                            f.size.x - x) == 0;
  }
}

}  // namespace silt::coupler
