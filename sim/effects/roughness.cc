#include <bit>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>

#include "sim/contact/vectorise.h"
#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/wave_sum.h"

namespace slipbench {
namespace {

// A sum of waves with wavelengths from period/first to period/last: amplitude a/n^exponent of the
// wave that fits n times, random phases. Tabulated over one period, linear between the points.
class Profile {
 public:
  Profile(double period, std::size_t first, std::size_t last, double exponent, double rms, RandomStream& stream,
          const WaveSum& sum) {
    double power = 0.0;  // mean square at a = 1
    for (std::size_t n = first; n <= last; ++n) power += 0.5 * math::pow(static_cast<double>(n), -2.0 * exponent);
    const double amplitude = rms / std::sqrt(power);
    std::vector<std::complex<double>> waves(last + 1);
    for (std::size_t n = first; n <= last; ++n) {
      const auto [sine, cosine] = math::sincos(stream.uniform(0.0, 2.0 * std::numbers::pi));
      waves[n] = amplitude * math::pow(static_cast<double>(n), -exponent) * std::complex<double>(cosine, sine);
    }
    heights_ = sum.at_points(waves);
    const std::size_t cells = heights_.size();
    heights_.push_back(heights_.front());  // interpolation needs no wrapping
    per_cell_ = static_cast<double>(cells) / period;
    mask_ = cells - 1;
  }

  // Number of points per period for waves down to period/last.
  static std::size_t points(std::size_t last) { return std::bit_ceil(points_per_wave * last); }

  // m; ends with the first one repeated
  [[nodiscard]] const double* heights() const { return heights_.data(); }
  [[nodiscard]] double per_cell() const { return per_cell_; }  // points per metre
  // number of points, a power of two, minus one
  [[nodiscard]] std::uint64_t mask() const { return mask_; }

 private:
  // Per shortest wave: its amplitude is accurate to (pi/32)^2/3 = 0.3 %.
  static constexpr std::size_t points_per_wave = 32;

  std::vector<double> heights_;
  double per_cell_ = 0.0;
  std::uint64_t mask_ = 0;
};

// Lowers the gaps by a profile that varies along the direction (cos, sin).
SLIPBENCH_DISPATCHED void lower(const Profile& profile, double cos, double sin, std::size_t count, const double* x,
                                const double* y, const double* nz, double* gap) {
  // Adding 1.5 2^52 rounds a double to a whole number in its last bits. With half a cell subtracted
  // first it is std::floor, without the library call that the baseline of x86-64 would need.
  constexpr double whole = 0x1.8p52;
  const double* const heights = profile.heights();
  const double cos_per_cell = cos * profile.per_cell(), sin_per_cell = sin * profile.per_cell();
  const std::uint64_t mask = profile.mask();
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) {
    const double u = cos_per_cell * x[i] + sin_per_cell * y[i];
    const double rounded = (u - 0.5) + whole;
    const auto cell = static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(rounded) & mask);
    const double low = heights[cell], high = heights[cell + 1];
    const double height = low + (u - (rounded - whole)) * (high - low);
    gap[i] -= nz[i] == 1.0 ? height : 0.0;
  }
}

class Roughness final : public SurfaceEffect {
 public:
  Roughness(const Parameters& p, const EffectContext& context) : shortest_(p.number("shortest")) {
    constexpr double longest_in_period = 8.0;
    const double longest = p.number("longest"), period = longest_in_period * longest;
    const auto first = static_cast<std::size_t>(longest_in_period);
    const auto last = static_cast<std::size_t>(period / shortest_ * (1.0 + 1e-12));
    const auto directions = static_cast<std::size_t>(p.integer("directions"));
    RandomStream stream = context.stream("roughness");
    const WaveSum sum(Profile::points(last));
    for (std::size_t j = 0; j < directions; ++j) {
      const double angle = p.number("angle") + std::numbers::pi * static_cast<double>(j) / static_cast<double>(directions);
      const double rms = p.number("height") / std::sqrt(static_cast<double>(directions));
      ridges_.push_back(
          {math::cos(angle), math::sin(angle), Profile(period, first, last, p.number("exponent"), rms, stream, sum)});
    }
  }

  void displace(std::size_t count, const double* x, const double* y, const double* nz, double* gap) override {
    for (const Ridges& ridges : ridges_) lower(ridges.profile, ridges.cos, ridges.sin, count, x, y, nz, gap);
  }

  [[nodiscard]] double longest_step(double speed) const override { return step_per_wave(shortest_, speed); }

 private:
  struct Ridges {
    double cos, sin;  // direction across them
    Profile profile;
  };

  double shortest_;
  std::vector<Ridges> ridges_;
};

void refuse_unordered(double shortest, double longest) {
  constexpr double widest = 1000.0;
  if (longest >= shortest && longest <= widest * shortest) return;
  throw SceneValueError("effects", "the longest wave of roughness is " + format_quantity(longest, Quantity::length) +
                                       "; allowed: `shortest` (" + format_quantity(shortest, Quantity::length) +
                                       ") to 1000 times `shortest`");
}

}  // namespace

EffectKind roughness() {
  return {
      {"roughness",
       "A surface that is rough on many length scales: sliding causes noise in the forces.",
       "gap shrinks by h(x, y) = sum_j h_j(x cos a_j + y sin a_j), a_j = angle + pi j/directions\n"
       "h_j(s) = sum_n a n^-exponent cos(2 pi n s/L + phase), waves L/n from longest to shortest, L = 8 longest, random phases; rms of h: height\n"
       "directions 1: a ground surface with ridges across `angle`; 2: rms of height and slope are the same in all directions; 3: rms of curvature, too\n"
       "Slopes are taken as small: the normal is the plane's.",
       "power spectrum k^(-2 exponent) of a profile: self-affine with Hurst exponent H = exponent - 1/2 (Persson et al., J. Phys.: Condens. Matter 17 (2005) R1)",
       {number_spec("height", Quantity::length, "5 um", {0.0, 1e-3}, "Root mean square height.", "assumed: 2 to 10 um"),
        number_spec("exponent", Quantity::none, "2", {0.0, 5.0}, "Exponent with which the amplitude falls with the wave number.",
                    "assumed: 1.3 is a self-affine surface of H = 0.8; a rounded tip does not follow the short waves"),
        number_spec(
            "shortest", Quantity::length, "60 um", positive,
            "Shortest wave; a step must not move a root by more than a sixteenth of it.",
            "assumed: the shortest wave that a rate of 10 kHz resolves at 33 mm/s; a finer surface needs a shorter time_step"),
        number_spec("longest", Quantity::length, "3 mm", positive, "Longest wave, at most 1000 times `shortest`.",
                    "assumed: the size of a contact patch"),
        integer_spec("directions", "3", {1.0, 8.0}, "Number of profiles that cross each other at equal angles.",
                     "3: the fewest whose sum looks alike in all directions up to curvature"),
        number_spec("angle", Quantity::angle, "0 deg", any_value, "Direction across the first ridges, from the surface's X axis.",
                    "assumed")}},
      {Change::normal_force},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        if (!context.flat_surface) throw SceneValueError("effects", "roughness needs a flat surface; allowed shapes: plane, box");
        refuse_unordered(p.number("shortest"), p.number("longest"));
        effects.surface.push_back(std::make_unique<Roughness>(p, context));
      }};
}

}  // namespace slipbench
