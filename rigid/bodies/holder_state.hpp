#pragma once
// Columns that a holder of bodies, such as a coupler, keeps with them. They travel with a body from rank to
// rank and into checkpoints; rigid/ carries them along and never reads them.
#include <cstdint>
#include <span>
#include <type_traits>

namespace silt::rigid {

/// A HolderColumn has so many numbers of one type for each body.
struct HolderColumn {
  const char* name;
  enum Type { float64, int64 } type;
  int first, count;  // of the numbers of its type

  /// The column of the same type that comes after it.
  constexpr HolderColumn next(const char* its_name, int its_count) const {
    return {its_name, type, first + count, its_count};
  }
  constexpr int end() const { return first + count; }
};

/// What a body has in all columns; zero until it is set.
struct HolderState {
  static constexpr int most_numbers = 40, most_integers = 8;
  double numbers[most_numbers] = {};
  std::int64_t integers[most_integers] = {};

  /// The numbers of a column, of the type float64 or int64; none of a column of the other one.
  std::span<double> operator[](const HolderColumn& c) { return {numbers + c.first, of(c, c.float64)}; }
  std::span<const double> operator[](const HolderColumn& c) const {
    return {numbers + c.first, of(c, c.float64)};
  }
  std::span<std::int64_t> whole(const HolderColumn& c) { return {integers + c.first, of(c, c.int64)}; }
  std::span<const std::int64_t> whole(const HolderColumn& c) const {
    return {integers + c.first, of(c, c.int64)};
  }

 private:
  static std::size_t of(const HolderColumn& c, HolderColumn::Type type) {
    return c.type == type ? std::size_t(c.count) : 0;
  }
};
static_assert(std::is_trivially_copyable_v<HolderState>);

}  // namespace silt::rigid
