#include "coupler/map_bodies.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "rigid/ray_interval.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

/// Sum of the positions of the bits that are set.
int sum_of_positions(std::uint64_t word) {
  constexpr std::uint64_t with_bit[] = {0xAAAAAAAAAAAAAAAA, 0xCCCCCCCCCCCCCCCC, 0xF0F0F0F0F0F0F0F0,
                                        0xFF00FF00FF00FF00, 0xFFFF0000FFFF0000, 0xFFFFFFFF00000000};
  int sum = 0;
  for (int b = 0; b < 6; ++b) sum += std::popcount(word & with_bit[b]) << b;
  return sum;
}

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

/// Sets the bits of the cells first..last (global less shift) that lie in the block's row, ghosts included.
void set_interval(const lbm::CellBox& box, int shift_x, double first, double last, std::uint64_t* row) {
  const int offset = box.lower.x - shift_x - 1;  // bit = cell - offset
  if (!(first - offset <= box.size.x + 1.0 && last - offset >= 0)) return;
  const int from = int(std::max(first - offset, 0.0)), to = int(std::min(last - offset, box.size.x + 1.0));
  for (int bit = from; bit <= to; ++bit) row[bit >> 6] |= std::uint64_t{1} << (bit & 63);
}

/// The cells of a mask inside its block, each counted by the one block that has it.
CellSums count_cells(const BlockMap& block, const BodyMask& mask) {
  CellSums sums;
  const Int3 size = block.box.size, low = block.box.lower + Int3{-mask.shift.x, -mask.shift.y, -mask.shift.z};
  for (int z = std::max(mask.z0, 0); z < std::min(mask.z1, size.z); ++z)
    for (int y = std::max(mask.y0, 0); y < std::min(mask.y1, size.y); ++y)
      for (int k = 0; k < mask.words; ++k) {
        const std::uint64_t word = mask.at(y, z)[k] & block.solid.interior(k);
        const int n = std::popcount(word);
        sums.count += n;
        sums.coordinates[0] += sum_of_positions(word) + n * std::int64_t(low.x + k * 64 - 1);
        sums.coordinates[1] += n * std::int64_t(low.y + y),
            sums.coordinates[2] += n * std::int64_t(low.z + z);
      }
  return sums;
}

}  // namespace

MapBodies::MapBodies(const lbm::Domain& domain, const rigid::World& world,
                     std::span<const lbm::CellBox> boxes)
    : domain_(domain), world_(world) {
  for (const auto& shape : world.shapes) parts_.push_back(rigid::convex_parts(shape));
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
    rigid::Pose& then = bodies.mapping_pose[row];
    if (same(now, then)) continue;
    // |q - q'| of two unit quaternions is half the angle between them, or that of q and -q'
    const auto a = now.orientation.coeffs(), b = then.orientation.coeffs();
    const double angle = 2 * std::min((a - b).norm(), (a + b).norm());
    const double moved =
        (now.position - then.position).norm() + angle * world.bounding_radii[bodies.shape[row]];
    if (moved > tolerance) then = now;
  }
}

void MapBodies::operator()(const rigid::BodySet& bodies) {
  for (auto& block : blocks_) map_block(block, bodies);
}

/// Every image of every body, and every wall, that may meet the block or its ghost layer, without bits.
void MapBodies::find_masks(const BlockMap& block, const rigid::BodySet& bodies,
                           std::vector<BodyMask>& found) const {
  found.clear();
  for (std::size_t row = 0; row < bodies.first_wall(); ++row) add_images(block, bodies, row, found);
  for (std::size_t row = bodies.first_wall(); row < bodies.size(); ++row) {
    if (!std::holds_alternative<rigid::Tube>(world_.shapes[bodies.shape[row]])) continue;
    BodyMask mask;  // no images: it is alike on both sides of a periodic border, or solid there
    mask.id = bodies.id[row], mask.row = row, mask.pose = bodies.mapping_pose[row];
    mask.y0 = mask.z0 = -1, mask.y1 = block.box.size.y + 1, mask.z1 = block.box.size.z + 1;
    found.push_back(std::move(mask));
  }
  std::sort(found.begin(), found.end(), [](const BodyMask& a, const BodyMask& b) {
    return std::tie(a.id, a.shift.z, a.shift.y, a.shift.x) < std::tie(b.id, b.shift.z, b.shift.y, b.shift.x);
  });
}

/// The images of a body whose bounding box meets the block or its ghost layer.
void MapBodies::add_images(const BlockMap& block, const rigid::BodySet& bodies, std::size_t row,
                           std::vector<BodyMask>& found) const {
  const rigid::Pose& pose = bodies.mapping_pose[row];
  const rigid::BoundingBox box = rigid::bounding_box(world_.shapes[bodies.shape[row]], pose);
  int low[3], high[3];  // cells the box may cover, then the images that reach the block
  Int3 first, last;
  for (int d = 0; d < 3; ++d) {
    low[d] = int(std::floor(box.lower[d] - 0.5)), high[d] = int(std::ceil(box.upper[d] - 0.5));
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
        BodyMask mask;
        mask.id = bodies.id[row], mask.row = row, mask.pose = pose;
        mask.shift = {kx * domain_.cells().x, ky * domain_.cells().y, kz * domain_.cells().z};
        const auto rows = [&](int d, int shift, int& r0, int& r1) {
          r0 = std::max(low[d] + shift - block.box.lower[d], -1);
          r1 = std::min(high[d] + shift - block.box.lower[d], block.box.size[d]) + 1;
        };
        rows(1, mask.shift.y, mask.y0, mask.y1), rows(2, mask.shift.z, mask.z0, mask.z1);
        if (mask.y0 < mask.y1 && mask.z0 < mask.z1) found.push_back(std::move(mask));
      }
}

/// The cells outside the hollow of a tube.
void MapBodies::mark_around(const BlockMap& block, const rigid::Tube& tube, BodyMask& mask) const {
  const rigid::Mat3 to_tube = mask.pose.orientation.toRotationMatrix().transpose();
  const double centre = mask.pose.position[0] - 0.5;
  constexpr double beyond = 1e9;  // all cells of a row
  for (int z = mask.z0; z < mask.z1; ++z)
    for (int y = mask.y0; y < mask.y1; ++y) {
      const Vec3 r = mask.arm(block.box.lower + Int3{0, y, z});
      std::uint64_t* const row = mask.inside.data() + mask.row_index(y, z);
      const auto hollow = rigid::hollow_interval(tube, to_tube * Vec3(0, r[1], r[2]), to_tube.col(0));
      set_interval(block.box, 0, -beyond, hollow ? std::floor(centre + hollow->enter) : beyond, row);
      if (hollow) set_interval(block.box, 0, std::ceil(centre + hollow->leave), beyond, row);
    }
}

/// Row by row: where the line of cell centres is inside, in closed form, relative to the body's centre.
void MapBodies::mark(const BlockMap& block, const rigid::Shape& shape, BodyMask& mask) const {
  mask.words = block.solid.words();
  mask.inside.assign(std::size_t(mask.words) * (mask.y1 - mask.y0) * (mask.z1 - mask.z0), 0);
  if (const auto* tube = std::get_if<rigid::Tube>(&shape)) return mark_around(block, *tube, mask);
  const auto& parts = parts_[&shape - world_.shapes.data()];
  const rigid::Mat3 to_body = mask.pose.orientation.toRotationMatrix().transpose();
  const Vec3 direction_B = to_body.col(0);
  const double centre = mask.pose.position[0] - 0.5;
  const auto* ball = std::get_if<rigid::Sphere>(&shape);
  for (int z = mask.z0; z < mask.z1; ++z)
    for (int y = mask.y0; y < mask.y1; ++y) {
      const Vec3 r = mask.arm(block.box.lower + Int3{0, y, z});
      std::uint64_t* const row = mask.inside.data() + mask.row_index(y, z);
      if (ball) {
        const double h2 = ball->radius * ball->radius - r[1] * r[1] - r[2] * r[2];
        if (h2 < 0) continue;
        const double half = std::sqrt(h2);
        set_interval(block.box, mask.shift.x, std::ceil(centre - half), std::floor(centre + half), row);
        continue;
      }
      const Vec3 origin_B = to_body * Vec3(0, r[1], r[2]);
      for (const auto& part : parts) {
        const auto hit = rigid::ray_interval(part.shape, part.pose.to_body(origin_B),
                                             part.pose.orientation.conjugate() * direction_B);
        if (hit)
          set_interval(block.box, mask.shift.x, std::ceil(centre + hit->enter),
                       std::floor(centre + hit->leave), row);
      }
    }
}

void MapBodies::map_block(BlockMap& block, const rigid::BodySet& bodies) {
  std::vector<BodyMask> found;
  find_masks(block, bodies, found);
  block.changed = found.size() != block.masks.size();
  for (std::size_t k = 0; !block.changed && k < found.size(); ++k)
    block.changed = found[k].id != block.masks[k].id || !(found[k].shift == block.masks[k].shift) ||
                    !same(found[k].pose, block.masks[k].pose);
  if (!block.changed) {
    for (std::size_t k = 0; k < found.size(); ++k) block.masks[k].row = found[k].row;
    block.masks_before.clear();
    block.before.all() = block.solid.all();
    return;
  }
  block.masks_before.swap(block.masks);
  block.masks.swap(found);
  block.before.all() = block.solid.all();
  block.solid.all() = block.walls.all();
  auto old = block.masks_before.begin();
  for (auto& mask : block.masks) {
    while (old != block.masks_before.end() && old->id < mask.id) ++old;
    auto match = old;
    while (match != block.masks_before.end() && match->id == mask.id && !(match->shift == mask.shift))
      ++match;
    if (match != block.masks_before.end() && match->id == mask.id && same(match->pose, mask.pose))
      mask.words = match->words, mask.inside = match->inside;
    else
      mark(block, world_.shapes[bodies.shape[mask.row]], mask);
    mask.bits = mask.inside;
    mask.any = false;
    for (int z = mask.z0; z < mask.z1; ++z)
      for (int y = mask.y0; y < mask.y1; ++y) {
        std::uint64_t* const mine = mask.bits.data() + mask.row_index(y, z);
        std::uint64_t* const all = block.solid.at(y, z);
        for (int k = 0; k < mask.words; ++k) {
          mine[k] &= ~all[k];
          all[k] |= mine[k];
          mask.any |= mine[k] != 0;
        }
      }
    mask.cells = count_cells(block, mask);
  }
}

}  // namespace silt::coupler
