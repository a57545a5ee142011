#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "sensors/electronics/part_kind.h"
#include "sim/core/math.h"
#include "sim/core/vectorise.h"

namespace slipbench {
namespace {

// Exact step of two equal poles over the time h, for x linear from x_0 to x_1:
//   y' = w (x - y), z' = w (y - z), a = w h, E = exp(-a), d = (x_1 - x_0)/a
//   A = y_0 - x_0 + d,  B = z_0 - x_0 + 2 d
//   y_1 = x_1 - d + A E,  z_1 = x_1 - 2 d + (A a + B) E
// On a long ramp z lags by 2/w.
struct Step {
  double per_slope;  // 1/a
  double keeps;      // E
  double passes_on;  // a E
};

SLIPBENCH_DISPATCHED void advance(std::size_t count, Step step, double* last, double* first_pole, double* second_pole,
                                  float* values) {
  SLIPBENCH_VECTORISE
  for (std::size_t v = 0; v < count; ++v) {
    const double x = values[v], d = step.per_slope * (x - last[v]);
    const double of_first = first_pole[v] - last[v] + d, of_second = second_pole[v] - last[v] + 2.0 * d;
    first_pole[v] = x - d + step.keeps * of_first;
    second_pole[v] = x - 2.0 * d + step.passes_on * of_first + step.keeps * of_second;
    last[v] = x;
    values[v] = static_cast<float>(second_pole[v]);
  }
}

class LowPass final : public ElectronicsStage {
 public:
  LowPass(const Parameters& parameters, const SignalModel& model)
      : count_(model.source.size()), memory_(3 * count_ + 2), frequency_(pole_frequency(parameters.number("corner"))) {}

  void apply(std::span<float> values, double time) override {
    double &then = memory_[3 * count_], &begun = memory_[3 * count_ + 1];
    if (begun == 0.0) {
      for (std::size_t state = 0; state < 3; ++state) std::ranges::copy(values, part(state));
      begun = 1.0;
    } else if (time == then) {  // two calls at the same time return the same values
      std::transform(part(2), part(2) + count_, values.begin(), [](double z) { return static_cast<float>(z); });
    } else {
      // Uses the times of the calls instead of a fixed step, so that a chain restored from memory
      // continues bit-identically.
      const double a = frequency_ * (time - then), keeps = math::exp(-a);
      advance(count_, {1.0 / a, keeps, std::isinf(a) ? 0.0 : a * keeps}, part(0), part(1), part(2), values.data());
    }
    then = time;
  }

  [[nodiscard]] std::span<double> memory() override { return memory_; }
  [[nodiscard]] bool works_between_samples() const override { return true; }

 private:
  // n equal poles at f are 3 dB down in total at the corner if (1 + (corner/f)^2)^n = 2; here n =
  // 2.
  static double pole_frequency(double corner) { return 2.0 * std::numbers::pi * corner / std::sqrt(std::numbers::sqrt2 - 1.0); }

  double* part(std::size_t state) { return memory_.data() + state * count_; }

  std::size_t count_;
  std::vector<double> memory_;  // [3,V] input and both poles at the last call, then its time and whether there was a call
  double frequency_;            // w, rad/s
};

}  // namespace

PartKind low_pass_part() {
  return {
      .entry =
          {.name = "low_pass",
           .summary = "Analogue low-pass before the converter: two equal poles, at every step of the simulation.",
           .law =
               "z = x/(1 + s/w)^2,  w = 2 pi corner/sqrt(sqrt(2) - 1) = 2 pi corner*1.554\n"
               "|z/x| = 1/(1 + (f/f_p)^2),  f_p = w/(2 pi): -3 dB at the corner; a step reaches half after 1.678/w\n"
               "exact for a signal that is linear between two steps of the simulation. The filter starts settled at the first value.",
           .source = "the definition of a filter of two equal poles",
           .parameters = {number_spec("corner", Quantity::frequency, "235 Hz", {.min = 0.01, .infinite = true},
                                      "Frequency at which the amplitude is 3 dB down; inf: no filter.", "assumed")}},
      .drawn_per = DrawnPer::never,
      .make = made<LowPass>};
}

}  // namespace slipbench
