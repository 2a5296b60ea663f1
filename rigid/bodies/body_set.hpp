#pragma once
// The bodies a rank holds, as a structure of arrays. Rows, in this order:
//   [0, owned)             bodies whose centre of mass lies in this rank's blocks, sorted by id
//   [owned, owned+copies)  remote copies of bodies that reach into this rank's blocks, sorted by id
//   then                   visitors: partners of owned bodies in a contact, here for the rest of one step
//   only last              walls (global: on every rank, never sent)
// A copy equals its owner's state bitwise. On one rank there are only owned bodies and walls.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/math/exact_sum.hpp"
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// A table gives the row of a body by its id. It lies in one piece of memory, is filled again when rows
/// change, which on many ranks is most steps, and is asked several times a contact.
class RowTable {
 public:
  /// Row k is that of ids[k]; of equal ids the first.
  void assign(std::span<const BodyId> ids) {
    const std::size_t places = std::bit_ceil(2 * ids.size() + 1);
    places_.assign(places, {});
    shift_ = 64 - std::countr_zero(places);
    for (std::size_t row = 0; row < ids.size(); ++row) {
      Place& place = places_[of(ids[row])];
      if (place.row == none) place = {ids[row], row};
    }
  }
  /// The row of an id; `otherwise` if there is none.
  std::size_t find(BodyId id, std::size_t otherwise) const {
    if (places_.empty()) return otherwise;
    const Place& place = places_[of(id)];
    return place.row == none ? otherwise : place.row;
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};
  struct Place {
    BodyId id = 0;
    std::size_t row = none;
  };

  /// Returns the place where an id is, or would be. At most half of the places are taken.
  std::size_t of(BodyId id) const {
    constexpr std::uint64_t golden = 0x9E3779B97F4A7C15;  // spreads ids that follow one another
    std::size_t at = shift_ < 64 ? id * golden >> shift_ : 0;
    while (places_[at].row != none && places_[at].id != id) at = (at + 1) & (places_.size() - 1);
    return at;
  }

  std::vector<Place> places_;
  int shift_ = 64;
};

enum class Motion : std::uint8_t {
  free,        // moved by forces and contacts
  fixed,       // never moves, infinite mass
  prescribed,  // moves with its constant velocity and angular velocity, infinite mass
};

/// Axes of the world along which, or about which, nothing moves a free body: bits 0 to 2 of x, y and z, bits
/// 3 to 5 of rotation about them. Along the former its velocity stays, about the latter it does not turn.
using LockedAxes = std::uint8_t;
inline constexpr LockedAxes locked_along(int axis) {
  return static_cast<LockedAxes>(1 << axis);
}
inline constexpr LockedAxes locked_about(int axis) {
  return static_cast<LockedAxes>(8 << axis);
}
inline constexpr LockedAxes locked_rotations = 7 << 3;

/// Returns the part of a change of velocity that locked axes leave.
inline Vec3 without_locked(LockedAxes locked, Vec3 change) {
  for (int d = 0; d < 3; ++d)
    if (locked & locked_along(d)) change[d] = 0;
  return change;
}

/// The impulse of one contact in the previous step (world frame, acting on the pair's body b): the warm
/// start.
struct StoredImpulse {
  BodyId partner;  // the other body
  Image image;     // of b relative to a, as in Contact
  std::uint64_t feature;
  Vec3 impulse;
};

/// What a holder of bodies, such as a coupler, keeps with each: it travels with the body from rank to rank
/// and into checkpoints; rigid/ carries it along and never reads it. Zero until it is set.
struct alignas(8) HolderState {
  static constexpr std::size_t size = 496;
  std::byte bytes[size] = {};
};

/// The place and the motion of a body; trivially copyable, as all of a record.
struct Kinematics {
  double position[3] = {}, orientation[4] = {1, 0, 0, 0};  // w, x, y, z
  double velocity[3] = {}, angular_velocity[3] = {}, angular_momentum[3] = {};
};

/// A record has everything there is to know about one body but its stored impulses: what a message, a
/// checkpoint and a program that adds a body carry. Trivially copyable; meaning and units as in BodySet.
struct BodyRecord : Kinematics {
  BodyId id = 0;
  std::int32_t shape = 0, material = 0, kind = 0;
  Motion motion = Motion::free;
  std::int32_t image[3] = {};
  double mass = 1, weight_in_fluid = 1;
  double inertia_B[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  HolderState holder_state = {};
};

// ---- the columns of bodies: arrays of a set, members of a record ----

struct BodyIdentities {
  std::vector<BodyId> id;
  std::vector<std::int32_t> shape;     // index into the scene's shapes
  std::vector<std::int32_t> material;  // index into the scene's materials
  std::vector<std::int32_t> kind;      // which entry of the case made it (for output)
  std::vector<Motion> motion;
};

/// The position is canonical, wrapped into the domain; position + image * period is the unwrapped path.
struct BodyMotions {
  std::vector<Vec3> position;
  std::vector<std::array<std::int32_t, 3>> image;
  std::vector<Quat> orientation;
  std::vector<Vec3> velocity;          // W
  std::vector<Vec3> angular_velocity;  // W; equals I_W^-1 angular_momentum
  std::vector<Vec3> angular_momentum;  // W, about the centre of mass
};

struct BodyMasses {
  std::vector<double> mass;
  // weight in the fluid over that in vacuum, 1 - displaced mass / mass (method.md, M7). Stored as this ratio,
  // so that bodies of one density fall bitwise alike
  std::vector<double> weight_in_fluid;
  std::vector<Mat3> inertia_B;
};

struct BodySet : BodyIdentities, BodyMotions, BodyMasses {
  std::size_t owned = 0, copies = 0, visitors = 0, walls = 0;

  std::vector<LockedAxes> locked_of_kind;  // of the bodies of each kind; empty: none has any

  // what acts on it this step, besides gravity; any holder may add
  std::vector<FixedVec3> force, torque;  // W, about the centre of mass
  // the coupler's; travels with the body
  std::vector<HolderState> holder_state;
  // contact impulses of the previous step, sorted by (partner, image, feature); owned rows only
  std::vector<std::vector<StoredImpulse>> stored_impulses;

  std::size_t size() const { return id.size(); }
  std::size_t first_wall() const { return size() - walls; }
  /// Moved by contacts and forces. What is not has infinite mass.
  bool is_dynamic(std::size_t row) const { return motion[row] == Motion::free; }

  Kinematics kinematics(std::size_t row) const;
  void set_kinematics(std::size_t row, const Kinematics&);
  BodyRecord record(std::size_t row) const;
  void assign(std::size_t row, const BodyRecord&);  // all but forces and stored impulses
  /// Inserts before row, with zero force. Neither this nor erase touches the four counts above or the
  /// look-up: keeping the sections' order is the caller's business.
  void insert(std::size_t row, const BodyRecord&);
  void erase(std::size_t row);
  /// Appends to the owned bodies and counts it. Call reindex() after the last one.
  void add(const BodyRecord&);
  void resize(std::size_t rows);
  /// Sorts the owned and the copied section by id and rebuilds the look-up. Call after any change of rows.
  void reindex();
  /// Row of a body this rank holds in any role, or size() if none.
  std::size_t row_of(BodyId) const;

  LockedAxes locked(std::size_t row) const {
    return locked_of_kind.empty() ? LockedAxes{0} : locked_of_kind[kind[row]];
  }
  /// Returns the part of a change of a body's velocity that its locked axes leave.
  Vec3 unlocked(std::size_t row, const Vec3& change) const {
    return locked(row) == 0 ? change : without_locked(locked(row), change);
  }
  /// Zero unless free, and about locked axes.
  Mat3 inverse_inertia_W(std::size_t row) const;
  bool is_isotropic(std::size_t row) const;  // the same moment of inertia about every axis
  /// Mass of the fluid that the body displaces.
  double displaced_mass(std::size_t row) const { return mass[row] * (1 - weight_in_fluid[row]); }
  double inverse_mass(std::size_t row) const { return is_dynamic(row) ? 1.0 / mass[row] : 0.0; }
  Pose pose(std::size_t row) const { return {position[row], orientation[row]}; }
  Twist twist(std::size_t row) const { return {velocity[row], angular_velocity[row]}; }
  Vec3 velocity_at(std::size_t row, const Vec3& r_W) const {
    return velocity[row] + angular_velocity[row].cross(r_W);
  }
  double kinetic_energy(std::size_t row) const;

  void add_force(std::size_t row, const Vec3& force_W) { force[row].add(force_W); }
  void add_torque(std::size_t row, const Vec3& torque_W) { torque[row].add(torque_W); }
  /// Both keep angular velocity and momentum consistent (with a new pose the angular velocity stays).
  void set_pose(std::size_t row, const Pose&);
  void set_velocity(std::size_t row, const Vec3& velocity, const Vec3& angular_velocity);

 private:
  RowTable row_of_;
};

/// What the numbers of a column are, and with it what a checkpoint may hold of them.
enum class Values {
  id,
  shape,
  material,
  kind,
  motion,
  mass,
  weight_in_fluid,
  inertia,
  place,        // a point in the domain or not far outside
  orientation,  // a unit quaternion
  periods,
  velocity,  // or angular velocity
  impulse,   // or momentum or load, linear or angular
  step,
  quanta,  // of a sum in integers
};

struct BodyColumn {
  const char* name;
  Values values;
};

/// Calls visit(column, array of a set, member of a record) for each column that both have but the holder's,
/// in the order of checkpoints.
template <class Visit>
constexpr void visit_columns(Visit&& visit) {
  using Set = BodySet;
  using Record = BodyRecord;
  visit(BodyColumn{"id", Values::id}, &Set::id, &Record::id);
  visit(BodyColumn{"shape", Values::shape}, &Set::shape, &Record::shape);
  visit(BodyColumn{"material", Values::material}, &Set::material, &Record::material);
  visit(BodyColumn{"kind", Values::kind}, &Set::kind, &Record::kind);
  visit(BodyColumn{"motion", Values::motion}, &Set::motion, &Record::motion);
  visit(BodyColumn{"mass", Values::mass}, &Set::mass, &Record::mass);
  visit(BodyColumn{"weight_in_fluid", Values::weight_in_fluid}, &Set::weight_in_fluid,
        &Record::weight_in_fluid);
  visit(BodyColumn{"inertia_B", Values::inertia}, &Set::inertia_B, &Record::inertia_B);
  visit(BodyColumn{"position", Values::place}, &Set::position, &Record::position);
  visit(BodyColumn{"orientation", Values::orientation}, &Set::orientation, &Record::orientation);
  visit(BodyColumn{"image", Values::periods}, &Set::image, &Record::image);
  visit(BodyColumn{"velocity", Values::velocity}, &Set::velocity, &Record::velocity);
  visit(BodyColumn{"angular_velocity", Values::velocity}, &Set::angular_velocity, &Record::angular_velocity);
  visit(BodyColumn{"angular_momentum", Values::impulse}, &Set::angular_momentum, &Record::angular_momentum);
}

/// Returns the numbers that a member consists of.
template <class Number, class Member>
std::span<const Number> numbers_of(const Member& member) {
  return {reinterpret_cast<const Number*>(&member), sizeof member / sizeof(Number)};
}

/// Calls visit(column, its numbers) for the same columns of a record.
template <class Visit>
void visit_columns(const BodyRecord& record, Visit&& visit) {
  visit_columns([&](const BodyColumn& column, auto, auto member) {
    using Value = std::remove_cvref_t<decltype(record.*member)>;
    if constexpr (std::is_enum_v<Value>)
      visit(column, numbers_of<std::underlying_type_t<Value>>(record.*member));
    else
      visit(column, numbers_of<std::remove_extent_t<Value>>(record.*member));
  });
}

}  // namespace silt::rigid
