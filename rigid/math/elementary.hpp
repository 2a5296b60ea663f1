#pragma once
// Functions of which the last bit must be the same on every machine. Those of a C library are not: glibc's
// round otherwise where the processor has fused multiply-add, and otherwise in another version. These are
// made of sums, differences, products, quotients and square roots, which IEEE 754 rounds in one way. Errors
// in units in the last place (ulp) of the result are measured in tests/rigid/math/elementary.cpp.

namespace silt::rigid::elementary {

/// Both are exact to 1.2 ulp for |x| < 1 and to 1.5 * 2^-53 (1 + 2^-30 |x|) beyond; above 2^30 they have no
/// meaning.
double sin(double x);
double cos(double x);
/// The angle of (x, y) from the x axis, in [-pi, pi], to 5 ulp; atan2(0, 0) is 0.
double atan2(double y, double x);
double log(double x);   // good to 2 ulp
double exp(double x);   // good to 1 ulp; 0 below the least and infinity above the largest normal number
double tanh(double x);  // good to 2^-52
double cbrt(double x);  // good to 1 ulp, of a normal number or 0
/// (x^2 + y^2)^(1/2) to 1.2 ulp, for lengths whose squares are normal numbers, or 0.
double hypot(double x, double y);
/// x^n by n products.
double power(double x, int n);

}  // namespace silt::rigid::elementary
