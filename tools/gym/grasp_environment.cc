#include "tools/gym/grasp_environment.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "sim/api/pad_state.h"
#include "sim/grasp/grasp.h"
#include "tools/files/reject.h"
#include "tools/gym/episode.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {
namespace {

constexpr std::size_t most_trials = 1'000'000;  // limit of TrialPlan
constexpr std::size_t beside_sensors = 3;       // position, moving, stopped

Parameters follower_parameters() {
  Parameters parameters =
      defaults_of({controllers::force_per_count_spec(), controllers::ceiling_spec(), controllers::loosen_spec()});
  parameters.set("loosen", true);
  return parameters;
}

Catalogues episode_catalogues() {
  Catalogues catalogues = program_catalogues();
  catalogues.lift_end = nullptr;
  return catalogues;
}

}  // namespace

// Takes the controller's place and stores the latest sample of every sensor.
class GraspEnvironment::Observer final : public Controller, public SampleListener {
 public:
  Observer(const GripSource& source, std::vector<float>& observation) : observation_(observation) {
    for (const SensorSource& sensor : source.sensors) {
      first_.push_back(values_);
      for (const Channel& channel : sensor.channels) values_ += channel.size();
    }
  }
  GripCommand update(const ControlInput&) override {
    throw std::logic_error("a grasp that is commanded from outside has asked its controller");
  }
  SampleListener* listener() override { return this; }
  void hear(std::size_t sensor, const SensorFrame& sample) override {
    std::ranges::copy(sample.values, observation_.begin() + static_cast<std::ptrdiff_t>(first_[sensor]));
  }

 private:
  std::vector<float>& observation_;
  std::vector<std::size_t> first_;  // first value of each sensor
  std::size_t values_ = 0;
};

GraspEnvironment::GraspEnvironment(const SceneFile& file, ActionKind action)
    : catalogues_(std::make_unique<const Catalogues>(episode_catalogues())), file_(file), action_(action) {
  registers_ = controllers::registers_of(defaults_of(controllers::with_registers({})));
  reset(parse_scene(file_, *catalogues_).seed, 0);
  const Scene& scene = run_->scene();
  for (std::size_t sensor = 0; sensor < scene.sensors.size(); ++sensor) {
    for (const Channel& channel : run_->sensors()[sensor]->channels()) {
      for (std::size_t i = 0; i < channel.size(); ++i) {
        names_.push_back(fmt::format(
            "{}.{}", scene.sensors[sensor].name,
            channel.channel_names.size() == channel.size() ? channel.channel_names[i] : fmt::format("{}[{}]", channel.name, i)));
        units_.push_back(channel.unit);
      }
    }
  }
  names_.insert(names_.end(), {"gripper.position", "gripper.moving", "gripper.stopped"});
  units_.insert(units_.end(), {"counts", "1", "1"});
  if (scene.detector) {
    names_.emplace_back("slip.state");
    units_.emplace_back("1");
  }
}

void GraspEnvironment::reset(std::uint64_t seed, std::uint64_t episode) {
  if (!plan_ || seed != seed_) {
    const std::size_t cells = TrialPlan(file_, *catalogues_, 1, seed).size();
    plan_.emplace(file_, *catalogues_, most_trials / cells, seed);
    seed_ = seed;
  }
  const std::size_t cells = plan_->size() / plan_->draws();
  trial_ = trial_of_episode(cells, plan_->draws(), seed, episode);
  TrialPlan::Trial trial = plan_->trial(trial_);
  if (!trial.scene.grasp) throw InputError(file_.name() + " is not a grasp; expected a scene with 'grip' or 'box'");
  if (trial.scene.guided()) throw InputError(file_.name() + ": the motion 'guided' needs commands to the arm; use lift");
  trial.scene.seed = seed;
  params_ = params_json(trial.drawn);
  outcome_.clear();
  latest_ = {};
  std::ranges::fill(observation_, 0.0F);
  run_.reset();
  try {
    TrialRun::Replacements replacements;
    replacements.controller = [this](const GripSource& source) { return std::make_unique<Observer>(source, observation_); };
    run_ = std::make_unique<TrialRun>(std::move(trial.scene), trial_, Recording::outcome, max_record_bytes, nullptr,
                                      std::move(replacements));
    if (action_ == ActionKind::force) {
      force_.emplace(run_->sensors().front()->channels(), "with a commanded force");
      follower_.emplace(follower_parameters());
    }
  } catch (const SceneValueError& error) {
    throw InputError(plan_->where(trial_, error.path()) + ": " + error.what());
  }
  std::size_t values = beside_sensors + (run_->scene().detector ? 1 : 0);
  for (const auto& sensor : run_->sensors()) {
    for (const Channel& channel : sensor->channels()) values += channel.size();
  }
  observation_.resize(values, 0.0F);
  run_to_read();
}

void GraspEnvironment::run_to_read() {
  bool asked = false;
  const GraspTruth& truth = run_->box()->truth();
  while (!asked && !run_->finished() && !truth.dropped && !truth.left_behind) asked = run_->step_or_wait();
  look();
  latest_.dropped = truth.dropped;
  latest_.left_behind = truth.left_behind;
  latest_.ended = !asked && !latest_.failed();
  if (over()) outcome_ = outcome_json(run_->finish().record.outcome);
}

void GraspEnvironment::look() {
  const GraspTruth& truth = run_->box()->truth();
  const ContactFrame& contact = run_->simulation().contact(0);
  latest_.time = truth.time;
  latest_.grip_force = truth.grip_force;
  latest_.ideal_force = run_->box()->ideal_force();
  latest_.lifting = truth.time >= run_->box()->lift_start();
  latest_.slip_distance = contact.slip_distance.maxCoeff();
  const ControlInput& input = run_->loop().awaiting();
  const std::size_t beside = observation_.size() - beside_sensors - (run_->scene().detector ? 1 : 0);
  observation_[beside] = static_cast<float>(input.gripper.position);
  observation_[beside + 1] = input.gripper.moving ? 1.0F : 0.0F;
  observation_[beside + 2] = input.gripper.stopped ? 1.0F : 0.0F;
  if (run_->scene().detector) observation_[beside + 3] = static_cast<float>(input.slip.state);
}

GripCommand GraspEnvironment::command_for(double action) {
  const double share = 0.5 * (action + 1.0);
  GripCommand command = registers_;
  if (action_ == ActionKind::position) {
    command.position = static_cast<int>(std::lround(share * max_register));
  } else {
    const ControlInput& input = run_->loop().awaiting();
    command.position = follower_->toward(force_->total(input.frame), share * strongest, input.gripper.position);
  }
  return command;
}

const std::vector<NamedBody>& GraspEnvironment::bodies() const {
  if (!run_) throw std::logic_error("no episode has begun; call reset() first");
  return run_->simulation().bodies();
}

void GraspEnvironment::check_action(double action) {
  if (!(action >= -1.0 && action <= 1.0)) reject("action {}; allowed: -1 to 1", action);
}

const EnvironmentStep& GraspEnvironment::step(double action) {
  check_action(action);
  if (!run_ || over()) throw std::logic_error("the episode is over or has not begun; call reset() first");
  const double before = latest_.time, slipped = latest_.slip_distance;
  const bool lifting = latest_.lifting;
  run_->loop().command(command_for(action));
  run_to_read();
  const double share = (latest_.time - before) / run_->scene().duration;
  latest_.reward = -latest_.grip_force / latest_.ideal_force * share;
  if (lifting) latest_.reward -= slip_penalty * std::max(0.0, latest_.slip_distance - slipped);
  if (latest_.failed()) latest_.reward -= drop_penalty;
  return latest_;
}

std::vector<Warning> GraspEnvironment::warnings() const {
  const TrialPlan plan(file_, *catalogues_, 0, seed_);
  std::vector<std::size_t> trials(plan.size());
  std::iota(trials.begin(), trials.end(), std::size_t{0});
  return scene_warnings(plan, trials, true);
}

std::string GraspEnvironment::episode_command(const std::string& scene) const {
  return fmt::format("slipbench run {} --seed {} --trials {} --trial {}", scene, seed_, plan_->size(), trial_);
}

VectorEnvironment::VectorEnvironment(const SceneFile& file, ActionKind action, std::size_t count, std::size_t threads)
    : places_(count), errors_(count) {
  if (count == 0 || threads == 0) throw std::invalid_argument("a vector environment of nothing");
  for (Place& place : places_) place.environment = std::make_unique<GraspEnvironment>(file, action);
  while (threads_.size() + 1 < std::min(threads, count)) threads_.emplace_back([this] { wait_for_work(); });
}

VectorEnvironment::~VectorEnvironment() {
  {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

void VectorEnvironment::take_places() {
  std::unique_lock lock(mutex_);
  while (next_ < places_.size()) {
    const std::size_t mine = next_++;
    ++busy_;
    const auto& work = *work_;
    lock.unlock();
    try {
      work(places_[mine], mine);
    } catch (...) {
      errors_[mine] = std::current_exception();
    }
    lock.lock();
    --busy_;
  }
  if (busy_ == 0) changed_.notify_all();
}

void VectorEnvironment::wait_for_work() {
  std::uint64_t done = 0;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stopped_ || round_ != done; });
      if (stopped_) return;
      done = round_;
    }
    take_places();
  }
}

void VectorEnvironment::for_each(const std::function<void(Place&, std::size_t)>& work) {
  {
    const std::scoped_lock lock(mutex_);
    work_ = &work;
    next_ = 0;
    ++round_;
  }
  changed_.notify_all();
  take_places();
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return next_ >= places_.size() && busy_ == 0; });
  }
  std::vector<std::exception_ptr> errors(places_.size());
  errors.swap(errors_);
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

void VectorEnvironment::reset(std::span<const std::uint64_t> seeds, std::span<const std::uint64_t> episodes) {
  for_each([&](Place& place, std::size_t i) {
    place.seed = seeds[i];
    place.episode = episodes[i];
    place.environment->reset(place.seed, place.episode);
  });
}

void VectorEnvironment::step(std::span<const double> actions) {
  // All actions are checked before any environment steps.
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (!places_[i].environment->over()) GraspEnvironment::check_action(actions[i]);
  }
  for_each([&](Place& place, std::size_t i) {
    if (place.environment->over()) {
      place.environment->reset(place.seed, ++place.episode);
    } else {
      place.environment->step(actions[i]);
    }
  });
}

}  // namespace slipbench
