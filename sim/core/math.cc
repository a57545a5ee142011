#include "sim/core/math.h"

#include <sleef.h>

namespace slipbench::math {
namespace {

using Pair __attribute__((vector_size(2 * sizeof(double)))) = double;

// SLEEF's functions of two numbers take half the time of its scalar functions and give the same
// bits.
template <auto function>
double of_one(double x) {
  return function(Pair{x, x})[0];
}
template <auto function>
double of_one(double x, double y) {
  return function(Pair{x, x}, Pair{y, y})[0];
}

Pair lower(const Quad& x) { return Pair{x[0], x[1]}; }
Pair upper(const Quad& x) { return Pair{x[2], x[3]}; }
Quad joined(const Pair& lower, const Pair& upper) { return Quad{lower[0], lower[1], upper[0], upper[1]}; }

template <auto function>
Quad of_four(const Quad& x) {
  return joined(function(lower(x)), function(upper(x)));
}

}  // namespace

double exp(double x) { return of_one<SLIPBENCH_SLEEF(expd2_u10)>(x); }
double expm1(double x) { return of_one<SLIPBENCH_SLEEF(expm1d2_u10)>(x); }
double log(double x) { return of_one<SLIPBENCH_SLEEF(logd2_u10)>(x); }
double log1p(double x) { return of_one<SLIPBENCH_SLEEF(log1pd2_u10)>(x); }
double log2(double x) { return of_one<SLIPBENCH_SLEEF(log2d2_u10)>(x); }
double log10(double x) { return of_one<SLIPBENCH_SLEEF(log10d2_u10)>(x); }
double pow(double x, double y) { return of_one<SLIPBENCH_SLEEF(powd2_u10)>(x, y); }

double sin(double x) { return of_one<SLIPBENCH_SLEEF(sind2_u10)>(x); }
double cos(double x) { return of_one<SLIPBENCH_SLEEF(cosd2_u10)>(x); }
double tan(double x) { return of_one<SLIPBENCH_SLEEF(tand2_u10)>(x); }
double asin(double x) { return of_one<SLIPBENCH_SLEEF(asind2_u10)>(x); }
double acos(double x) { return of_one<SLIPBENCH_SLEEF(acosd2_u10)>(x); }
double atan(double x) { return of_one<SLIPBENCH_SLEEF(atand2_u10)>(x); }
double atan2(double y, double x) { return of_one<SLIPBENCH_SLEEF(atan2d2_u10)>(y, x); }

double sinh(double x) { return of_one<SLIPBENCH_SLEEF(sinhd2_u10)>(x); }
double cosh(double x) { return of_one<SLIPBENCH_SLEEF(coshd2_u10)>(x); }
double tanh(double x) { return of_one<SLIPBENCH_SLEEF(tanhd2_u10)>(x); }
double asinh(double x) { return of_one<SLIPBENCH_SLEEF(asinhd2_u10)>(x); }

double cbrt(double x) { return of_one<SLIPBENCH_SLEEF(cbrtd2_u10)>(x); }
double erf(double x) { return of_one<SLIPBENCH_SLEEF(erfd2_u10)>(x); }
double erfc(double x) { return of_one<SLIPBENCH_SLEEF(erfcd2_u15)>(x); }
double lgamma(double x) { return of_one<SLIPBENCH_SLEEF(lgammad2_u10)>(x); }

SinCos sincos(double x) {
  const auto both = SLIPBENCH_SLEEF(sincosd2_u10)(Pair{x, x});
  return {both.x[0], both.y[0]};
}

void four::exp(const Quad& x, Quad& result) { result = of_four<SLIPBENCH_SLEEF(expd2_u10)>(x); }
void four::expm1(const Quad& x, Quad& result) { result = of_four<SLIPBENCH_SLEEF(expm1d2_u10)>(x); }
void four::log(const Quad& x, Quad& result) { result = of_four<SLIPBENCH_SLEEF(logd2_u10)>(x); }
void four::pow(const Quad& x, const Quad& y, Quad& result) {
  result = joined(SLIPBENCH_SLEEF(powd2_u10)(lower(x), lower(y)), SLIPBENCH_SLEEF(powd2_u10)(upper(x), upper(y)));
}
void four::sincos(const Quad& x, Quad& sin, Quad& cos) {
  const auto first = SLIPBENCH_SLEEF(sincosd2_u10)(lower(x)), second = SLIPBENCH_SLEEF(sincosd2_u10)(upper(x));
  sin = joined(first.x, second.x);
  cos = joined(first.y, second.y);
}

}  // namespace slipbench::math
