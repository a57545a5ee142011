// Errors that are drawn once and then constant: gain and coupling per device, offset and drift per
// recording.
#include <cmath>
#include <span>
#include <vector>

#include "sensors/electronics/part_kind.h"
#include "sim/core/math.h"

namespace slipbench {
namespace {

class CouplingStage final : public ElectronicsStage {
 public:
  CouplingStage(const Parameters& parameters, const SignalModel& model, RandomStream stream) {
    for (const Coupling& coupling : model.couplings) {
      const double limit = parameters.number("scale") * coupling.limit;
      if (limit == 0.0) {
        stream.uniform();  // keeps the draws of the other pairs independent of this limit
        continue;
      }
      terms_.push_back({coupling.to, coupling.from, static_cast<float>(stream.uniform(-limit, limit)), 0.0F});
    }
  }

  void apply(std::span<float> values, double /*time*/) override {
    // All terms use the undisturbed sample, so they are computed before any is added.
    for (Term& term : terms_) term.added = term.coefficient * values[term.from];
    for (const Term& term : terms_) values[term.to] += term.added;
  }

 private:
  struct Term {
    std::size_t to;
    std::size_t from;
    float coefficient;
    float added;
  };
  std::vector<Term> terms_;
};

class Gain final : public ElectronicsStage {
 public:
  Gain(const Parameters& parameters, const SignalModel& model, RandomStream stream) : gain_(model.source.size()) {
    for (std::size_t v = 0; v < gain_.size(); ++v) {
      const double sd = parameters.number("scale") * model.gain_sd[v];
      const double log_variance = math::log1p(sd * sd);
      // A value without gain error also takes a draw, so that the others' draws do not depend on
      // it.
      gain_[v] = static_cast<float>(math::exp(std::sqrt(log_variance) * stream.normal() - 0.5 * log_variance));
    }
  }

  void apply(std::span<float> values, double /*time*/) override {
    for (std::size_t v = 0; v < gain_.size(); ++v) values[v] *= gain_[v];
  }

 private:
  std::vector<float> gain_;  // [V]
};

// Returns scale*sd*z of each value, with one standard normal z per source.
std::vector<double> drawn_by_source(const Parameters& parameters, const std::vector<double>& sd, const SignalModel& model,
                                    RandomStream stream) {
  std::vector<double> draw(model.sources), drawn;
  for (double& z : draw) z = stream.normal();
  for (std::size_t v = 0; v < model.source.size(); ++v)
    drawn.push_back(parameters.number("scale") * sd[v] * draw[model.source[v]]);
  return drawn;
}

class Offset final : public ElectronicsStage {
 public:
  Offset(const Parameters& parameters, const SignalModel& model, RandomStream stream) {
    for (const double drawn : drawn_by_source(parameters, model.offset_sd, model, stream))
      offset_.push_back(static_cast<float>(drawn));
  }

  void apply(std::span<float> values, double /*time*/) override {
    for (std::size_t v = 0; v < offset_.size(); ++v) values[v] += offset_[v];
  }

 private:
  std::vector<float> offset_;  // [V] in the value's unit
};

class Drift final : public ElectronicsStage {
 public:
  Drift(const Parameters& parameters, const SignalModel& model, RandomStream stream)
      : slope_(drawn_by_source(parameters, model.drift_sd, model, stream)) {}

  void apply(std::span<float> values, double time) override {
    for (std::size_t v = 0; v < slope_.size(); ++v) values[v] = static_cast<float>(values[v] + slope_[v] * time);
  }

 private:
  std::vector<double> slope_;  // [V] in the value's unit over s
};

}  // namespace

std::vector<PartKind> drawn_once_parts() {
  const std::vector<ParameterSpec> scale{scale_parameter()};
  return {{{"coupling", "Crosstalk between axes: one value leaks into another by a coefficient fixed for a device.",
            "y_i = x_i + sum_j c_ij*x_j,  c_ij uniform in [-scale*limit_ij, scale*limit_ij]\n"
            "i, j: the coupled pairs of the sensor; limit_ij: largest coefficient of the pair",
            "the distribution is assumed", scale},
           DrawnPer::device,
           made<CouplingStage>},
          {{"gain", "Calibration error: each value has its own gain, fixed for a device.",
            "y = g*x,  ln g = s*z - s^2/2,  s^2 = ln(1 + (scale*sd)^2)\n"
            "g: lognormal with mean 1 and standard deviation scale*sd, so never negative; z: standard normal, one a\n"
            "value; sd: of the value's gain",
            "the distribution is assumed", scale},
           DrawnPer::device,
           made<Gain>},
          {{"offset", "Offset that remains after taring: a constant on each value, new in each recording.",
            "y = x + scale*sd*z\n"
            "z: standard normal, one a source (values computed from one another share it); sd: of the value",
            "the form is assumed", scale},
           DrawnPer::trial,
           made<Offset>},
          {{"drift", "Drift: a slow linear change of each value, with a new slope in each recording.",
            "y = x + scale*sd*z*t\n"
            "t: time since the start [s]; z: standard normal, one a source (values computed from one another\n"
            "share it); sd: of the value's slope",
            "the form is assumed; recordings of a few seconds show only a slope", scale},
           DrawnPer::trial,
           made<Drift>}};
}

}  // namespace slipbench
