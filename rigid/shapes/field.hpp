#pragma once
// How a case gives the sizes of a shape: the entries of a shape's table `fields`.
#include <tuple>

namespace silt::rigid {

/// A length, or for a member that is a vector three lengths along the axes. member = share * what `key`
/// gives, or other_share * what `other_key` gives, where there is one; the case has one of the two.
template <class Solid, class Value>
struct Field {
  const char* key;
  Value Solid::*member;
  const char* doc;  // ends the message that it is missing
  double share = 1;
  const char* other_key = nullptr;
  double other_share = 1;
};

template <class Solid>
constexpr Field<Solid, double> radius_field(double Solid::*radius) {
  return {"radius", radius, "how large it is", 1, "diameter", 0.5};
}

}  // namespace silt::rigid
