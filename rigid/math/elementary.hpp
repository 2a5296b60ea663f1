#pragma once
// Elementary functions with bitwise the same results on every machine. Those of the C library differ between
// versions of glibc and between processors with and without fused multiply-add. These use only sums,
// products, quotients and square roots, whose rounding IEEE 754 defines. tests/rigid/math/elementary.cpp
// measures the errors, in units in the last place (ulp) of the result.

namespace silt::rigid::elementary {

/// Errors: 1.2 ulp for |x| < 1; 1.5 * 2^-53 (1 + 2^-30 |x|) for |x| up to 2^30, the largest argument.
double sin(double x);
double cos(double x);
/// Returns the angle of (x, y) from the x axis in [-pi, pi], to 5 ulp; atan2(0, 0) is 0.
double atan2(double y, double x);
double log(double x);   // to 2 ulp
double exp(double x);   // to 1 ulp; 0 or infinity where the result is no normal number
double tanh(double x);  // absolute error 2^-52
double cbrt(double x);  // to 1 ulp, for normal numbers and 0
/// Returns (x^2 + y^2)^(1/2) to 1.2 ulp, for lengths that are 0 or whose squares are normal numbers.
double hypot(double x, double y);
/// Returns x^n by |n| multiplications.
double power(double x, int n);

}  // namespace silt::rigid::elementary
