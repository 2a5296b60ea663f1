// Vectors of one lane, of a register's, and of more do the same, lane by lane.
#define SILT_BUILD portable
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors wider than this machine's registers
#include "cpu/lanes.hpp"

#include <gtest/gtest.h>

#include <array>

namespace silt {
namespace {

template <class L, class T>
void does_lane_by_lane() {
  SCOPED_TRACE(L::count);
  constexpr int n = L::count;
  std::int32_t table[32], at[n];
  std::array<T, 64> from{}, to{};
  for (int k = 0; k < 32; ++k) table[k] = 7 * k - 50;
  for (int k = 0; k < 64; ++k) from[k] = T(k % 3 ? -0.1 : 0.3) * T(k);
  for (int l = 0; l < n; ++l) at[l] = 23 - 5 * l % 24;
  const auto index = load<typename L::Whole>(at), found = L::look_up(table, index);
  const auto x = L::gather(from.data(), at), size = L::magnitude(x), root = L::root(size),
             whole = L::real(index);
  L::scatter(to.data(), at, x);
  const auto negative = x < T(0);
  unsigned bits = 0;
  bool all = true;
  for (int l = 0; l < n; ++l) {
    EXPECT_EQ(found[l], table[at[l]]);
    EXPECT_EQ(x[l], from[at[l]]);
    EXPECT_EQ(to[at[l]], x[l]);
    EXPECT_EQ(size[l], std::abs(x[l]));
    EXPECT_EQ(root[l], std::sqrt(std::abs(x[l])));
    EXPECT_EQ(whole[l], T(at[l]));
    bits |= unsigned(x[l] < 0) << l;
    all &= x[l] < 0;
  }
  EXPECT_EQ(lane_bits(negative), bits);
  EXPECT_EQ(any_lane(negative), bits != 0);
  EXPECT_EQ(L::all(negative), all);
  for (int k = 0; k <= n; ++k) {
    EXPECT_EQ(lane_bits(L::below(k)), (1u << k) - 1);
    EXPECT_EQ(any_lane(L::below(k)), k > 0);
    EXPECT_EQ(L::all(L::below(k)), k == n);
  }
}

TEST(Lanes, OfAnyNumberDoTheSame) {
  does_lane_by_lane<Lanes<float, 1>, float>();
  does_lane_by_lane<Lanes<float>, float>();
  does_lane_by_lane<Lanes<float, 8>, float>();
  does_lane_by_lane<Lanes<double, 1>, double>();
  does_lane_by_lane<Lanes<double>, double>();
  does_lane_by_lane<Lanes<double, 8>, double>();
}

/// n elements in as many registers as they fill do what n elements by themselves do.
template <class E, int n>
void registers_do_as_elements() {
  SCOPED_TRACE(n);
  using R = Registers<E, n>;
  const auto a_of = [](int l) { return E(0.3) * E(l % 5 - 2); };
  const auto b_of = [](int l) { return E(0.7) - E(0.2) * E(l); };
  const R a = R::gathered(a_of), b = R::gathered(b_of);
  const auto less = a < b;
  const R sum = a + b, quotient = a / b, chosen = choose(less, a, b), most = larger(a, b),
          root = square_root(a * a), seven(E(7));
  E stored[n], largest_b = b_of(0);
  sum.store(stored);
  unsigned bits = 0;
  for (int l = 0; l < n; ++l) {
    const E x = a_of(l), y = b_of(l);
    EXPECT_EQ(stored[l], x + y);
    EXPECT_EQ(quotient[l], x / y);
    EXPECT_EQ(chosen[l], x < y ? x : y);
    EXPECT_EQ(most[l], x > y ? x : y);
    EXPECT_EQ(root[l], std::sqrt(x * x));
    EXPECT_EQ(seven[l], E(7));
    bits |= unsigned(x < y) << l;
    largest_b = std::max(largest_b, y);
  }
  EXPECT_EQ(lane_bits(less), bits);
  EXPECT_EQ(any_lane(less), bits != 0);
  EXPECT_EQ(largest(b), largest_b);
}

TEST(Registers, DoAsElementsByThemselves) {
  registers_do_as_elements<float, 8>();
  registers_do_as_elements<double, 2>();
  registers_do_as_elements<double, 8>();
}

}  // namespace
}  // namespace silt
