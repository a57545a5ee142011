// Grasps that are commanded from Python.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "sim/core/error.h"
#include "tools/program/environment/grasp_environment.h"
#include "tools/program/environment/vector_environment.h"
#include "tools/python/module.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

SceneFile scene_file(const std::string& path, const Pairs& overrides) {
  SceneFile file = SceneFile::load(path);
  for (const auto& [key, value] : overrides) file.apply({key, value});
  return file;
}

ActionKind action_named(const std::string& name) {
  if (name == "force") return ActionKind::force;
  if (name == "position") return ActionKind::position;
  throw InputError("command " + quote(name) + "; allowed: force, position");
}

nb::object copied(std::span<const float> values) {
  auto* const copy = new std::vector<float>(values.begin(), values.end());
  const nb::capsule owner(copy, [](void* held) noexcept { delete static_cast<std::vector<float>*>(held); });
  const std::size_t size = copy->size();
  return nb::cast(nb::ndarray<nb::numpy, float>(copy->data(), 1, &size, owner));
}

// What is true after a step, which no policy is to see.
nb::dict truth_of(const GraspEnvironment& environment) {
  const EnvironmentStep& step = environment.latest();
  nb::dict truth;
  truth["time"] = step.time;
  truth["grip_force"] = step.grip_force;
  truth["ideal_force"] = step.ideal_force;
  truth["slip_distance"] = step.slip_distance;
  truth["lifting"] = step.lifting;
  if (environment.over()) truth["outcome"] = environment.outcome();
  return truth;
}

nb::tuple result_of(const GraspEnvironment& environment) {
  const EnvironmentStep& step = environment.latest();
  return nb::make_tuple(copied(environment.observation()), step.reward, step.dropped, step.ended, truth_of(environment));
}

// One that the interpreter's other threads need not wait for.
class Grasp {
 public:
  Grasp(const std::string& path, const Pairs& overrides, const std::string& action)
      : environment_(std::make_unique<GraspEnvironment>(scene_file(path, overrides), action_named(action))) {}

  nb::tuple reset(std::uint64_t seed, std::uint64_t episode) {
    {
      const nb::gil_scoped_release release;
      environment_->reset(seed, episode);
    }
    return result_of(*environment_);
  }
  nb::tuple step(double action) {
    {
      const nb::gil_scoped_release release;
      environment_->step(action);
    }
    return result_of(*environment_);
  }
  [[nodiscard]] const GraspEnvironment& environment() const { return *environment_; }

 private:
  std::unique_ptr<GraspEnvironment> environment_;
};

class Grasps {
 public:
  Grasps(const std::string& path, const Pairs& overrides, const std::string& action, std::size_t count, std::size_t threads)
      : environments_(scene_file(path, overrides), action_named(action), count, threads) {}

  nb::list reset(const std::vector<std::uint64_t>& seeds, const std::vector<std::uint64_t>& episodes,
                 const std::vector<std::uint8_t>& chosen) {
    check(seeds.size(), "seeds");
    check(episodes.size(), "episodes");
    check(chosen.size(), "chosen");
    {
      const nb::gil_scoped_release release;
      environments_.reset(seeds, episodes, chosen);
    }
    return results();
  }
  nb::list step(const std::vector<double>& actions) {
    check(actions.size(), "actions");
    {
      const nb::gil_scoped_release release;
      environments_.step(actions);
    }
    return results();
  }
  [[nodiscard]] const std::vector<std::string>& names() { return environments_.environment(0).observation_names(); }

 private:
  void check(std::size_t found, const char* what) const {
    if (found != environments_.size())
      throw InputError(std::to_string(found) + " " + what + "; allowed: one for each of " + std::to_string(environments_.size()) +
                       " environments");
  }
  nb::list results() {
    nb::list all;
    for (std::size_t i = 0; i < environments_.size(); ++i)
      all.append(
          nb::make_tuple(result_of(environments_.environment(i)), environments_.began(i), environments_.environment(i).params()));
    return all;
  }

  VectorEnvironment environments_;
};

}  // namespace

void bind_environments(nb::module_& module) {
  module.attr("strongest") = GraspEnvironment::strongest;
  nb::class_<Grasp>(module, "Grasp")
      .def(nb::init<const std::string&, const Pairs&, const std::string&>())
      .def("reset", &Grasp::reset)
      .def("step", &Grasp::step)
      .def_prop_ro("names", [](const Grasp& grasp) { return grasp.environment().observation_names(); })
      .def_prop_ro("params", [](const Grasp& grasp) { return grasp.environment().params(); })
      .def("command", [](const Grasp& grasp, const std::string& scene) { return grasp.environment().episode_command(scene); });
  nb::class_<Grasps>(module, "Grasps")
      .def(nb::init<const std::string&, const Pairs&, const std::string&, std::size_t, std::size_t>())
      .def("reset", &Grasps::reset)
      .def("step", &Grasps::step)
      .def_prop_ro("names", &Grasps::names);
}

}  // namespace slipbench::python
