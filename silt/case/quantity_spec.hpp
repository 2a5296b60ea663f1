#pragma once
// The figures of a run: [[quantities]] and [run.steady] of a case, and the types that an entry may have.
#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "coupler/spec/name_table.hpp"
#include "rigid/math/types.hpp"
#include "silt/case/case_error.hpp"
#include "silt/case/units.hpp"

namespace silt {

enum class Axis { x, y, z };
inline constexpr auto axis_names = coupler::names_of<Axis>("x", "y", "z");

/// The components of a symmetric tensor.
enum class Component { xx, yy, zz, xy, xz, yz };
inline constexpr auto component_names = coupler::names_of<Component>("xx", "yy", "zz", "xy", "xz", "yz");

/// Forces act on bodies, one of [[walls]] or a side of the domain.
enum class Bearer { bodies, wall, side };

/// A value the run puts into report.json under "quantities", for reference.toml to compare. The types and
/// the keys each takes are in quantity_types.
struct QuantitySpec {
  std::string name, type;
  Bearer bearer = Bearer::bodies;
  int kind = -1;  // index into Case::kind_names; -1: every body
  int axis = 2;
  double time = 0;           // from when on (of an instant: when; without one the end), in steps
  double height = 0;         // along the axis: of bodies, of a plane
  double second_height = 0;  // of the second of two planes
  std::optional<std::array<double, 2>> over;  // steps of which the value is the mean, or the deviation
  bool deviation = false;
  int side = 0;       // a Side of the domain
  int wall = 0;       // index into Case::walls
  int component = 0;  // a Component
  rigid::Vec3 centre = rigid::Vec3::Zero();
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};

  bool is_about(int body_kind) const { return kind < 0 || body_kind == kind; }
  bool operator==(const QuantitySpec&) const = default;
};

/// The run ends before its last step when a quantity has come so close to where it goes (see SteadyWatch).
struct SteadySpec {
  std::string quantity;  // name of a QuantitySpec
  double change = 0;     // relative
  std::int64_t every = 0;
};

/// A type that a [[quantities]] entry may have: which keys it takes, what the scene must have, the dimension
/// of its value and what it means.
struct QuantityType {
  enum Key : unsigned {
    body = 1,
    axis = 2,
    time = 4,  // the quantity looks at the run from this time on
    height = 16,
    centre = 32,
    box = 64,
    side = 128,
    wall = 256,
    instant = 512,  // written `time` too: the quantity looks at this time, by default at the end
    at = 1024,
    bearer = 2048,      // body or wall
    side_bears = 4096,  // or side
    component = 8192,
    planes = 16384,  // written `at` too: two of them
  };
  enum Need : unsigned {
    fluid = 1,
    bodies = 2,
    gravity = 4,
    undriven = 8,      // no body of prescribed motion
    sheared = 16,      // walls of different velocities across `axis`
    same_bodies = 32,  // from start to end
    stepwise = 64      // no need: it has a value in every step, for which no rank waits
  };

  std::string_view name;
  Dimension dimension;  // of the value
  unsigned keys, needs;
  std::string_view meaning;
  std::string_view unit = "";  // of a value without a dimension, where it has one

  constexpr bool takes(Key key) const { return keys & key; }
  constexpr bool asks_for(Need need) const { return needs & need; }
};
using Q = QuantityType;  // in rows

/// Every type. Its row, with its computation, is at the end of a family in silt/results.
extern const std::vector<QuantityType> quantity_types;

/// Returns the type of a name; std::invalid_argument where there is none.
inline const QuantityType& quantity_type(std::string_view name) {
  for (const QuantityType& type : quantity_types)
    if (type.name == name) return type;
  throw std::invalid_argument("not a type of a quantity: " + std::string(name));
}

}  // namespace silt
