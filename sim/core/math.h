// Transcendental functions with the same bits on every processor. The C library chooses its
// functions by the processor, and those with fused multiply-add round differently. These are
// SLEEF's deterministic functions [shibata2020].
//
// All code of the project calls these in place of std::exp and the
// like; tests/install/binaries_test.py checks it. The largest error is 1 unit in the last place,
// 1.5 for erfc(). A number has the same result alone and in any lane of a Quad. Near the end of the
// range of a double some functions return infinity early: log1p() above 2.9e307, sinh() and cosh()
// from 709.8 on, asinh() at 1e300.
#pragma once

#include <cmath>

#include "sim/core/vectorise.h"

namespace slipbench::math {

double exp(double x);
double expm1(double x);  // exp(x) - 1
double log(double x);    // natural logarithm
double log1p(double x);  // log(1 + x)
double log2(double x);
double log10(double x);
double pow(double x, double y);

double sin(double x);  // x [rad]
double cos(double x);
double tan(double x);
double asin(double x);             // [rad], in [-pi/2, pi/2]
double acos(double x);             // [rad], in [0, pi]
double atan(double x);             // [rad], in [-pi/2, pi/2]
double atan2(double y, double x);  // [rad], in [-pi, pi]

double sinh(double x);
double cosh(double x);
double tanh(double x);
double asinh(double x);

double cbrt(double x);
double erf(double x);
double erfc(double x);
double lgamma(double x);  // natural logarithm of |Gamma(x)|

struct SinCos {
  double sin, cos;
};
// Both of the same angle [rad], at the cost of one. The last bit may differ from sin() and cos().
SinCos sincos(double x);

// sqrt(x^2 + y^2). Inexact where a square leaves the range of a double: below 1e-154 and above
// 1e154.
inline double hypot(double x, double y) { return std::sqrt(x * x + y * y); }

// The same functions for four numbers. Results go through memory, because code compiled for other
// processors passes vectors of this size in other registers.
namespace four {
void exp(const Quad& x, Quad& result);
void expm1(const Quad& x, Quad& result);
void log(const Quad& x, Quad& result);
void pow(const Quad& x, const Quad& y, Quad& result);
void sincos(const Quad& x, Quad& sin, Quad& cos);
}  // namespace four

SLIPBENCH_INLINE Quad exp(const Quad& x) {
  Quad result;
  four::exp(x, result);
  return result;
}
SLIPBENCH_INLINE Quad expm1(const Quad& x) {
  Quad result;
  four::expm1(x, result);
  return result;
}
SLIPBENCH_INLINE Quad log(const Quad& x) {
  Quad result;
  four::log(x, result);
  return result;
}
SLIPBENCH_INLINE Quad pow(const Quad& x, const Quad& y) {
  Quad result;
  four::pow(x, y, result);
  return result;
}

struct QuadSinCos {
  Quad sin, cos;
};
SLIPBENCH_INLINE QuadSinCos sincos(const Quad& x) {
  QuadSinCos result;
  four::sincos(x, result.sin, result.cos);
  return result;
}

}  // namespace slipbench::math
