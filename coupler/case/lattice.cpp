#include "coupler/case/lattice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/body_text.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/case_extent.hpp"
#include "coupler/case/counter_random.hpp"
#include "coupler/case/fill_room.hpp"

namespace silt::coupler {
namespace {

constexpr double rounding = 1e-9;  // of a length that is a whole number of steps

/// The distances of rows and of layers over that of neighbours; how many of them repeat the pattern.
struct Pattern {
  double rows, layers;
  int repeat;
};

Pattern pattern_of(Arrangement arrangement) {
  if (arrangement != Arrangement::hexagonal) return {1, 1, 1};
  return {std::sqrt(0.75), std::sqrt(2. / 3), 2};  // closest: layers ABAB
}

}  // namespace

Lattice::Lattice(const rigid::BoundingBox& room, const rigid::Extent& extent, Arrangement arrangement,
                 double spacing, std::uint64_t stream)
    : arrangement_(arrangement), room_(room), stream_(stream) {
  const Pattern pattern = pattern_of(arrangement);
  const double factors[3] = {1, pattern.rows, pattern.layers};
  for (int d = 0; d < 3; ++d) {
    const double length = room.upper[d] - room.lower[d], least = spacing * factors[d];
    round_[d] = extent.periodic[d] && length >= extent.size[d];
    const auto fit = static_cast<std::int64_t>(std::floor(std::max(-1.0, length / least + rounding)));
    const int repeat = d == 0 ? 1 : pattern.repeat;
    count_[d] = round_[d] ? fit / repeat * repeat : fit + 1;
    step_[d] = round_[d] && count_[d] > 0 ? length / static_cast<double>(count_[d]) : least;
    const double used = static_cast<double>(count_[d] - 1) * step_[d];
    const bool shifted = arrangement == Arrangement::layers && d < 2;
    first_[d] = room.lower[d] + (round_[d] ? step_[d] / 2 : shifted ? 0 : (length - used) / 2);
  }
}

/// The shift of a layer along x and y.
std::array<double, 2> Lattice::layer_offset(std::int64_t layer) const {
  if (arrangement_ == Arrangement::hexagonal && layer % 2 != 0) return {step_[0] / 2, step_[1] / 3};
  if (arrangement_ != Arrangement::layers) return {0, 0};
  CounterRandom random(mixed(stream_ ^ mixed(static_cast<std::uint64_t>(layer))));
  const double x = random.uniform(), y = random.uniform();
  return {x * step_[0], y * step_[1]};
}

rigid::Vec3 Lattice::site(const Index& i) const {
  const auto [x, y] = layer_offset(i[2]);
  const double row = arrangement_ == Arrangement::hexagonal && i[1] % 2 != 0 ? step_[0] / 2 : 0;
  rigid::Vec3 site;
  for (int d = 0; d < 3; ++d) site[d] = first_[d] + static_cast<double>(i[d]) * step_[d];
  return site + rigid::Vec3(x + row, y, 0);
}

bool Lattice::in_room(const rigid::Vec3& site) const {
  for (int d = 0; d < 3; ++d)
    if (!round_[d] && (site[d] < room_.lower[d] - rounding || site[d] > room_.upper[d] + rounding))
      return false;
  return true;
}

Lattice lattice_of(const Case& scene, FillApplication application, double radius) {
  const std::size_t index = application.fill;
  const FillSpec& fill = scene.fills[index];
  const rigid::Extent extent = extent_of(scene);
  const double least = 2 * radius + fill.gap + 2 * fill.shift;
  const double spacing = fill.spacing > 0 ? fill.spacing : least;
  if (spacing < least * (1 - rounding))
    throw CaseError(scene.place(fmt::format("fill[{}].spacing", index)),
                    fmt::format("fill[{}].spacing is {}; it must be at least {}: the diameter of a body's "
                                "bounding sphere, the gap and twice the shift",
                                index, shown_length(scene, spacing), shown_length(scene, least)));
  rigid::BoundingBox room = room_for_centres(scene, index, radius);
  for (int d = 0; d < 3; ++d) {
    if (extent.periodic[d] && room.upper[d] - room.lower[d] >= extent.size[d]) continue;
    room.lower[d] += fill.shift;
    room.upper[d] -= fill.shift;
  }
  return Lattice(room, extent, fill.arrangement, spacing, mixed(fill.seed) ^ mixed(~application.stream()));
}

}  // namespace silt::coupler
