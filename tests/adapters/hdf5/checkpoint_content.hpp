#pragma once
// What the tests of checkpoints write: populations of any bits, bodies unlike each other.
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "tests/adapters/hdf5/scratch.hpp"

namespace silt::tests {

using adapters::CellBox;
using adapters::CheckpointReader;
using adapters::CheckpointWriter;
using rigid::BodyRecord;
using rigid::StoredImpulse;

inline constexpr std::array<int, 3> cells{11, 6, 9};
inline constexpr int populations = 19, bodies_in_all = 37;

template <class T>
using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;

/// Any bits at all, among them -0.0, denormals, infinities and NaNs with a payload.
template <class T>
Bits<T> bits_of(int q, int x, int y, int z) {
  const std::uint64_t n = ((q * 100ull + z) * 100 + y) * 100 + x;
  const Bits<T> sign = Bits<T>{1} << (8 * sizeof(T) - 1);
  switch (n % 7) {
    case 0:
      return sign;  // -0.0
    case 1:
      return static_cast<Bits<T>>(n + 1);  // denormal
    case 2:
      return std::bit_cast<Bits<T>>(std::numeric_limits<T>::signaling_NaN()) | Bits<T>(n);  // NaN, payload
    case 3:
      return 0;
    case 4:
      return std::bit_cast<Bits<T>>(-std::numeric_limits<T>::infinity());
    default:
      return std::bit_cast<Bits<T>>(static_cast<T>(std::sin(double(n))));
  }
}

template <class T>
void write_populations(CheckpointWriter& writer, const std::vector<CellBox>& boxes) {
  constexpr auto storage = sizeof(T) == 4 ? adapters::Storage::single : adapters::Storage::double_;
  writer.cells("populations", storage, cells, populations, boxes, [&](int q, std::size_t box, void* out) {
    for_each_cell(boxes[box], [&](int x, int y, int z, std::size_t i) {
      const auto bits = bits_of<T>(q, x, y, z);
      std::memcpy(static_cast<T*>(out) + i, &bits, sizeof bits);
    });
  });
}

template <class T>
std::size_t wrong_populations(const CheckpointReader& reader, const std::vector<CellBox>& boxes) {
  std::size_t wrong = 0;
  constexpr auto storage = sizeof(T) == 4 ? adapters::Storage::single : adapters::Storage::double_;
  reader.cells("populations", storage, boxes, [&](int q, std::size_t box, const void* in) {
    for_each_cell(boxes[box], [&](int x, int y, int z, std::size_t i) {
      const auto bits = bits_of<T>(q, x, y, z);
      wrong += std::memcmp(static_cast<const T*>(in) + i, &bits, sizeof bits) != 0;
    });
  });
  return wrong;
}

inline std::uint8_t flag(int x, int y, int z) {
  return (x * 7 + y * 3 + z) % 5 == 0;
}

/// Columns that a holder might keep.
inline constexpr adapters::AttachedColumn kept_columns[] = {
    {"kept_number", adapters::AttachedColumn::float64, 8, 2},
    {"kept_whole", adapters::AttachedColumn::int64, 40, 3}};

inline BodyRecord record(std::uint64_t id) {
  BodyRecord r;
  r.id = id;
  r.shape = int(id % 3);
  r.kind = -int(id);
  r.motion = static_cast<rigid::Motion>(id % 3);
  r.mass = std::nextafter(double(id), 0);
  for (int d = 0; d < 3; ++d) {
    r.position[d] = std::sin(id + d);
    r.image[d] = int(id) - d;
    r.velocity[d] = -0.0;
    r.angular_momentum[d] = 5e-324 * double(id);
  }
  const auto keep = [&](std::size_t at, auto x) { std::memcpy(r.attached_state.bytes + at, &x, sizeof x); };
  keep(kept_columns[0].offset + 8, 0.1 * double(id));
  for (int d = 0; d < 3; ++d)
    keep(kept_columns[1].offset + 8 * d, std::int64_t{1} << 62 ^ std::int64_t(id) * (d - 2));
  return r;
}

inline std::vector<StoredImpulse> impulses(std::uint64_t id) {
  std::vector<StoredImpulse> list;
  for (std::uint64_t i = 0; i < id % 4; ++i)
    list.push_back({id + 1 + i,
                    {std::int8_t(i % 3 - 1), 0, 1},
                    id << 32 | i,
                    rigid::Vec3(0.1 * double(i), -0.0, 1.0 / id)});
  return list;
}

inline void expect_equal(const BodyRecord& a, const BodyRecord& b) {
  const auto same = [](const auto& x, const auto& y) { return std::memcmp(&x, &y, sizeof x) == 0; };
  rigid::visit_columns([&](const rigid::BodyColumn& c, auto, auto member) {
    EXPECT_TRUE(same(a.*member, b.*member)) << c.name << " of body " << b.id;
  });
  EXPECT_TRUE(same(a.attached_state, b.attached_state)) << "body " << b.id;
}

}  // namespace silt::tests
