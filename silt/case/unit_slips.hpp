#pragma once
// Finds numbers of SI cases that would be plausible in another unit; returns the remedy, "if
// gravity.acceleration is in mm/s2, write 9.81 (m/s2)", or "".
#include <string>

namespace silt {

struct Case;

inline constexpr double thinnest = 5e-8, thickest = 0.5;              // m2/s: liquid metal to honey
inline constexpr double lightest_solid = 10, heaviest_solid = 25000;  // kg/m3: foam to osmium

inline bool is_of_a_solid(double density) {
  return density >= lightest_solid && density <= heaviest_solid;
}

/// Return the remedy, or "", for too viscous a fluid and for gravity 100 or 1000 times the Earth's.
std::string viscosity_slip(const Case&);
std::string gravity_slip(const Case&);
/// Returns both; if not "", this is the remedy for all that follows from them.
std::string motion_slip(const Case&);
/// Returns the cure where cells are so large that the fluid's viscosity is nothing in them, or a hand wide.
std::string length_slip(const Case&);
/// Returns the cure of a motion that is too fast: that of the units where they may be wrong, else the given
/// one.
std::string units_first(const Case&, const std::string& cure);
/// Returns "if domain.size is in mm, write [0.01, 0.01, 0.04] (m); else ", or "".
std::string size_slip(const Case&);
/// Returns what is wrong with a surface of a file, named by an entry ("walls[0]"), that is so many cells
/// across: far more than the domain has.
std::string scale_slip(const Case&, const std::string& entry, double across);
/// Returns the cure of the density of a body (kg/m3) that the key gives, or of the fluid about it.
std::string density_slip(const Case&, const std::string& key, double density);

}  // namespace silt
