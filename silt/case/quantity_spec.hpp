#pragma once
// The figures of a run: [[quantities]] and [run.steady] of a case, and the types that an entry may have.
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

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
  double time = 0;    // from when on (of an instant: when; without one the end), in steps
  double height = 0;  // along the axis: of bodies, of a plane
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
/// of its value and what it means. A new quantity is a row of quantity_rows, and its computation under the
/// same name in a family of silt/results (see quantity_computation.hpp).
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

namespace quantity_rows {

using Q = QuantityType;
inline constexpr Dimension rate{0, -1, 0}, mass_rate{0, -1, 1}, specific_energy{2, -2, 0},
    specific_energy_rate{2, -3, 0}, power{2, -3, 1}, flow_rate{3, -1, 0};

inline constexpr QuantityType types[] = {
    {"max-speed", dimension::velocity, Q::body, Q::bodies, "largest speed of any of the bodies in the run"},
    {"drag-coefficient", dimension::none, Q::body | Q::axis, Q::fluid | Q::bodies,
     "force on the fixed bodies over Stokes' drag at the superficial velocity"},
    {"superficial-velocity", dimension::velocity, Q::body | Q::axis, Q::fluid,
     "mean over all cells of the fluid's velocity relative to the bodies', at the end; cells inside bodies "
     "count as zero"},
    {"kinetic-energy", specific_energy, Q::instant, Q::fluid, "mean of u²/2 over the fluid"},
    {"dissipation", specific_energy_rate, Q::instant, Q::fluid,
     "mean of 2 ν S : S over the fluid, the strain rate S from each cell's populations"},
    {"mean-height", dimension::length, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "mean coordinate of the bodies' centres along the axis, at the end"},
    {"height-deviation", dimension::length, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "standard deviation of that coordinate over the bodies, at the end"},
    {"least-height", dimension::length, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "least of these coordinates, at the end"},
    {"largest-height", dimension::length, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "largest of these coordinates, at the end"},
    {"drift", dimension::length, Q::body, Q::bodies,
     "largest distance of one of the bodies from where it started, at the end"},
    {"max-height-after", dimension::length, Q::body | Q::axis | Q::time, Q::bodies,
     "largest coordinate of the bodies' centres along the axis from a time on"},
    {"displacement", dimension::length, Q::body | Q::axis, Q::bodies,
     "mean displacement along the axis since the start, counted across periodic borders"},
    {"mean-velocity", dimension::velocity, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "mean velocity of the bodies along the axis, at the end"},
    {"velocity-deviation", dimension::velocity, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "standard deviation of that velocity over the bodies, at the end"},
    {"least-velocity", dimension::velocity, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "least of these velocities, at the end"},
    {"largest-velocity", dimension::velocity, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "largest of these velocities, at the end"},
    {"mean-angular-velocity", dimension::angular_velocity, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "mean angular velocity of the bodies about the axis, at the end"},
    {"angular-velocity-deviation", dimension::angular_velocity, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "standard deviation of that angular velocity over the bodies, at the end"},
    {"least-angular-velocity", dimension::angular_velocity, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "least of these angular velocities, at the end"},
    {"largest-angular-velocity", dimension::angular_velocity, Q::body | Q::axis, Q::bodies | Q::stepwise,
     "largest of these angular velocities, at the end"},
    {"max-penetration", dimension::length, 0, Q::bodies, "deepest overlap of any contact in the run"},
    {"momentum-change", dimension::none, Q::body | Q::axis, Q::bodies | Q::same_bodies,
     "change of the free bodies' momentum since the start, over the sum of their |m v| then"},
    {"angular-momentum-change", dimension::none, Q::body, Q::bodies | Q::same_bodies,
     "change of the free bodies' angular momentum about the domain's corner, over what it was"},
    {"energy-change", dimension::none, Q::body, Q::bodies | Q::same_bodies,
     "kinetic and potential energy (zero at the domain's lowest corner) at the end over that at the start, "
     "less 1"},
    {"energy-growth", dimension::none, Q::body, Q::bodies | Q::undriven | Q::same_bodies,
     "largest energy of the run over that at the start, less 1"},
    {"discharge-rate", mass_rate, Q::body | Q::axis | Q::height | Q::time, Q::bodies | Q::same_bodies,
     "mass that came below the height between the time and the end, per time"},
    {"bed-angle", dimension::none, Q::body | Q::axis | Q::centre | Q::time,
     Q::bodies | Q::gravity | Q::stepwise,
     "angle in degrees about the axis from gravity to the line from `centre` to the centre of mass, mean "
     "from a time on: the slope of the bed in a round container",
     "degrees"},
    {"weight-torque", dimension::torque, Q::body | Q::axis | Q::centre | Q::time,
     Q::bodies | Q::gravity | Q::stepwise,
     "torque about the axis through `centre` of the free bodies' weight less their buoyancy, mean from a "
     "time on"},
    {"rebound-ratio", dimension::none, Q::body | Q::axis | Q::height, Q::bodies,
     "largest velocity along the axis over the largest against it, of bodies with their centres above the "
     "height"},
    {"fluid-force", dimension::force, Q::bearer | Q::side_bears | Q::axis, Q::fluid | Q::stepwise,
     "force of the fluid along the axis on bodies, a wall or a side of the domain in the last step; without "
     "hydrostatic pressure"},
    {"fluid-torque", dimension::torque, Q::bearer | Q::axis, Q::fluid | Q::stepwise,
     "torque of the fluid about the axis: on bodies about their centres of mass, on a wall about its point; "
     "in the last step"},
    {"contact-force", dimension::force, Q::bearer | Q::side_bears | Q::axis, Q::bodies | Q::stepwise,
     "force of contacts and films along the axis on bodies, a wall or a side of the domain in the last step"},
    {"contact-torque", dimension::torque, Q::bearer | Q::axis, Q::bodies | Q::stepwise,
     "torque of contacts about the axis: on bodies about their centres of mass, on a wall about its point; "
     "in the last step"},
    {"flow-rate", flow_rate, Q::axis | Q::at, Q::fluid | Q::stepwise,
     "volume of fluid that goes through a plane across the axis, per time, at the end; linear between the "
     "layers of cells beside the plane"},
    {"body-force", dimension::acceleration, Q::axis, Q::fluid | Q::stepwise,
     "acceleration of the fluid along the axis, as given or as the superficial velocity asks for, at the "
     "end"},
    {"axis-distance", dimension::length, Q::body | Q::wall, Q::bodies,
     "mean distance of the bodies' centres from the axis of a tube, at the end"},
    {"wall-stress", dimension::pressure, Q::side | Q::axis | Q::time, Q::fluid | Q::stepwise,
     "force of fluid and bodies along the axis on a side of the domain, per area, mean from a time on"},
    {"wall-force", dimension::force, Q::wall | Q::axis | Q::time, Q::stepwise,
     "force of fluid and bodies along the axis on a tube or mesh, mean from a time on"},
    {"wall-torque", dimension::torque, Q::wall | Q::time, Q::stepwise,
     "torque of fluid and bodies on a tube or mesh about its axis, mean from a time on"},
    {"wall-power", power, Q::wall | Q::time, Q::stepwise,
     "power that keeps a tube or mesh moving against fluid and bodies, mean from a time on"},
    {"relative-viscosity", dimension::none, Q::axis | Q::time, Q::fluid | Q::sheared | Q::stepwise,
     "shear stress on the two walls across the axis over that of the fluid alone at the same velocities, "
     "mean from a time on"},
    {"viscous-stress", dimension::pressure, Q::box | Q::component, Q::fluid | Q::stepwise,
     "2 ρ ν S of the fluid in the box, over the volume of the box, at the end; a cell counts by its "
     "part in the box"},
    {"particle-stress", dimension::pressure, Q::body | Q::box | Q::component,
     Q::fluid | Q::bodies | Q::stepwise,
     "what bodies with their centres in the box add to it: force of the fluid on their surfaces times the "
     "way to it "
     "from their centres, the symmetric part, at the end"},
    {"contact-stress", dimension::pressure, Q::body | Q::box | Q::component, Q::bodies | Q::stepwise,
     "the same of contacts and films; pull is positive"},
    {"body-count", dimension::none, Q::body | Q::box, Q::bodies,
     "number of bodies whose centre of mass lies in the box, at the end"},
    {"outflow-rate", rate, Q::time, Q::bodies, "number of bodies that left from a time on, per time"},
    {"packing-fraction", dimension::none, Q::body | Q::box, Q::bodies,
     "share of the box that lies inside the bodies, at the end"},
};

}  // namespace quantity_rows

inline constexpr std::span<const QuantityType> quantity_types = quantity_rows::types;

/// Returns the row of a name; std::invalid_argument for one that the table does not have.
inline const QuantityType& quantity_type(std::string_view name) {
  for (const QuantityType& type : quantity_types)
    if (type.name == name) return type;
  throw std::invalid_argument("not a type of a quantity: " + std::string(name));
}

}  // namespace silt
