// The passes over cells and links as a card runs them, with plain numbers in the place of vectors, and as the
// device `host` does, against the kernels of the processor: the same bits.
#define SILT_BUILD plain
#define SILT_SCALAR
#define SILT_AT_ONCE
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "lbm/passes/block_passes.hpp"
#include "lbm/passes/border_passes.hpp"
#include "lbm/passes/passes_build.hpp"
#include "lbm/walls/link_passes_build.hpp"

namespace silt::lbm {
namespace {

template <class T>
void stir(Block<T>& block) {
  for (std::size_t k = 0; k < block.bytes() / sizeof(T); ++k)
    block.data()[k] = T(0.02 * std::sin(double(k) * 0.7));
  block.hold_excess({0, block.size().y, 0, block.size().z}, T(0.3));
  for (std::size_t k = 0; k < block.excess_cells(); k += 5)
    block.excess()[k] = ExcessQuanta<T>(1e-4 / excess_quantum<T> * std::sin(double(k)));
}

template <class T>
struct Outcome {
  std::vector<T> populations;
  std::vector<ExcessQuanta<T>> excess;
  std::vector<std::int64_t> sums;
  explicit Outcome(Block<T>& block, std::vector<std::int64_t> of = {})
      : populations(block.data(), block.data() + block.bytes() / sizeof(T)),
        excess(block.excess(), block.excess() + block.excess_cells()),
        sums(std::move(of)) {}
  bool operator==(const Outcome&) const = default;
};

constexpr Int3 cells{37, 9, 11};

template <class T, class Collide>
Outcome<T> collided(const CollisionSpec& spec, const HeatSpec* carried, Parity parity, Collide&& collide) {
  Block<T> block({{}, cells});
  stir(block);
  block.add_row_end(parity, {block.arriving(7, parity), block.arriving(8, parity), true, T(0.001)});
  CollisionRates<T> rates(spec);
  Block<T, D3Q7> heat({{}, cells});
  std::optional<HeatRates<T>> heat_rates;
  if (carried) {
    for (std::size_t k = 0; k < heat.bytes() / sizeof(T); ++k)
      heat.data()[k] = T(0.1 + 0.02 * std::sin(double(k) * 0.3));
    heat.add_row_end(parity, {heat.arriving(1, parity), heat.arriving(2, parity), true, T(0.001)});
    rates.heat = &heat_rates.emplace(*carried, spec), block.carry(heat);
  }
  collide(block, parity, rates, RowRange{0, cells.y, 0, cells.z});
  Outcome<T> found(block);
  if (carried)
    found.populations.insert(found.populations.end(), heat.data(), heat.data() + heat.bytes() / sizeof(T));
  return found;
}

template <class T>
void expect_same_collisions(const CollisionSpec& spec, const HeatSpec* heat = nullptr) {
  for (const Parity parity : {Parity::settled, Parity::crossed}) {
    const auto on = [&](const Passes<T>& passes, Device device) {
      return collided<T>(spec, heat, parity, [&](auto& block, Parity p, const auto& rates, RowRange rows) {
        passes.stream_collide(block, p, rates, rows, {fast_list(device), 0, 3});
        passes.wait(), take_fast_cells(device);
      });
    };
    const Outcome<T> expected = on(cpu::passes<T>(), Device::cpu);
    EXPECT_EQ(on(plain::passes<T>(), Device::cpu), expected);
    EXPECT_EQ(on(passes_on<T>(Device::host), Device::host), expected);
  }
}

template <class T>
void expect_same_in_all_models() {
  for (const auto& [model, tau] : {std::pair(Collision::trt, 0.6), std::pair(Collision::regularised, 0.51),
                                   std::pair(Collision::regularised, 0.7)})
    for (const double force : {0., 1e-4})
      expect_same_collisions<T>({tau, 3. / 16, model, {force, 0, 0}, 0.1});
  const HeatSpec heat{0.05, {1e-4, 0, 2e-4}};
  expect_same_collisions<T>({0.6, 3. / 16, Collision::trt, {1e-4, 0, 0}}, &heat);
  expect_same_collisions<T>({0.51, 3. / 16, Collision::regularised, {}, 0.1}, &heat);
}
TEST(PlainPasses, CollideAsTheKernels) {
  expect_same_in_all_models<float>();
  expect_same_in_all_models<double>();
}

/// Links in all directions along z, in groups of the scheme, of another in gaps, and with pairs across.
template <class T>
CutLinks<T> some_links(WallScheme scheme) {
  CutLinks<T> links;
  links.fluid = WallFluid<T>(CollisionSpec{0.6, 3. / 16, Collision::trt, {1e-4, 2e-4, 0}});
  links.frame = {{12, 5, 4}, {0.2, -0.3, 0.1}, 40, true};
  links.age = T(2);
  for (const int z : {2, 5, 8}) {
    const bool gap = z == 5;
    LinkGroup group{
        std::uint32_t(links.place.size()), 0, gap ? WallScheme::single_cell_gap : scheme, {0, 0, z}, 0};
    group.across = z == 8 && reads_beyond(scheme);
    for (std::uint32_t n = 0; group.count < 45; ++n) {
      const int i = 1 + int(n) % (D3Q19::directions - 1), cell = int(n) / (D3Q19::directions - 1);
      if (D3Q19::c[i].z != 1) continue;
      links.place.push_back(link_place({2 + cell % 32, 2 + cell / 32, 0}, i)), ++group.count;
      links.q.push_back(T(0.05 + 0.9 * (n % 31) / 31.0)), links.rate.push_back(T(0.01 * std::sin(double(n))));
      links.across.push_back((n * 7) % 64);
    }
    for (auto* values : {&links.q, &links.rate})
      values->resize(group.begin + padded(group.count), values->back());
    for (auto* values : {&links.place, &links.across})
      values->resize(group.begin + padded(group.count), values->back());
    group.across_begin = group.opposite = group.begin;
    links.groups.push_back(group);
  }
  links.opposite_q.assign(links.q.begin(), links.q.end()),
      links.opposite_u.assign(links.rate.begin(), links.rate.end());
  return links;
}

constexpr SurfaceMotion motion{{0.01, -0.02, 0.03}, {1e-3, 2e-3, -1e-3}, 17};
constexpr SurfaceIncrement increment{{0.001, 0.002, -0.003}, {1e-4, -2e-4, 3e-4}};

template <class T>
std::vector<std::int64_t> numbers(const LinkSums& s) {
  return {s.force[0], s.force[1], s.force[2], s.torque[0], s.torque[1], s.torque[2], s.invalid};
}

template <class T>
Outcome<T> by_kernels(const CutLinks<T>& links, const std::vector<BeyondPair<T>>& pairs) {
  Block<T> block({{}, cells});
  stir(block);
  const LinkSlots slots = link_slots(block, Parity::settled);
  LinkSums sums;
  for (const LinkGroup& group : links.groups)
    apply_cut_links<T>({block, slots, links, group, {}, pairs.data()}, motion, ForceForm::galilean, sums);
  SurfaceMotion more;
  for (int d = 0; d < 3; ++d) more.v[d] = increment.v[d], more.omega[d] = increment.omega[d];
  for (const LinkGroup& group : links.groups) correct_cut_links<T>({block, slots, links, group}, more);
  return Outcome<T>(block, numbers<T>(sums));
}

/// Spoils what nothing sets beyond the last link of a group: the walls on the other side of gaps and, on a
/// device, which completes the places of the last vector alone, the distances.
template <class T>
CutLinks<T> spoiled(CutLinks<T> links, Device device) {
  for (const LinkGroup& g : links.groups)
    for (auto* values : {&links.q, &links.rate, &links.opposite_q, &links.opposite_u})
      for (std::uint32_t l = g.begin + g.count; l < g.begin + padded(g.count); ++l)
        if (device != Device::cpu || values == &links.opposite_q || values == &links.opposite_u)
          (*values)[l] = T(77);
  return links;
}

template <class T>
Outcome<T> by_passes(const LinkPasses<T>& passes, CutLinks<T> links, const std::vector<BeyondPair<T>>& pairs,
                     void (*wait)()) {
  Block<T> block({{}, cells});
  stir(block);
  const LinkSlots slots = link_slots(block, Parity::settled);
  constexpr double now = 5;
  const DeviceSurface<T> surface = device_surface(links, links.groups.data(), now - links.age);
  const ListedSurface<T> listed{&surface, 0, 0};
  LinkSums sums;
  const LinkPass<T> pass{block.data() + block.middle(),
                         std::int32_t(block.row_stride()),
                         std::int32_t(block.plane_stride()),
                         block.excess(),
                         &slots,
                         links.fluid,
                         &listed,
                         now,
                         &motion,
                         {&increment, 1},
                         &sums,
                         pairs.data(),
                         true};
  const std::vector<GroupOfSurface> groups = {{0, 0}, {0, 1}, {0, 2}};
  passes.apply(groups, pass), passes.correct(groups, pass), wait();
  return Outcome<T>(block, numbers<T>(sums));
}

template <class T>
void expect_same_links() {
  std::vector<BeyondPair<T>> pairs;
  for (int k = 0; k < 64; ++k) pairs.push_back({T(0.01 * std::cos(k)), T(0.01 * std::sin(k))});
  for (const WallScheme scheme :
       {WallScheme::bounce_back, WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection}) {
    SCOPED_TRACE(wall_scheme_names[int(scheme)]);
    const CutLinks<T> links = some_links<T>(scheme);
    const Outcome<T> expected = by_kernels(links, pairs);
    EXPECT_EQ(expected.sums.back(), 0);
    EXPECT_EQ(by_kernels(spoiled(links, Device::cpu), pairs), expected);
    EXPECT_EQ(by_passes(plain::link_passes<T>(), spoiled(links, Device::host), pairs, [] {}), expected);
    EXPECT_EQ(by_passes(SILT_OFF_CPU(Device::host, link_passes<T>)(), spoiled(links, Device::host), pairs,
                        [] { wait(Device::host); }),
              expected);
  }
}
TEST(PlainPasses, ApplyAndCorrectLinksAsTheKernels) {
  expect_same_links<float>();
  expect_same_links<double>();
}

}  // namespace
}  // namespace silt::lbm
