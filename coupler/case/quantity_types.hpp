#pragma once
// The types a [[quantities]] entry may have: a row each says which keys it takes, what the scene must have,
// and the dimension of its value. How it is computed is in body_quantities and flow_quantities.
#include <span>
#include <string_view>

#include "coupler/case/units.hpp"

namespace silt::coupler {

struct QuantityType {
  // time: from when on; instant: when, by default at the end
  enum Key : unsigned {
    body = 1,
    axis = 2,
    time = 4,
    profile = 8,
    height = 16,
    centre = 32,
    box = 64,
    side = 128,
    wall = 256,
    instant = 512
  };
  enum Need : unsigned { fluid = 1, bodies = 2, gravity = 4, undriven = 8 };  // undriven: no prescribed body

  std::string_view name;
  Dimension dimension;  // of the value
  unsigned keys, needs;

  bool takes(Key key) const { return keys & key; }
  bool asks_for(Need need) const { return needs & need; }
};

std::span<const QuantityType> quantity_types();
/// The row of a name that is in the table.
const QuantityType& quantity_type(std::string_view name);

}  // namespace silt::coupler
