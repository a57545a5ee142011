// Bindings of grasps commanded from Python.
#include <array>
#include <cstdint>
#include <memory>

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <Eigen/Geometry>

#include "python/module.h"
#include "sim/core/error.h"
#include "tools/gym/episode.h"
#include "tools/gym/grasp_environment.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

SceneFile scene_file(const std::string& path, const Pairs& overrides) {
  SceneFile file = SceneFile::load(path);
  for (const Override& change : overrides_of(overrides)) file.apply(change);
  return file;
}

ActionKind action_named(const std::string& name) {
  if (name == "force") return ActionKind::force;
  if (name == "position") return ActionKind::position;
  throw InputError("command " + quote(name) + "; allowed: force, position");
}

template <typename T>
nb::object copied(std::span<const T> values) {
  auto* const copy = new std::vector<T>(values.begin(), values.end());
  const nb::capsule owner(copy, [](void* held) noexcept { delete static_cast<std::vector<T>*>(held); });
  const std::size_t size = copy->size();
  return nb::cast(nb::ndarray<nb::numpy, T>(copy->data(), 1, &size, owner));
}

// name: (x y z qw qx qy qz, its extent or None).
using Bodies = nb::typed<nb::dict, nb::str, nb::typed<nb::tuple, nb::ndarray<nb::numpy, double>, nb::any>>;

Bodies bodies_of(const GraspEnvironment& environment) {
  Bodies all;
  for (const NamedBody& body : environment.bodies()) {
    const Eigen::Vector3d& at = body.state.pose.position;
    const Eigen::Quaterniond turn(body.state.pose.rotation);
    const std::array<double, 7> pose{at.x(), at.y(), at.z(), turn.w(), turn.x(), turn.y(), turn.z()};
    const nb::object size = body.size.empty() ? nb::none() : copied(std::span<const double>(body.size));
    all[body.name.c_str()] = nb::make_tuple(copied(std::span<const double>(pose)), size);
  }
  return all;
}

using Truth = nb::typed<nb::dict, nb::str, nb::any>;

// The truth after a step, which is hidden from policies.
Truth truth_of(const GraspEnvironment& environment) {
  const EnvironmentStep& step = environment.latest();
  Truth truth;
  truth["time"] = step.time;
  truth["grip_force"] = step.grip_force;
  truth["ideal_force"] = step.ideal_force;
  truth["slip_distance"] = step.slip_distance;
  truth["lifting"] = step.lifting;
  if (environment.over()) truth["outcome"] = environment.outcome();
  return truth;
}

// Observation, reward, terminated (dropped or left behind), ended, truth.
using Result = nb::typed<nb::tuple, nb::ndarray<nb::numpy, float>, double, bool, bool, Truth>;
// The same for several environments: observations; reward, time, grip_force, ideal_force and
// slip_distance; terminated, ended and lifting; episode numbers; draws of the episodes; and the
// outcomes of finished episodes by index.
using Results =
    nb::typed<nb::tuple, nb::ndarray<nb::numpy, float>, nb::ndarray<nb::numpy, double>, nb::ndarray<nb::numpy, std::uint8_t>,
              nb::typed<nb::list, int>, nb::typed<nb::list, std::string>, nb::typed<nb::dict, int, std::string>>;

Result result_of(const GraspEnvironment& environment) {
  const EnvironmentStep& step = environment.latest();
  return nb::make_tuple(copied(environment.observation()), step.reward, step.failed(), step.ended, truth_of(environment));
}

// An environment whose steps release Python's lock.
class Grasp {
 public:
  Grasp(const std::string& path, const Pairs& overrides, const std::string& action)
      : environment_(std::make_unique<GraspEnvironment>(scene_file(path, overrides), action_named(action))) {}

  Result reset(std::uint64_t seed, std::uint64_t episode) {
    {
      const nb::gil_scoped_release release;
      environment_->reset(seed, episode);
    }
    return result_of(*environment_);
  }
  Result step(double action) {
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

  Results reset(const std::vector<std::uint64_t>& seeds, const std::vector<std::uint64_t>& episodes) {
    check(seeds.size(), "seeds");
    check(episodes.size(), "episodes");
    {
      const nb::gil_scoped_release release;
      environments_.reset(seeds, episodes);
    }
    return results();
  }
  Results step(const std::vector<double>& actions) {
    check(actions.size(), "actions");
    {
      const nb::gil_scoped_release release;
      environments_.step(actions);
    }
    return results();
  }
  // Applies `actions` to environment `i` alone, from its current state.
  void replay(std::size_t i, const std::vector<double>& actions) {
    const nb::gil_scoped_release release;
    for (const double action : actions) environments_.environment(i).step(action);
  }
  [[nodiscard]] const std::vector<std::string>& names() { return environments_.environment(0).observation_names(); }
  [[nodiscard]] const std::vector<std::string>& units() { return environments_.environment(0).observation_units(); }
  [[nodiscard]] Texts warnings() { return texts_of(environments_.environment(0).warnings()); }

 private:
  void check(std::size_t found, const char* what) const {
    if (found != environments_.size())
      throw InputError(std::to_string(found) + " " + what + "; expected one for each of " + std::to_string(environments_.size()) +
                       " environments");
  }
  Results results() {
    std::vector<float> observations;
    std::vector<double> numbers;
    std::vector<std::uint8_t> flags;
    nb::list episodes, drawn;
    nb::dict outcomes;
    using Step = EnvironmentStep;
    const std::size_t count = environments_.size();
    for (const auto number : {&Step::reward, &Step::time, &Step::grip_force, &Step::ideal_force, &Step::slip_distance})
      for (std::size_t i = 0; i < count; ++i) numbers.push_back(environments_.environment(i).latest().*number);
    for (std::size_t i = 0; i < count; ++i) flags.push_back(environments_.environment(i).latest().failed() ? 1 : 0);
    for (const auto flag : {&Step::ended, &Step::lifting})
      for (std::size_t i = 0; i < count; ++i) flags.push_back(environments_.environment(i).latest().*flag ? 1 : 0);
    for (std::size_t i = 0; i < count; ++i) {
      const GraspEnvironment& one = environments_.environment(i);
      observations.insert(observations.end(), one.observation().begin(), one.observation().end());
      episodes.append(environments_.episode(i));
      drawn.append(one.params());
      if (one.over()) outcomes[nb::int_(i)] = one.outcome();
    }
    return nb::make_tuple(copied<float>(observations), copied<double>(numbers), copied<std::uint8_t>(flags), episodes, drawn,
                          outcomes);
  }

  VectorEnvironment environments_;
};

}  // namespace

void bind_environments(nb::module_& module) {
  module.attr("strongest") = GraspEnvironment::strongest;
  module.def("trial_of_episode", &trial_of_episode, nb::arg("cells"), nb::arg("draws"), nb::arg("seed"), nb::arg("episode"));
  nb::class_<Grasp>(module, "Grasp")
      .def(nb::init<const std::string&, const Pairs&, const std::string&>())
      .def("reset", &Grasp::reset)
      .def("step", &Grasp::step)
      .def("bodies", [](const Grasp& grasp) { return bodies_of(grasp.environment()); })
      .def_prop_ro("names", [](const Grasp& grasp) { return grasp.environment().observation_names(); })
      .def_prop_ro("units", [](const Grasp& grasp) { return grasp.environment().observation_units(); })
      .def_prop_ro("params", [](const Grasp& grasp) { return grasp.environment().params(); })
      .def("warnings", [](const Grasp& grasp) { return texts_of(grasp.environment().warnings()); })
      .def("command", [](const Grasp& grasp, const std::string& scene) { return grasp.environment().episode_command(scene); });
  nb::class_<Grasps>(module, "Grasps")
      .def(nb::init<const std::string&, const Pairs&, const std::string&, std::size_t, std::size_t>())
      .def("reset", &Grasps::reset)
      .def("step", &Grasps::step)
      .def("replay", &Grasps::replay)
      .def("warnings", &Grasps::warnings)
      .def_prop_ro("units", &Grasps::units)
      .def_prop_ro("names", &Grasps::names);
}

}  // namespace slipbench::python
