// Models with pads of the plugin, as users write them.
#pragma once

#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <numbers>
#include <sstream>

#include <Eigen/Core>

#include "sim/mujoco/pads/field_plugin.h"
#include "sim/mujoco/pads/register_plugin.h"
#include "tests/sim/mujoco/pads/models.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench::testing_plugin {

inline constexpr double g = 9.81;  // m/s2, MuJoCo's default

inline void register_plugin_once() {
  [[maybe_unused]] static const bool once = [] {
    register_field_plugin({pad_catalogues(), &make_sensor});
    return true;
  }();
}

inline Model load(const std::string& xml) {
  register_plugin_once();
  return compile(parse(xml).get());
}

inline Data data_of(const Model& model) { return Data(mj_makeData(model.get())); }

// Returns the text of the mju_error that ends `action`; empty: no error. `action` must own nothing,
// because the error jumps over it.
template <class Action>
std::string mju_error_of(const Action& action) {
  static std::array<char, 2000> text;
  static std::jmp_buf back;
  text[0] = '\0';
  mju_user_error = [](const char* message) {
    std::snprintf(text.data(), text.size(), "%s", message);
    std::longjmp(back, 1);
  };
  if (setjmp(back) == 0) action();
  mju_user_error = nullptr;
  return text.data();
}

// n x n elements, one every `pitch` [m], with the stiffness [N/m] of one: the attribute `elements`.
inline std::string square(int n, double pitch, double k_n, double k_t) {
  std::ostringstream rows;
  rows.precision(17);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      rows << (i + j == 0 ? "[[" : ", [") << pitch * (i - 0.5 * (n - 1)) << ", " << pitch * (j - 0.5 * (n - 1)) << ", 0, " << k_n
           << ", " << k_t << "]";
    }
  }
  return rows.str() + "]";
}

inline std::string config(const std::string& key, const std::string& value) {
  return "<config key='" + key + "' value=\"" + value + "\"/>";
}

// The pad of the limits: nine elements of 3 kN/m and 500 N/m.
inline std::string nine_pillars() { return config("elements", square(3, 0.007, 3000.0, 500.0)); }
inline std::string real_pillars() { return config("sensor", "{type: papillarray}"); }

// A box between a fixed pad and one on a slider that ctrl[0] [N] closes.
struct Grip {
  double mass = 0.1;  // kg
  double mu = 0.5;
  double dt = 1e-3;  // s
  std::string integrator = "implicitfast";
  std::string left = nine_pillars(), right = nine_pillars();  // elements of the pads; empty: MuJoCo's own contact instead
  bool perturbed = true;  // moved by 0.13 mm and turned by 4 mrad, so that nothing balances by symmetry
  bool truth = true;
  std::string option{};  // attributes
  std::string more{};    // elements of the model
};

inline std::string grip_xml(const Grip& grip) {
  const bool plugin = !grip.left.empty();
  const auto instance = [&](const std::string& name, const std::string& pad) {
    return "<instance name='" + name + "'>" + config("pad", name) + config("touch", "box") + pad +
           (pad.find("friction") == std::string::npos ? config("friction", "{static: " + std::to_string(grip.mu) + "}") : "") +
           config("truth", grip.truth ? "true" : "false") + "</instance>";
  };
  const std::string geoms = plugin ? "contype='0' conaffinity='0'" : "friction='" + std::to_string(grip.mu) + " 0.005 0.0001'";
  const std::string finger = "<geom type='box' size='0.005 0.0105 0.0105' mass='0.05' " + geoms + " pos='0 0 0.005'/>";
  std::ostringstream xml;
  xml.precision(17);
  xml << "<mujoco><option timestep='" << grip.dt << "' integrator='" << grip.integrator << "' gravity='0 0 0' " << grip.option
      << "/>"
      << (plugin ? "<extension><plugin plugin='slipbench.field'>" + instance("left", grip.left) + instance("right", grip.right) +
                       "</plugin></extension>"
                 : "")
      << "<worldbody><body name='box' " << (grip.perturbed ? "pos='0 0.00013 0.00013' axisangle='0.5 0.7 0.6 0.004'" : "")
      << "><freejoint/><geom name='box' type='box' size='0.015 0.02 0.06' mass='" << grip.mass << "' " << geoms << "/></body>"
      << "<body name='left' pos='-0.0151 0 0' xyaxes='0 0 1 0 1 0'><site name='left'/>" << finger
      << (plugin ? "<plugin instance='left'/>" : "") << "</body>"
      << "<body name='right' pos='0.0151 0 0' xyaxes='0 0 -1 0 1 0'><joint name='right' type='slide' axis='0 0 -1' damping='50'/>"
      << "<site name='right'/>" << finger << (plugin ? "<plugin instance='right'/>" : "") << "</body></worldbody>"
      << "<actuator><motor joint='right'/></actuator>"
      << (plugin ? "<sensor><plugin name='left' instance='left'/><plugin name='right' instance='right'/></sensor>" : "")
      << grip.more << "</mujoco>";
  return xml.str();
}

// A number as shown in a test's record.
inline std::string figure(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

// Force [N] in the world on the object that the pad touches, from the pad's truth.
inline Eigen::Vector3d force_of_pad(const mjModel* model, const mjData* data, int instance) {
  PadInstance& pad = *pad_of(model, data, instance);
  const int site = pad.config().site;
  return -(pose_of(data->site_xpos + 3 * site, data->site_xmat + 9 * site).rotation *
           pad.truth(FramePart::all).force.rowwise().sum().matrix());
}

// A grip that is closed, loaded and observed.
class GripRun {
 public:
  explicit GripRun(const Grip& grip) : grip_(grip), model_(load(grip_xml(grip))), data_(data_of(model_)) {}

  [[nodiscard]] mjModel* m() { return model_.get(); }
  [[nodiscard]] mjData* d() { return data_.get(); }
  // The least grip [N] that holds the box: two pads, each with mu F.
  [[nodiscard]] double threshold() const { return grip_.mass * g / (2.0 * grip_.mu); }
  [[nodiscard]] double height() { return data_->qpos[2]; }

  // Closes with `force` [N], then applies the weight as a half cosine of 1 s, so slow that the box,
  // at 300 rad/s or more on its springs, follows within (pi/T)^2/(2 w^2) = 5e-5 of it.
  void hold(double force) {
    close(force);
    const int ramp = steps_of(1.0);
    for (int i = 1; i <= ramp; ++i) {
      m()->opt.gravity[2] = -0.5 * g * (1.0 - std::cos(std::numbers::pi * i / ramp));
      mj_step(m(), d());
    }
  }
  void close(double force) {
    const int ramp = steps_of(0.2);
    for (int i = 1; i <= 2 * ramp; ++i) {
      d()->ctrl[0] = force * std::min(1.0, static_cast<double>(i) / ramp);
      mj_step(m(), d());
    }
  }
  void wait(double seconds) {
    for (int i = 0; i < steps_of(seconds); ++i) mj_step(m(), d());
  }

 private:
  [[nodiscard]] int steps_of(double seconds) const { return static_cast<int>(std::lround(seconds / grip_.dt)); }
  Grip grip_;
  Model model_;
  Data data_;
};

}  // namespace slipbench::testing_plugin
