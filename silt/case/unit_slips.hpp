#pragma once
// Numbers of SI cases that would be in their place in another unit, and how to write them: "if
// gravity.acceleration is in mm/s2, write 9.81 (m/s2)", or "" where nothing says so.
#include <string>

namespace silt {

struct Case;

inline constexpr double thinnest = 5e-8, thickest = 0.5;  // m2/s: of fluids from liquid metal to honey
inline constexpr double lightest_solid = 10, heaviest_solid = 25000;  // kg/m3: from foam to osmium

inline bool is_of_a_solid(double density) {
  return density >= lightest_solid && density <= heaviest_solid;
}

/// Each returns "" or the cure of a slip: that a fluid is too thick; that gravity is 100 or 1000 times that
/// of the Earth.
std::string viscosity_slip(const Case&);
std::string gravity_slip(const Case&);
/// Returns both: where it is not "", it is the cure of whatever follows from them.
std::string motion_slip(const Case&);
/// Returns the cure where cells are so large that the fluid's viscosity is nothing in them, or a hand wide.
std::string length_slip(const Case&);
/// Returns the cure of a motion that is too fast: that of the units where they may be wrong, else the given
/// one.
std::string units_first(const Case&, const std::string& cure);
/// Returns what is wrong with a surface of a file, named by an entry ("walls[0]"), that is so many cells
/// across: far more than the domain has.
std::string scale_slip(const Case&, const std::string& entry, double across);
/// Returns the cure of the density of a body (kg/m3) that the key gives, or of the fluid about it.
std::string density_slip(const Case&, const std::string& key, double density);

}  // namespace silt
