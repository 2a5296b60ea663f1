#include "coupler/mapping/map_bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/bit_kernel.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

constexpr int ghosts = CellBits::ghosts;

CellBits wall_bits(const lbm::Domain& domain, const lbm::CellBox& box) {
  CellBits bits(box.size);
  const lbm::CellBox all = lbm::grown(box, ghosts);
  bool reaches_outside = false;
  for (int d = 0; d < 3; ++d)
    reaches_outside |=
        !domain.periodic(d) && (all.lower[d] < 0 || all.lower[d] + all.size[d] > domain.cells()[d]);
  if (!reaches_outside) return bits;
  for_cells({-ghosts, -ghosts, -ghosts}, box.size + Int3{ghosts, ghosts, ghosts}, [&](Int3 x) {
    if (!domain.inside(domain.wrapped(box.lower + x))) bits.set(x);
  });
  return bits;
}

/// Returns whether the mapping pose of a body is that of the mask.
bool unchanged_since_mapping(const rigid::BodySet& bodies, std::size_t row, const BodyMask& mask) {
  const MappedMotion& now = coupling_of(bodies, row).mapped;
  return now.pose() == mask.pose && now.steps.first == mask.mapped;
}

/// Sets the cells of a mirror image to those of the image inside the domain.
void reflect(const BodyMask& inside, const lbm::CellBox& block, BodyMask& mask) {
  const BitFrame& f = mask.inside.frame();
  mask.any = false;
  for_cells(f.low + Int3{2, 2, 2}, f.low + f.size - Int3{2, 2, 2}, [&](Int3 x) {
    if (inside.bits.test(mask.reflection.cell(x, block.lower))) mask.inside.set(x), mask.any = true;
  });
  mask.bits = mask.inside;
}

/// Gives the mask those of its cells that no surface has yet.
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
        solid.flip(f.low.x + x, y, z, mine & ~taken);
        mask.any |= (mine & ~taken) != 0;
      }
    }
}

}  // namespace

MapBodies::MapBodies(const lbm::Domain& domain, const rigid::World& world,
                     std::span<const lbm::CellBox> boxes, int link_reach)
    : domain_(domain), world_(world), link_reach_(link_reach) {
  for (int d = 0; d < 3; ++d)
    for (const bool upper : {false, true})
      is_mirrored_ |= domain.side(d, upper).kind == lbm::SideKind::free_slip;
  for (const auto& box : boxes) {
    BlockMap map;
    map.box = box;
    map.walls = map.solid = map.before = wall_bits(domain, box);
    blocks_.push_back(std::move(map));
  }
}

void MapBodies::operator()(const rigid::BodySet& bodies) {
  for (auto& block : blocks_) map_block(block, bodies);
}

void MapBodies::map_walls(const rigid::BodySet& bodies) {
  const double width = 1 << domain_.level();
  for (BlockMap& block : blocks_) {
    const Int3 ends = block.box.lower + block.box.lower + block.box.size;
    const Vec3 middle = width / 2 * Vec3(ends.x, ends.y, ends.z);
    block.solid = block.walls;
    for (std::size_t row = bodies.first_wall(); row < bodies.size(); ++row) {
      const rigid::Shape& shape = world_.shapes[bodies.shape[row]];
      if (!rigid::is_infinite(shape) && !std::holds_alternative<rigid::Mesh>(shape)) continue;
      if (rigid::signed_distance(shape, bodies.pose(row).to_body(middle)) < 0)
        std::fill(block.solid.all().begin(), block.solid.all().end(), ~std::uint64_t{0});
    }
  }
}

bool MapBodies::changed() const {
  return std::any_of(blocks_.begin(), blocks_.end(), [](const BlockMap& b) { return b.changed; });
}

/// Finds all walls, and images of bodies that may cover cells of the block or its ghosts, by (id, shift).
void MapBodies::find_images(const BlockMap& block, const rigid::BodySet& bodies) {
  found_.clear();
  for (std::size_t row = 0; row < bodies.first_wall(); ++row) add_images(block, bodies, row);
  for (std::size_t row = bodies.first_wall(); row < bodies.size(); ++row) {
    const rigid::Shape& shape = world_.shapes[bodies.shape[row]];
    if (rigid::is_infinite(shape))
      add_endless(block, bodies, row);
    else if (std::holds_alternative<rigid::Mesh>(shape))
      add_images(block, bodies, row);
  }
  if (is_mirrored_) add_reflections(block);
  const auto order = [](const Image& i) {
    const Int3 &k = i.shift, &side = i.reflection.side;
    return std::tuple(i.id, k.z, k.y, k.x, i.reflection.any(), side.z, side.y, side.x);
  };
  const auto before = [&](const Image& a, const Image& b) { return order(a) < order(b); };
  if (!std::is_sorted(found_.begin(), found_.end(), before)) std::sort(found_.begin(), found_.end(), before);
}

/// Adds the endless solid around a tube or a hollow mesh. Cuts the block at periods of the domain, so that
/// every block tests a cell at the same position.
void MapBodies::add_endless(const BlockMap& block, const rigid::BodySet& bodies, std::size_t row) {
  struct Stretch {
    int first, end, shift;  // cells of the block and its ghost layers; origin of their period
  };
  std::array<std::vector<Stretch>, 3> along;
  for (int d = 0; d < 3; ++d) {
    const int n = domain_.cells()[d], lower = block.box.lower[d], first = -ghosts,
              end = block.box.size[d] + ghosts;
    if (!domain_.periodic(d)) {
      along[d].push_back({first, end, 0});
      continue;
    }
    for (int period = -1 - ghosts / n; period <= 1 + ghosts / n; ++period) {
      const Stretch s{std::max(first, period * n - lower), std::min(end, (period + 1) * n - lower),
                      period * n};
      if (s.first < s.end) along[d].push_back(s);
    }
  }
  constexpr int beyond = 2;
  for (const Stretch& z : along[2])
    for (const Stretch& y : along[1])
      for (const Stretch& x : along[0]) {
        const Int3 low{x.first, y.first, z.first}, high{x.end, y.end, z.end}, m{beyond, beyond, beyond};
        found_.push_back(
            {bodies.id[row], row, {x.shift, y.shift, z.shift}, BitFrame(low - m, high - low + m + m), true});
      }
}

/// Adds the mirror images, in the first ghost layer, of images that reach the cells at free-slip sides.
void MapBodies::add_reflections(const BlockMap& block) {
  constexpr int beyond = 2;  // cells of a frame around those that the image may cover
  const Int3 n = block.box.size;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t k = 0, images = found_.size(); k < images; ++k)
      for (const bool upper : {false, true}) {
        const int cells = domain_.cells()[axis], end = block.box.lower[axis] + n[axis];
        if (domain_.side(axis, upper).kind != lbm::SideKind::free_slip) continue;
        if (upper ? end != cells : block.box.lower[axis] != 0) continue;
        Image image = found_[k];
        const int at_side = upper ? n[axis] - 1 : 0, low = image.frame.low[axis];
        if (image.reflection.side[axis] != 0 || at_side < low + beyond ||
            at_side >= low + image.frame.size[axis] - beyond)
          continue;
        image.reflection.side[axis] = upper ? 1 : -1, image.reflection.twice[axis] = upper ? 2 * cells : 0;
        Int3 corner = image.frame.low, size = image.frame.size;
        corner[axis] = (upper ? n[axis] : -1) - beyond, size[axis] = 1 + 2 * beyond;
        image.frame = BitFrame(corner, size);
        found_.push_back(image);
      }
}

void MapBodies::add_images(const BlockMap& block, const rigid::BodySet& bodies, std::size_t row) {
  constexpr double rounding = 1e-6;  // cells: a centre on the box's face may be inside
  const rigid::BoundingBox box =
      rigid::bounding_box(world_.shapes[bodies.shape[row]], mapping_pose(bodies, row));
  Int3 low, high, first, last;  // cells of the box, then the range of images that reach the block
  for (int d = 0; d < 3; ++d) {
    low[d] = int(std::ceil(box.lower[d] - 0.5 - rounding));
    high[d] = int(std::floor(box.upper[d] - 0.5 + rounding));
    const int n = domain_.cells()[d], from = block.box.lower[d] - ghosts,
              to = block.box.lower[d] + block.box.size[d] + ghosts - 1;
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
          const int origin = block.box.lower[d] - shift[d];
          corner[d] = std::max(low[d] - origin, -ghosts) - 2;
          size[d] = std::min(high[d] - origin, block.box.size[d] + ghosts - 1) + 3 - corner[d];
        }
        if (size.x > 4 && size.y > 4 && size.z > 4)
          found_.push_back({bodies.id[row], row, shift, BitFrame(corner, size)});
      }
}

/// Marks the cells of a shape, relative to the body's centre.
void MapBodies::mark(const BlockMap& block, const rigid::Shape& shape, BodyMask& mask) {
  const BitFrame& frame = mask.inside.frame();
  const PointInFrame centre = centre_in(block, mask);
  if (const auto* ball = std::get_if<rigid::Sphere>(&shape))
    return bit_kernels().mark_sphere(frame, centre, ball->radius, mask.inside.words());
  if (const auto* mesh = std::get_if<rigid::Mesh>(&shape))
    return meshes_.at(*mesh->surface, mask.pose, {}).mark(mesh->hollow, centre.low, mask.inside);
  surface_.reset(shape, mask.pose.orientation);
  bit_kernels().mark_parts(frame, centre, surface_.view(), mask.inside.words());
}

bool MapBodies::nothing_changed(const BlockMap& block, const rigid::BodySet& bodies) const {
  if (found_.size() != block.masks.size()) return false;
  for (std::size_t k = 0; k < found_.size(); ++k) {
    const BodyMask& mask = block.masks[k];
    if (found_[k].id != mask.id || !found_[k].is(mask) ||
        !unchanged_since_mapping(bodies, found_[k].row, mask))
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
  const BodyMask* inside = nullptr;  // image inside the domain, followed by its reflections
  for (std::size_t k = 0; k < found_.size(); ++k) {
    const Image& image = found_[k];
    BodyMask& mask = block.masks[k];
    mask.id = image.id, mask.row = image.row, mask.shift = image.shift, mask.hollow = image.hollow;
    mask.reflection = image.reflection;
    const MappedMotion& mapped = coupling_of(bodies, image.row).mapped;
    mask.pose = mapped.pose(), mask.mapped = mapped.steps.first;
    while (old != block.masks_before.end() && old->id < mask.id) ++old;
    auto match = old;
    while (match != block.masks_before.end() && match->id == mask.id && !image.is(*match)) ++match;
    const bool known = match != block.masks_before.end() && match->id == mask.id;
    mask.before = known ? int(match - block.masks_before.begin()) : -1;
    mask.kept = known && unchanged_since_mapping(bodies, image.row, *match);
    if (image.reflection.any()) {
      mask.inside.reset(image.frame);
      reflect(*inside, block.box, mask);
    } else if (mask.kept) {
      mask.inside.swap(match->inside);
    } else {
      mask.inside.reset(image.frame);
      mark(block, world_.shapes[bodies.shape[mask.row]], mask);
    }
    if (!image.reflection.any()) take_cells(block.solid, mask), inside = &mask;
    mask.kept = mask.kept && mask.bits == match->bits;
    if (mask.kept)
      mask.near.swap(match->near);
    else
      mask.near.reset({});
  }
  find_kept(block);
}

/// Keeps masks that did not change and around which no cell changed that one of their links may read.
void MapBodies::find_kept(BlockMap& block) {
  const Int3 size = block.box.size;
  const int words = block.solid.words();
  block.changed_rows.clear();
  for (int z = -ghosts; z < size.z + ghosts; ++z)
    for (int y = -ghosts; y < size.y + ghosts; ++y)
      block.changed_rows.push_back(
          !std::equal(block.solid.at(y, z), block.solid.at(y, z) + words, block.before.at(y, z)));
  for (BodyMask& mask : block.masks) mask.kept = mask.kept && !changed_around(block, mask);
}

bool MapBodies::changed_around(const BlockMap& block, BodyMask& mask) const {
  const Int3 low{-ghosts, -ghosts, -ghosts}, high = block.box.size + Int3{ghosts, ghosts, ghosts};
  const BitFrame near = near_frame(mask);
  const Int3 first = near.low, end = near.low + near.size;
  for (int z = std::max(first.z, low.z); z < std::min(end.z, high.z); ++z)
    for (int y = std::max(first.y, low.y); y < std::min(end.y, high.y); ++y) {
      if (!block.row_changed(y, z)) continue;
      for (int k = 0; k < block.solid.words(); ++k) {
        const int x = 64 * k - ghosts;
        const std::uint64_t changed =
            (block.solid.at(y, z)[k] ^ block.before.at(y, z)[k]) & cells_between(x, first.x, end.x);
        if (changed && (changed & near_cells(block, mask).from({x, y, z}))) return true;
      }
    }
  return false;
}

/// Returns the frame of cells that links of the mask may read; the mask has two cells of them already.
BitFrame MapBodies::near_frame(const BodyMask& mask) const {
  const int beyond = link_reach_ - 1;
  const Int3 b{beyond, beyond, beyond};
  return BitFrame(mask.frame().low - b, mask.frame().size + b + b);
}

/// Computes the cells on first use.
const BitWindow& MapBodies::near_cells(const BlockMap& block, BodyMask& mask) const {
  if (mask.near.frame().words() > 0) return mask.near;
  const BitFrame f = near_frame(mask);
  const Int3 low = mask.frame().low, end = low + mask.frame().size;
  mask.near.reset(f);
  fill_rows(mask.near, block.box.size, ghosts, [&](int x, int y, int z) {
    if (y < low.y || z < low.z || y >= end.y || z >= end.z) return std::uint64_t{0};
    return mask.bits.from({x, y, z}) & cells_between(x, low.x, end.x);
  });
  BitWindow wider;
  for (int step = 0; step <= link_reach_; ++step) {
    wider.reset(f);
    bit_kernels().widen(f, mask.near.words(), wider.words());
    for (std::size_t k = 0; k < f.words(); ++k) mask.near.words()[k] |= wider.words()[k];
  }
  return mask.near;
}

}  // namespace silt::coupler
