// Checks that the bodies of a checkpoint can be a state of a run of its case.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "coupler/exchange/coupling_state.hpp"
#include "silt/case/case.hpp"
#include "silt/results/checkpoint.hpp"

namespace silt {

namespace {

using rigid::BodyRecord;
using rigid::StoredImpulse;
using rigid::Values;

// Limits in lattice units: far above those of any run, but sums of such numbers do not overflow.
constexpr double greatest = 0x1p61;        // masses, impulses, loads: summed in fixed point
constexpr double fastest = 0x1p20;         // cells per step, radians per step
constexpr double furthest_outside = 1024;  // cells beyond one domain length from the domain
constexpr std::int64_t most_periods = 1 << 30, most_quanta = std::int64_t{1} << 61,
                       most_steps = std::int64_t{1} << 53;

/// A row of a table.
class Row {
 public:
  Row(std::string table, std::uint64_t row, std::string body)
      : table_(std::move(table)), row_(row), body_(std::move(body)) {}

  /// Rejects a number outside [low, high], and NaN.
  template <class T, class Bound>
  void within(const char* column, std::span<const T> numbers, Bound low, Bound high) const {
    for (const T x : numbers)
      if (!is_within(x, low, high))
        refuse(column, fmt::format("{}", x), fmt::format("from {} to {}", low, high));
  }
  [[noreturn]] void refuse(const char* column, const std::string& found, const std::string& allowed) const {
    throw std::runtime_error(fmt::format("{}/{}, row {} ({}): it is {}, and must be {}", table_, column, row_,
                                         body_, found, allowed));
  }

 private:
  template <class T, class Bound>
  static bool is_within(T x, Bound low, Bound high) {
    if constexpr (std::is_integral_v<T> && std::is_integral_v<Bound>)
      return std::cmp_less_equal(low, x) && std::cmp_less_equal(x, high);
    else
      return low <= x && x <= high;
  }

  std::string table_;
  std::uint64_t row_;
  std::string body_;
};

template <class T>
void require_inertia(const Row& row, const char* column, std::span<const T> x) {
  row.within(column, x, -greatest, greatest);
  rigid::Mat3 inertia;
  std::copy_n(x.begin(), 9, inertia.data());
  if (!inertia.isApprox(inertia.transpose(), 1e-6) || inertia.llt().info() != Eigen::Success)
    row.refuse(column, "no tensor of inertia", "symmetric and positive");
}

template <class T>
void require_place(const Row& row, const char* column, const Case& setup, std::span<const T> x) {
  for (int d = 0; d < 3; ++d) {
    const double beyond = setup.cells[d] + furthest_outside;
    row.within(column, x.subspan(d, 1), -beyond, setup.cells[d] + beyond);
  }
}

template <class T>
void require_unit_quaternion(const Row& row, const char* column, std::span<const T> q) {
  row.within(column, q, -2.0, 2.0);
  const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (std::abs(square - 1) > 1e-6)
    row.refuse(column, fmt::format("of the square {}", square), "of the square 1");
}

/// Checks the numbers of a column by their meaning.
template <class T>
void require_column(const Row& row, const Case& setup, rigid::BodyId next_id, const rigid::BodyColumn& c,
                    std::span<const T> x) {
  const auto within = [&](auto low, auto high) { row.within(c.name, x, low, high); };
  const auto index_of = [&](const auto& list) { within(std::int64_t{0}, std::int64_t(list.size()) - 1); };
  switch (c.values) {
    case Values::id:
      return within(rigid::BodyId{1}, next_id - 1);
    case Values::shape:
      return index_of(setup.shapes);
    case Values::material:
      return index_of(setup.material_names);
    case Values::kind:
      return index_of(setup.kind_names);
    case Values::motion:
      return within(0, int(rigid::Motion::prescribed));
    case Values::mass:
      return within(std::numeric_limits<double>::min(), greatest);
    case Values::weight_in_fluid:
      return within(-greatest, 1.0);
    case Values::inertia:
      return require_inertia(row, c.name, x);
    case Values::place:
      return require_place(row, c.name, setup, x);
    case Values::orientation:
      return require_unit_quaternion(row, c.name, x);
    case Values::periods:
      return within(-most_periods, most_periods);
    case Values::velocity:
      return within(-fastest, fastest);
    case Values::impulse:
    case Values::heat:
      return within(-greatest, greatest);
    case Values::step:
      return within(std::int64_t{0}, most_steps);
    case Values::quanta:
      return within(-most_quanta, most_quanta);
  }
}

void require_body(const Row& row, const Case& setup, const BodyRecord& r, rigid::BodyId next_id) {
  const auto require = [&](const rigid::BodyColumn& c, auto numbers) {
    require_column(row, setup, next_id, c, numbers);
  };
  visit_columns(r, require);
  visit_columns(coupler::coupling_of(r.attached_state), [&](const coupler::CouplingColumn& c, auto numbers) {
    if (c.saved) require(c, numbers);
  });
}

bool is_wall_of(const Case& setup, rigid::BodyId id) {
  if (id >= rigid::first_tube_id) return id - rigid::first_tube_id < setup.walls.size();
  return setup.boundary[id - rigid::first_wall_id].stops_bodies();
}

void require_impulse(const Row& row, const Case& setup, const StoredImpulse& s, rigid::BodyId own,
                     rigid::BodyId next_id) {
  if (s.partner == own ||
      !(rigid::is_wall(s.partner) ? is_wall_of(setup, s.partner) : s.partner > 0 && s.partner < next_id))
    row.refuse("partner", fmt::format("{}", s.partner), "another body or a wall of the case");
  const int image[3] = {s.image.x, s.image.y, s.image.z};
  row.within("image", std::span<const int>(image), -1, 1);
  row.within("impulse", std::span<const double>(s.impulse.data(), 3), -greatest, greatest);
}

}  // namespace

void require_possible(const Case& setup, const adapters::CheckpointReader::Bodies& bodies,
                      rigid::BodyId next_id) {
  std::uint64_t impulse = bodies.first_impulse;
  for (std::size_t i = 0; i < bodies.records.size(); ++i) {
    const BodyRecord& r = bodies.records[i];
    const std::string name = fmt::format("body {}", r.id);
    require_body(Row("/bodies", bodies.first_body + i, name), setup, r, next_id);
    const StoredImpulse* before = nullptr;
    for (const StoredImpulse& s : bodies.impulses[i]) {
      const Row row("/impulses", impulse++, name);
      require_impulse(row, setup, s, r.id, next_id);
      if (before && std::tie(before->partner, before->image, before->feature) >=
                        std::tie(s.partner, s.image, s.feature))
        row.refuse("partner", "out of its order", "sorted by partner, image and feature");
      before = &s;
    }
  }
}

}  // namespace silt
