#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/readable_quantity.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

constexpr const char* edge_default = "0.2 mm";
constexpr double edge_assumed = 0.2e-3, duty_assumed = 0.5;

class Texture final : public SurfaceEffect {
 public:
  explicit Texture(const Parameters& p)
      : height_(p.number("height")),
        wavelength_(p.number("wavelength")),
        kx_(2.0 * std::numbers::pi / wavelength_ * math::cos(p.number("angle"))),
        ky_(2.0 * std::numbers::pi / wavelength_ * math::sin(p.number("angle"))),
        bars_(p.choice("profile") == "bars"),
        duty_(p.number("duty")),
        edge_(p.number("edge") / wavelength_),
        waviness_(p.number("waviness")),
        waviness_length_(p.number("waviness_length")) {}

  void displace(std::size_t count, const double* x, const double* y, const double* nz, double* gap) override {
    if (bars_) {
      for (std::size_t i = 0; i < count; ++i) {
        if (nz[i] == 1.0) gap[i] -= height_ * bar((kx_ * x[i] + ky_ * y[i]) / (2.0 * std::numbers::pi));
      }
    } else {
      for (std::size_t i = 0; i < count; ++i) {
        if (nz[i] == 1.0) gap[i] -= height_ * math::sin(kx_ * x[i] + ky_ * y[i]);
      }
    }
    if (waviness_ == 0.0) return;
    const double slower = wavelength_ / waviness_length_;
    for (std::size_t i = 0; i < count; ++i) {
      if (nz[i] == 1.0) gap[i] -= waviness_ * math::sin(slower * (kx_ * x[i] + ky_ * y[i]));
    }
  }

  [[nodiscard]] double longest_step(double speed) const override {
    double shortest = wavelength_;
    if (bars_) shortest = std::min(shortest, 2.0 * edge_ * wavelength_);  // a flank is half a wave
    if (waviness_ != 0.0) shortest = std::min(shortest, waviness_length_);
    return step_per_wave(shortest, speed);
  }

 private:
  // 1 on a bar, -1 between bars, straight across the edges; `turns`: position over the wavelength.
  // The sine is 1 at the middle of a bar.
  [[nodiscard]] double bar(double turns) const {
    const double from_middle = std::abs(turns - 0.25 - std::nearbyint(turns - 0.25));  // 0 to 0.5
    return std::clamp((duty_ - 2.0 * from_middle) / edge_, -1.0, 1.0);
  }

  double height_, wavelength_, kx_, ky_;
  bool bars_;
  double duty_, edge_;  // shares of the wavelength
  double waviness_, waviness_length_;
};

void check_profile(const Parameters& p) {
  const double duty = p.number("duty"), edge = p.number("edge"), wavelength = p.number("wavelength");
  constexpr double rounding = 1e-9;  // of lengths read from text
  if (p.choice("profile") == "sine") {
    if (std::abs(duty - duty_assumed) > rounding * duty_assumed || std::abs(edge - edge_assumed) > rounding * edge_assumed)
      throw SceneValueError("effects.texture.profile",
                            "a sine has no duty and no edge, but the scene gives duty " + format_number(duty) + " and edge " +
                                format_quantity(edge, Quantity::length) + "; use profile: bars, or leave both out");
    return;
  }
  const double widest = std::min(duty, 1.0 - duty) * wavelength;
  if (edge > widest * (1.0 + rounding)) {
    throw SceneValueError("effects.texture.edge", format_quantity(edge, Quantity::length) +
                                                      " is wider than a bar or its gap; allowed: at most " +
                                                      readable_quantity(widest, Quantity::length));
  }
}

}  // namespace

EffectKind texture() {
  const std::string board = "recordings of a printed board (github.com/wngfra/FabricSlide)";
  return {
      {"texture",
       "A surface with ridges: sliding at speed v makes each unit vibrate at v/wavelength.",
       "gap shrinks by height p(u) + waviness sin(2 pi s/waviness_length), s = x cos angle + y sin angle, u = s/wavelength\n"
       "sine: p = sin(2 pi u). bars: p = clamp((duty - 2 |u - 1/4 - n|) wavelength/edge, -1, 1), n the nearest whole number:\n"
       "1 over `duty` of the wavelength, -1 elsewhere, edges straight; its waves n = 0, 1, ... about a bar's middle have\n"
       "the amplitudes 2 duty - 1, then 4 sin(pi n duty)/(pi n) sin(pi n e)/(pi n e), e = edge/wavelength\n"
       "Slopes are taken as small: the normal is the plane's.",
       board + ": peak at speed/3.97 mm, at any force",
       {number_spec("wavelength", Quantity::length, "4 mm", positive, "Distance of the ridges.",
                    "FabricSlide: one of its boards has 2 mm bars, 2 mm apart"),
        number_spec("height", Quantity::length, "20 um", {0.0, 5e-3}, "Amplitude, up to 5 mm: half of the height of a ridge.",
                    "assumed; printed boards have some tenths of a millimetre"),
        number_spec("angle", Quantity::angle, "0 deg", any_value, "Direction across the ridges, from the surface's X axis.",
                    "assumed"),
        choice_spec("profile", "sine", {"sine", "bars"}, "Shape of the ridges.", "set for each scene"),
        number_spec("duty", Quantity::none, "0.5", {0.05, 0.95},
                    "Share of the wavelength that a bar takes, half of each edge included.",
                    board + ": one has bars and gaps of 2 mm"),
        number_spec("edge", Quantity::length, edge_default, {.min = 1e-6}, "Width of each of a bar's two edges.",
                    "assumed: half a nozzle of a printer"),
        number_spec("waviness", Quantity::length, "0 um", {0.0, 5e-3},
                    "Amplitude of a slow wave along the same direction, as on a board that is not flat.", "0: none"),
        number_spec("waviness_length", Quantity::length, "150 mm", positive, "Length of the slow wave.",
                    board + ": a quarter of the variance has one wave in the 150 mm of a slide")}},
      {Change::normal_force},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        if (!context.flat_surface) throw SceneValueError("effects", "texture needs a flat surface; allowed shapes: plane, box");
        check_profile(p);
        effects.surface.push_back(std::make_unique<Texture>(p));
      },
      false,
      {},
      nullptr,
      {{"wavelength", "height", "angle"}, {"waviness_length", "waviness", "angle"}}};
}

}  // namespace slipbench
