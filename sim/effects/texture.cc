#include <cmath>
#include <numbers>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

class Texture final : public SurfaceEffect {
 public:
  explicit Texture(const Parameters& p)
      : height_(p.number("height")),
        wavelength_(p.number("wavelength")),
        kx_(2.0 * std::numbers::pi / wavelength_ * math::cos(p.number("angle"))),
        ky_(2.0 * std::numbers::pi / wavelength_ * math::sin(p.number("angle"))) {}

  void displace(std::size_t count, const double* x, const double* y, const double* nz, double* gap) override {
    for (std::size_t i = 0; i < count; ++i) {
      if (nz[i] == 1.0) gap[i] -= height_ * math::sin(kx_ * x[i] + ky_ * y[i]);
    }
  }

  [[nodiscard]] double longest_step(double speed) const override { return step_per_wave(wavelength_, speed); }

 private:
  double height_, wavelength_, kx_, ky_;
};

}  // namespace

EffectKind texture() {
  return {{"texture",
           "The surface has ridges: sliding at speed v makes every unit vibrate at v/wavelength.",
           "h(x) = height sin(2 pi (x cos angle + y sin angle)/wavelength); the gap shrinks by h\n"
           "Slopes are taken as small: the normal is the plane's.",
           "recordings of a ridged board (github.com/wngfra/FabricSlide): peak at speed/3.97 mm, at any force",
           {number_spec("wavelength", Quantity::length, "4 mm", positive, "Distance of the ridges.",
                        "FabricSlide: 2 mm bars, 2 mm apart"),
            number_spec("height", Quantity::length, "20 um", {0.0, 5e-3}, "Amplitude, up to 5 mm.", "assumed"),
            number_spec("angle", Quantity::angle, "0 deg", any_value, "Direction across the ridges, from the surface's X axis.",
                        "assumed")}},
          [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
            if (!context.flat_surface)
              throw SceneValueError("effects", "texture needs a flat surface; allowed shapes: plane, box");
            effects.surface.push_back(std::make_unique<Texture>(p));
          }};
}

}  // namespace slipbench
