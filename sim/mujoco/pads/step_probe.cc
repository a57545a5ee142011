#include "sim/mujoco/pads/step_probe.h"

#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/mujoco/pads/field_plugin.h"

namespace slipbench {
namespace {

// s. The step for evaluating a pose: far below every limit, so that nothing moves.
constexpr double still = 1e-9;

}  // namespace

struct StepProbe::State {
  ModelPointer model;
  std::vector<double> kick;
  StepProbeOptions options;

  // Returns data at rest in the initial pose after one step: every pad is placed.
  [[nodiscard]] DataPointer placed(double step) {
    model->opt.timestep = step;
    DataPointer data;
    call_mujoco([&] { data.reset(mj_makeData(model.get())); });
    if (PadGroup* pads = pad_group_of(model.get(), data.get())) pads->allow_long_steps();
    call_mujoco([&] { mj_step(model.get(), data.get()); });
    return data;
  }
  // Returns the pads' tangents for the present state of their fields, which must have been tried at
  // the present pose.
  [[nodiscard]] PadTangents tangents(const mjData* data) const {
    PadTangents pads;
    for (int instance = 0; instance < static_cast<int>(model->nplugin); ++instance) {
      const PadInstance* pad = pad_of(model.get(), data, instance);
      if (pad == nullptr) continue;
      const PadConfig& config = pad->config();
      using Matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
      const Eigen::Vector3d origin = Eigen::Map<const Eigen::Vector3d>(data->site_xpos + 3 * config.site);
      const Pose pose{Matrix(data->site_xmat + 9 * config.site), origin};
      for (std::size_t k = 0; k < pad->fields().size(); ++k) {
        pads.bodies.push_back({model->site_bodyid[config.site], model->geom_bodyid[config.geoms[k]], origin});
        pads.tangents.push_back(field_tangent(pad->fields()[k], pose * pad->pad_in_surface(k).inverse(), origin, config.damping));
      }
    }
    return pads;
  }
};

StepProbe::StepProbe(const std::string& model, std::span<const double> kick, const StepProbeOptions& options)
    : state_(std::make_unique<State>()) {
  std::array<char, 1000> error{};
  SpecPointer spec;
  call_mujoco([&] { spec.reset(mj_parseXMLString(model.c_str(), nullptr, error.data(), static_cast<int>(error.size()))); });
  if (!spec) throw InputError(fmt::format("the probed model: {}", error.data()));
  spec->option.timestep = still;
  call_mujoco([&] { state_->model.reset(mj_compile(spec.get(), nullptr)); });
  if (!state_->model) throw InputError(fmt::format("the probed model: {}", mjs_getError(spec.get())));
  if (kick.size() != static_cast<std::size_t>(state_->model->nv)) {
    throw InputError(fmt::format("the probed model has {} degrees of freedom, but its kick has {}",
                                 static_cast<int>(state_->model->nv), counted(kick.size(), "value")));
  }
  state_->model->opt.disableflags |= mjDSBL_AUTORESET;
  state_->kick.assign(kick.begin(), kick.end());
  state_->options = options;
}

StepProbe::~StepProbe() = default;

Vibration StepProbe::vibration() {
  const DataPointer data = state_->placed(still);
  const PadTangents pads = state_->tangents(data.get());
  return fastest_vibration(state_->model.get(), data.get(), pads.bodies, pads.tangents);
}

double StepProbe::predicted_step() {
  const DataPointer data = state_->placed(still);
  const PadTangents pads = state_->tangents(data.get());
  const mjModel* m = state_->model.get();
  return divergence_step(linear_model(m, data.get(), pads.bodies, pads.tangents), stepping_of(m));
}

bool StepProbe::bounded(double step) {
  const mjModel* m = state_->model.get();
  const DataPointer data = state_->placed(step);
  mjData* d = data.get();
  std::vector<double> momentum(state_->kick.size());
  const auto energy = [&] {
    mj_mulM(m, d, momentum.data(), d->qvel);
    return mju_dot(momentum.data(), d->qvel, static_cast<int>(m->nv));
  };
  mju_copy(d->qvel, state_->kick.data(), static_cast<int>(m->nv));
  const double most = state_->options.growth * state_->options.growth * energy();
  for (int i = 0; i < state_->options.steps; ++i) {
    call_mujoco([&] { mj_step(m, d); });
    for (const mjWarningStat& warning : d->warning) {
      if (warning.number != 0) return false;
    }
    if (!(energy() <= most)) return false;
  }
  return true;
}

double StepProbe::measured_step() {
  double high = 2.0 * predicted_step(), low = high;
  if (!std::isfinite(high)) return high;
  for (; bounded(high); high *= 2.0) low = high;
  if (low == high) {
    do low *= 0.5;
    while (low > 0.0 && !bounded(low));
  }
  while (high > low * (1.0 + state_->options.resolution)) {
    const double middle = 0.5 * (low + high);
    (bounded(middle) ? low : high) = middle;
  }
  for (const double part : {0.25, 0.5, 0.75, 0.9}) {
    if (!bounded(part * low)) return part * low;
  }
  return low;
}

}  // namespace slipbench
