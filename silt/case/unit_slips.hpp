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
/// Returns the remedy if cells are so large that the viscosity has no effect in them.
std::string length_slip(const Case&);
/// Returns the remedy for the density (kg/m3) of a body, given by the key, or of the fluid.
std::string density_slip(const Case&, const std::string& key, double density);

}  // namespace silt
