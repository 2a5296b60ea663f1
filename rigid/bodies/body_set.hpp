#pragma once
// The bodies of a rank, as a structure of arrays with the rows
//   [0, owned)             bodies whose centre of mass lies in this rank's blocks, sorted by id
//   [owned, owned+copies)  copies of remote bodies that reach into this rank's blocks, sorted by id
//   then                   visitors: contact partners of owned bodies, held for the rest of one step
//   last                   walls (on every rank, never sent)
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

/// A hash table from body id to row, with open addressing in one array: it is rebuilt whenever rows change,
/// on many ranks in most steps, and is read several times per contact.
class RowTable {
 public:
  /// Makes k the row of ids[k]; of equal ids the first counts.
  void assign(std::span<const BodyId> ids) {
    const std::size_t places = std::bit_ceil(2 * ids.size() + 1);
    places_.assign(places, {});
    shift_ = 64 - std::countr_zero(places);
    for (std::size_t row = 0; row < ids.size(); ++row) {
      Place& place = places_[of(ids[row])];
      if (place.row == none) place = {ids[row], row};
    }
  }
  /// Returns the row of an id, or `otherwise` if there is none.
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

  /// Returns the place of an id, or the free place for it. At most half of the places are used.
  std::size_t of(BodyId id) const {
    constexpr std::uint64_t golden = 0x9E3779B97F4A7C15;  // spreads consecutive ids
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

/// Degrees of freedom of a free body, in world axes, that forces and contacts do not change: bits 0 to 2 for
/// translation along x, y, z (the velocity is constant), bits 3 to 5 for rotation about them (there is none).
using LockedAxes = std::uint8_t;
inline constexpr LockedAxes locked_along(int axis) {
  return static_cast<LockedAxes>(1 << axis);
}
inline constexpr LockedAxes locked_about(int axis) {
  return static_cast<LockedAxes>(8 << axis);
}
inline constexpr LockedAxes locked_rotations = 7 << 3;

/// Returns a change of velocity without its components along locked axes.
inline Vec3 without_locked(LockedAxes locked, Vec3 change) {
  for (int d = 0; d < 3; ++d)
    if (locked & locked_along(d)) change[d] = 0;
  return change;
}

/// The impulse of a contact in the last step (world frame, on body b), for the warm start.
struct StoredImpulse {
  BodyId partner;  // the other body
  Image image;     // of b relative to a, as in Contact
  std::uint64_t feature;
  Vec3 impulse;
};

/// State that a coupler keeps with each body; zero until it is set. It travels with the body between ranks
/// and into checkpoints; rigid/ never reads it.
struct alignas(8) AttachedState {
  static constexpr std::size_t size = 528;
  std::byte bytes[size] = {};
};

/// Pose and motion of a body; trivially copyable, as the whole record.
struct Kinematics {
  double position[3] = {}, orientation[4] = {1, 0, 0, 0};  // w, x, y, z
  double velocity[3] = {}, angular_velocity[3] = {}, angular_momentum[3] = {};
};

/// The complete state of one body except stored impulses, for messages, checkpoints and programs that add
/// bodies. Trivially copyable; meaning and units as in BodySet.
struct BodyRecord : Kinematics {
  BodyId id = 0;
  std::int32_t shape = 0, material = 0, kind = 0;
  std::int32_t image[3] = {};
  Motion motion = Motion::free;
  std::uint8_t unused[7] = {};  // no gap is left that hides a member without a column
  double mass = 1, weight_in_fluid = 1;
  double inertia_B[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  AttachedState attached_state = {};
};

// ---- the columns of bodies: arrays of BodySet, members of BodyRecord ----

struct BodyIdentities {
  std::vector<BodyId> id;
  std::vector<std::int32_t> shape;     // index into the scene's shapes
  std::vector<std::int32_t> material;  // index into the scene's materials
  std::vector<std::int32_t> kind;      // number of the case's entry that made it (for output)
  std::vector<Motion> motion;
};

/// Positions are wrapped into the domain; position + image * period is the unwrapped path.
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
  // weight in the fluid over weight in vacuum, 1 - displaced mass / mass (method.md, M7). Stored as this
  // ratio, so that bodies of equal density accelerate bitwise alike
  std::vector<double> weight_in_fluid;
  std::vector<Mat3> inertia_B;
};

struct BodySet : BodyIdentities, BodyMotions, BodyMasses {
  std::size_t owned = 0, copies = 0, visitors = 0, walls = 0;

  std::vector<LockedAxes> locked_of_kind;  // indexed by kind; empty: no body has locked axes

  // forces of this step other than gravity, from any source
  std::vector<FixedVec3> force, torque;  // W, about the centre of mass
  // the coupler's data
  std::vector<AttachedState> attached_state;
  // contact impulses of the previous step, sorted by (partner, image, feature); owned rows only
  std::vector<std::vector<StoredImpulse>> stored_impulses;

  std::size_t size() const { return id.size(); }
  std::size_t first_wall() const { return size() - walls; }
  /// Returns whether contacts and forces move the body; otherwise its mass is infinite.
  bool is_dynamic(std::size_t row) const { return motion[row] == Motion::free; }

  Kinematics kinematics(std::size_t row) const;
  void set_kinematics(std::size_t row, const Kinematics&);
  BodyRecord record(std::size_t row) const;
  void assign(std::size_t row, const BodyRecord&);  // all but forces and stored impulses
  /// Inserts before row, with zero force. Neither this nor erase changes the four counts above or the table
  /// of rows; the caller keeps the sections in order.
  void insert(std::size_t row, const BodyRecord&);
  void erase(std::size_t row);
  /// Appends an owned body and counts it. Call reindex() after the last one.
  void add(const BodyRecord&);
  void resize(std::size_t rows);
  /// Sorts owned bodies and copies by id and rebuilds the table of rows. Call after changing rows.
  void reindex();
  /// Returns the row of a body, in whatever section, or size() if this rank does not hold it.
  std::size_t row_of(BodyId) const;

  LockedAxes locked(std::size_t row) const {
    return locked_of_kind.empty() ? LockedAxes{0} : locked_of_kind[kind[row]];
  }
  /// Returns a change of the body's velocity without its components along locked axes.
  Vec3 unlocked(std::size_t row, const Vec3& change) const {
    return locked(row) == 0 ? change : without_locked(locked(row), change);
  }
  /// Returns zero for a body that is not free, and about locked axes.
  Mat3 inverse_inertia_W(std::size_t row) const;
  bool is_isotropic(std::size_t row) const;  // whether all its moments of inertia are equal
  /// Returns the mass of the displaced fluid.
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
  /// Both keep angular velocity and momentum consistent; set_pose keeps the angular velocity.
  void set_pose(std::size_t row, const Pose&);
  void set_velocity(std::size_t row, const Vec3& velocity, const Vec3& angular_velocity);

 private:
  RowTable row_of_;
};

/// The kind of numbers in a column, which determines what values a checkpoint may contain.
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
  velocity,  // linear or angular
  impulse,   // linear or angular; or a momentum or load
  step,
  quanta,  // of an integer sum
  heat,    // a temperature or heat
};

struct BodyColumn {
  const char* name;
  Values values;
};

/// Calls visit(column, array of a set, member of a record), except for attached state, in checkpoint order.
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

/// Returns the numbers of which a member consists.
template <class Number, class Member>
std::span<const Number> numbers_of(const Member& member) {
  return {reinterpret_cast<const Number*>(&member), sizeof member / sizeof(Number)};
}

/// Calls visit(column, its numbers) for the same columns of one record.
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
