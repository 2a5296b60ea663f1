// Checks that the bodies of a checkpoint can be the state of a run of its case.
#include <fmt/format.h>

#include <cmath>
#include <span>
#include <tuple>

#include "coupler/exchange/coupling_state.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/results/checkpoint.hpp"

namespace silt {

namespace {

using rigid::BodyRecord;
using rigid::StoredImpulse;

// Lattice units. Far beyond what a run can come to, near enough that no sum of such numbers overflows.
constexpr double greatest = 0x1p61;        // masses, impulses, loads: of sums in fixed point
constexpr double fastest = 0x1p20;         // cells a step, radians a step
constexpr double furthest_outside = 1024;  // cells beyond a domain's length from it
constexpr std::int64_t most_periods = 1 << 30, most_quanta = std::int64_t{1} << 61,
                       most_steps = std::int64_t{1} << 53;

/// One row of a table.
class Row {
 public:
  Row(std::string table, std::uint64_t row, std::string body)
      : table_(std::move(table)), row_(row), body_(std::move(body)) {}

  /// Refuses a number that is not from low to high, and one that is not a number.
  template <class T, class Bound>
  void within(const char* column, const T& x, Bound low, Bound high) const {
    if (!(x >= low && x <= high))
      refuse(column, fmt::format("{}", x), fmt::format("from {} to {}", low, high));
  }
  template <class T, std::size_t n, class Bound>
  void within(const char* column, const T (&values)[n], Bound low, Bound high) const {
    for (const T x : values) within(column, x, low, high);
  }
  template <std::size_t n>
  void within(const char* column, const double (&values)[n], double most) const {
    within(column, values, -most, most);
  }
  void within(const rigid::HolderColumn& c, const rigid::HolderState& state, double most) const {
    for (const double x : state[c]) within(c.name, x, -most, most);
  }
  void whole_within(const rigid::HolderColumn& c, const rigid::HolderState& state, std::int64_t low,
                    std::int64_t high) const {
    for (const std::int64_t x : state.whole(c)) within(c.name, x, low, high);
  }
  void unit_quaternion(const char* column, std::span<const double, 4> q) const {
    for (const double x : q) within(column, x, -2.0, 2.0);
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (std::abs(square - 1) > 1e-6)
      refuse(column, fmt::format("of the square {}", square), "of the square 1");
  }
  [[noreturn]] void refuse(const char* column, const std::string& found, const std::string& allowed) const {
    throw std::runtime_error(fmt::format("{}/{}, row {} ({}): it is {}, and must be {}", table_, column, row_,
                                         body_, found, allowed));
  }

 private:
  std::string table_;
  std::uint64_t row_;
  std::string body_;
};

void require_inertia(const Row& row, const BodyRecord& r) {
  row.within("inertia_B", r.inertia_B, greatest);
  const rigid::Mat3 inertia = Eigen::Map<const rigid::Mat3>(r.inertia_B);
  if (!inertia.isApprox(inertia.transpose(), 1e-6) || inertia.llt().info() != Eigen::Success)
    row.refuse("inertia_B", "no tensor of inertia", "symmetric and positive");
}

void require_place(const Row& row, const char* column, const Case& setup, std::span<const double, 3> x) {
  for (int d = 0; d < 3; ++d) {
    const double beyond = setup.cells[d] + furthest_outside;
    row.within(column, x[d], -beyond, setup.cells[d] + beyond);
  }
}

template <class List>
std::int64_t last_of(const List& list) {
  return std::int64_t(list.size()) - 1;
}

void require_body(const Row& row, const Case& setup, const BodyRecord& r, rigid::BodyId next_id) {
  row.within("id", r.id, rigid::BodyId{1}, next_id - 1);
  row.within("shape", r.shape, std::int64_t{0}, last_of(setup.shapes));
  row.within("material", r.material, std::int64_t{0}, last_of(setup.material_names));
  row.within("kind", r.kind, std::int64_t{0}, last_of(setup.kind_names));
  row.within("motion", int(r.motion), 0, int(rigid::Motion::prescribed));
  row.within("mass", r.mass, std::numeric_limits<double>::min(), greatest);
  row.within("weight_in_fluid", r.weight_in_fluid, -greatest, 1.0);
  require_inertia(row, r);
  require_place(row, "position", setup, r.position);
  row.unit_quaternion("orientation", r.orientation);
  row.within("image", r.image, -most_periods, most_periods);
  row.within("velocity", r.velocity, fastest);
  row.within("angular_velocity", r.angular_velocity, fastest);
  row.within("angular_momentum", r.angular_momentum, greatest);
  const rigid::HolderState& held = r.holder_state;
  require_place(row, coupler::column::mapping_position.name, setup,
                held[coupler::column::mapping_position].first<3>());
  row.unit_quaternion(coupler::column::mapping_orientation.name,
                      held[coupler::column::mapping_orientation].first<4>());
  row.within(coupler::column::mapping_velocity, held, fastest);
  row.whole_within(coupler::column::mapping_steps, held, 0, most_steps);
  row.whole_within(coupler::column::impulse_debt, held, -most_quanta, most_quanta);
  row.whole_within(coupler::column::mass_owed, held, -most_quanta, most_quanta);
  for (const auto& c :
       {coupler::column::pending_impact, coupler::column::contact_load, coupler::column::deferred_impulse})
    row.within(c, held, greatest);
  row.within(coupler::column::foreseen_change, held, fastest);
  row.within(coupler::column::sprung_velocity, held, fastest);
}

bool is_wall_of(const Case& setup, rigid::BodyId id) {
  if (id >= rigid::first_tube_id) return id - rigid::first_tube_id < setup.walls.size();
  const coupler::BoundarySpec& side = setup.boundary[id - rigid::first_wall_id];
  return side.kind != coupler::BoundaryKind::periodic && side.solid_for_bodies;
}

void require_impulse(const Row& row, const Case& setup, const StoredImpulse& s, rigid::BodyId own,
                     rigid::BodyId next_id) {
  if (s.partner == own ||
      !(rigid::is_wall(s.partner) ? is_wall_of(setup, s.partner) : s.partner > 0 && s.partner < next_id))
    row.refuse("partner", fmt::format("{}", s.partner), "another body or a wall of the case");
  const int image[3] = {s.image.x, s.image.y, s.image.z};
  row.within("image", image, -1, 1);
  const double impulse[3] = {s.impulse[0], s.impulse[1], s.impulse[2]};
  row.within("impulse", impulse, greatest);
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
