#include "rigid/bodies/body_set.hpp"

#include <algorithm>
#include <numeric>

namespace silt::rigid {
namespace {

/// Calls f with every array of the set: the one place that lists them.
template <class F>
void for_each_array(BodySet& b, F f) {
  f(b.id);
  f(b.shape);
  f(b.material);
  f(b.kind);
  f(b.motion);
  f(b.position);
  f(b.image);
  f(b.orientation);
  f(b.velocity);
  f(b.angular_velocity);
  f(b.angular_momentum);
  f(b.mass);
  f(b.weight_in_fluid);
  f(b.inertia_B);
  f(b.force);
  f(b.torque);
  f(b.holder_state);
  f(b.stored_impulses);
}

/// A value to start from; Eigen's own default is uninitialised memory.
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

/// The inverse of the inertia between the axes about which the body may turn, else zero.
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
  const auto store = [](const Vec3& v, double* to) { Eigen::Map<Vec3>{to} = v; };
  Kinematics k;
  const Quat& q = orientation[row];
  store(position[row], k.position);
  Eigen::Map<Eigen::Vector4d>{k.orientation} = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
  store(velocity[row], k.velocity);
  store(angular_velocity[row], k.angular_velocity);
  store(angular_momentum[row], k.angular_momentum);
  return k;
}

void BodySet::set_kinematics(std::size_t row, const Kinematics& k) {
  using Given = Eigen::Map<const Vec3>;
  position[row] = Given{k.position};
  orientation[row] = {k.orientation[0], k.orientation[1], k.orientation[2], k.orientation[3]};
  velocity[row] = Given{k.velocity};
  angular_velocity[row] = Given{k.angular_velocity};
  angular_momentum[row] = Given{k.angular_momentum};
}

BodyRecord BodySet::record(std::size_t row) const {
  BodyRecord r{kinematics(row),
               id[row],
               shape[row],
               material[row],
               kind[row],
               motion[row],
               {image[row][0], image[row][1], image[row][2]},
               mass[row],
               weight_in_fluid[row]};
  Eigen::Map<Mat3>{r.inertia_B} = inertia_B[row];
  r.holder_state = holder_state[row];
  return r;
}

void BodySet::assign(std::size_t row, const BodyRecord& r) {
  set_kinematics(row, r);
  id[row] = r.id;
  shape[row] = r.shape;
  material[row] = r.material;
  kind[row] = r.kind;
  motion[row] = r.motion;
  image[row] = std::to_array(r.image);
  mass[row] = r.mass;
  weight_in_fluid[row] = r.weight_in_fluid;
  inertia_B[row] = Eigen::Map<const Mat3>{r.inertia_B};
  holder_state[row] = r.holder_state;
}

void BodySet::insert(std::size_t row, const BodyRecord& r) {
  for_each_array(*this, [&](auto& array) {
    if (array.size() == array.capacity())
      array.reserve(array.size() + array.size() / 8 + 16);  // not the double
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
  // consecutive ids, as those of a whole scene on one rank
  if (owned > 0 && wanted - id[0] < owned && id[wanted - id[0]] == wanted) return wanted - id[0];
  return row_of_.find(wanted, size());
}

bool BodySet::is_isotropic(std::size_t row) const {
  // Rounding makes the moments of a symmetric body differ by this; a real difference is never as small.
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
