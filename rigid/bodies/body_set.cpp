#include "rigid/bodies/body_set.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

namespace silt::rigid {
namespace {

constexpr std::size_t bytes_of_columns() {
  std::size_t bytes = sizeof(AttachedState);
  visit_columns(
      [&](const BodyColumn&, auto, auto member) { bytes += sizeof(std::declval<BodyRecord&>().*member); });
  return bytes;
}
static_assert(sizeof(BodyRecord) == bytes_of_columns() + sizeof(BodyRecord::unused),
              "visit_columns has a line for every member");

/// Calls f for every array of the set that has one value per body.
template <class F>
void for_each_array(BodySet& b, F f) {
  visit_columns([&](const BodyColumn&, auto array, auto) { f(b.*array); });
  f(b.force);
  f(b.torque);
  f(b.attached_state);
  f(b.stored_impulses);
}

/// Copies a value between set and record: the same bytes, except for the order of a quaternion.
template <class From, class To>
void copy(const From& from, To& to) {
  static_assert(sizeof(From) == sizeof(To));
  std::memcpy(static_cast<void*>(&to), &from, sizeof(To));
}
void copy(const Quat& q, double (&to)[4]) {
  to[0] = q.w(), to[1] = q.x(), to[2] = q.y(), to[3] = q.z();
}
void copy(const double (&from)[4], Quat& to) {
  to = {from[0], from[1], from[2], from[3]};
}

/// Calls f(array, member) for the columns that are members of `Part`, a base of a record or a record.
template <class Part, class F>
void for_columns_of(F f) {
  visit_columns([&]<class Array, class Owner, class T>(const BodyColumn&, Array array, T Owner::*member) {
    if constexpr (std::is_base_of_v<Owner, Part>) f(array, member);
  });
}
template <class Part>
Part part_of(const BodySet& bodies, std::size_t row) {
  Part part;
  for_columns_of<Part>([&](auto array, auto member) { copy((bodies.*array)[row], part.*member); });
  return part;
}
template <class Part>
void set_part(BodySet& bodies, std::size_t row, const Part& part) {
  for_columns_of<Part>([&](auto array, auto member) { copy(part.*member, (bodies.*array)[row]); });
}

/// Returns an initial value; Eigen's default is uninitialised memory.
template <class T>
T blank() {
  if constexpr (std::is_same_v<T, Quat>)
    return Quat::Identity();
  else if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, Mat3>)
    return T::Zero();
  else
    return T{};
}

void sort_section(BodySet& b, std::size_t first, std::size_t last) {
  if (std::is_sorted(b.id.begin() + first, b.id.begin() + last)) return;
  std::vector<std::size_t> order(last - first);
  std::iota(order.begin(), order.end(), first);
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return b.id[i] < b.id[j]; });
  for_each_array(b, [&](auto& array) {
    auto sorted = array;
    for (std::size_t k = 0; k < order.size(); ++k) sorted[first + k] = std::move(array[order[k]]);
    array = std::move(sorted);
  });
}

/// Inverts the inertia restricted to the axes about which the body may turn; the other entries are zero.
Mat3 inverse_about_free_axes(const BodySet& bodies, std::size_t row) {
  const Mat3 r = bodies.orientation[row].toRotationMatrix();
  Mat3 inertia = r * bodies.inertia_B[row] * r.transpose();
  const auto locked = [&](int d) { return (bodies.locked(row) & locked_about(d)) != 0; };
  for (int d = 0; d < 3; ++d)
    if (locked(d)) inertia.row(d).setZero(), inertia.col(d).setZero(), inertia(d, d) = 1;
  Mat3 inverse = inertia.inverse();
  for (int d = 0; d < 3; ++d)
    if (locked(d)) inverse(d, d) = 0;
  return inverse;
}

}  // namespace

Kinematics BodySet::kinematics(std::size_t row) const {
  return part_of<Kinematics>(*this, row);
}

void BodySet::set_kinematics(std::size_t row, const Kinematics& k) {
  set_part(*this, row, k);
}

BodyRecord BodySet::record(std::size_t row) const {
  BodyRecord r = part_of<BodyRecord>(*this, row);
  r.attached_state = attached_state[row];
  return r;
}

void BodySet::assign(std::size_t row, const BodyRecord& r) {
  set_part(*this, row, r);
  attached_state[row] = r.attached_state;
}

void BodySet::insert(std::size_t row, const BodyRecord& r) {
  for_each_array(*this, [&](auto& array) {
    if (array.size() == array.capacity())
      array.reserve(array.size() + array.size() / 8 + 16);  // grows by an eighth instead of doubling
    array.insert(array.begin() + row, blank<typename std::decay_t<decltype(array)>::value_type>());
  });
  assign(row, r);
}

void BodySet::add(const BodyRecord& r) {
  insert(owned++, r);
}

void BodySet::erase(std::size_t row) {
  for_each_array(*this, [&](auto& array) { array.erase(array.begin() + row); });
}

void BodySet::resize(std::size_t rows) {
  for_each_array(*this, [&](auto& array) {
    array.resize(rows, blank<typename std::decay_t<decltype(array)>::value_type>());
  });
}

void BodySet::reindex() {
  sort_section(*this, 0, owned);
  sort_section(*this, owned, owned + copies);
  row_of_.assign(id);
}

std::size_t BodySet::row_of(BodyId wanted) const {
  // consecutive ids, as for a whole scene on one rank
  if (owned > 0 && wanted - id[0] < owned && id[wanted - id[0]] == wanted) return wanted - id[0];
  return row_of_.find(wanted, size());
}

bool BodySet::is_isotropic(std::size_t row) const {
  // Rounding can make the moments of a symmetric body differ by this much; real differences are larger.
  constexpr double tolerance = 1e-14;
  const Mat3& i = inertia_B[row];
  const double off = std::max({std::abs(i(0, 1)), std::abs(i(0, 2)), std::abs(i(1, 2)),
                               std::abs(i(0, 0) - i(1, 1)), std::abs(i(0, 0) - i(2, 2))});
  return off <= tolerance * i(0, 0);
}

Mat3 BodySet::inverse_inertia_W(std::size_t row) const {
  if (!is_dynamic(row)) return Mat3::Zero();
  if (locked(row) & locked_rotations) return inverse_about_free_axes(*this, row);
  if (is_isotropic(row)) return Mat3::Identity() * (1.0 / inertia_B[row](0, 0));
  const Mat3 r = orientation[row].toRotationMatrix();
  return r * inertia_B[row].inverse() * r.transpose();
}

double BodySet::kinetic_energy(std::size_t row) const {
  return 0.5 * mass[row] * velocity[row].squaredNorm() +
         0.5 * angular_velocity[row].dot(angular_momentum[row]);
}

void BodySet::set_pose(std::size_t row, const Pose& pose) {
  position[row] = pose.position;
  orientation[row] = pose.orientation.normalized();
  set_velocity(row, velocity[row], angular_velocity[row]);
}

void BodySet::set_velocity(std::size_t row, const Vec3& v, const Vec3& w) {
  velocity[row] = v;
  angular_velocity[row] = w;
  const Quat& q = orientation[row];
  angular_momentum[row] =
      is_isotropic(row) ? Vec3(inertia_B[row](0, 0) * w) : Vec3(q * (inertia_B[row] * (q.conjugate() * w)));
}

}  // namespace silt::rigid
