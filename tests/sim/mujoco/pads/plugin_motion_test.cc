// Pads with prescribed motion: positions and velocities are set before every step, so that the
// plugin alone is tested.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/sim/mujoco/pads/plugin_rig.h"

namespace slipbench::testing_plugin {
namespace {

// A pad over a box that turns about the pad's normal, and may be raised, moved and pressed.
std::string pad_over_box(const std::string& pad, double dt) {
  std::ostringstream xml;
  xml << "<mujoco><option timestep='" << dt
      << "' gravity='0 0 0'/><extension><plugin plugin='slipbench.field'><instance name='pad'>" << config("pad", "pad")
      << config("touch", "box") << pad << config("friction", "{static: 0.5}") << config("damping", "0") << config("truth", "true")
      << "</instance></plugin></extension><worldbody>"
      << "<body name='box' pos='0 0 -0.05'><joint name='turn' axis='0 0 1'/>"
      << "<geom name='box' type='box' size='0.05 0.05 0.05' contype='0' conaffinity='0'/></body>"
      << "<body name='pad'><joint name='x' type='slide' axis='1 0 0'/><joint name='z' type='slide' axis='0 0 1'/>"
      << "<geom type='sphere' size='0.01' mass='1' contype='0' conaffinity='0'/><site name='pad'/><plugin instance='pad'/></body>"
      << "</worldbody><sensor><plugin instance='pad'/></sensor></mujoco>";
  return xml.str();
}

// The torque of one pillar at distance r on a turning surface, whose friction mu f_n stretches it
// by at most e. It sticks until its chord 2 r sin(a/2) is e; then it trails: e keeps its length,
// and its end follows the tip along its own direction (a pursuit curve). The angle p between e and
// the tip's path obeys dp/da = 1 - (r/e) sin p, from sin p = e/(2r) at the onset to sin p = e/r in
// the limit. The force has the lever r cos p.
class TrailingPillar {
 public:
  TrailingPillar(double r, double limit, double k_t) : r_(r), limit_(limit), k_t_(k_t), e_(limit / k_t) {}
  [[nodiscard]] double onset() const { return 2.0 * std::asin(e_ / (2.0 * r_)); }
  // Integrates to the angle `a` [rad], which must ascend; fourth order.
  double torque_at(double a) {
    if (r_ == 0.0) return 0.0;
    if (a < onset()) return k_t_ * r_ * r_ * std::sin(a);  // stretch 2 r sin(a/2) at the lever r cos(a/2)
    if (!slides_) {
      slides_ = true;
      at_ = onset();
      p_ = 0.5 * onset();
    }
    const double h = a - at_;
    const auto slope = [this](double p) { return 1.0 - r_ / e_ * std::sin(p); };
    const double k1 = slope(p_), k2 = slope(p_ + 0.5 * h * k1), k3 = slope(p_ + 0.5 * h * k2), k4 = slope(p_ + h * k3);
    p_ += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    at_ = a;
    return limit_ * r_ * std::cos(p_);
  }
  [[nodiscard]] double steady_torque() const { return r_ == 0.0 ? 0.0 : limit_ * std::sqrt(r_ * r_ - e_ * e_); }

 private:
  double r_, limit_, k_t_, e_;
  double at_ = 0.0, p_ = 0.0;
  bool slides_ = false;
};

// Pillars like a PapillArray's, except k_t.
std::string pillars_of_three_heights(double k_n, double k_t) {
  std::ostringstream rows;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const int off_centre = (i != 0) + (j != 0);
      const double drop = off_centre == 0 ? 0.0 : off_centre == 1 ? 0.2e-3 : 0.45e-3;
      rows << (i + j == -2 ? "[[" : ", [") << 0.007 * i << ", " << 0.007 * j << ", " << drop << ", " << k_n << ", " << k_t << "]";
    }
  }
  return config("elements", rows.str() + "]");
}

// Nine pillars with drops of 0, 0.2 and 0.45 mm, pressed by 1 mm; the box turns at 0.4 rad/s.
// `lever`: least reduction of the torque's peak below sum mu f_n r, which shows the trailing lever.
void expect_torque(const std::string& pad, double k_t, double lever) {
  const double k_n = 7100.0, mu = 0.5, depth = 1e-3, rate = 0.4, dt = 1e-4;
  const Model model = load(pad_over_box(pad, dt));
  const Data data = data_of(model);
  const PadLayout layout = pad_of(model.get(), data.get(), 0)->sensor().layout();
  std::vector<TrailingPillar> pillars;
  for (const Element& element : layout.elements) {
    pillars.emplace_back(element.tip.head<2>().norm(), mu * k_n * (depth - element.tip.z()), k_t);
  }
  std::vector<double> onset(9, std::nan(""));
  double peak = 0.0, exact_peak = 0.0, torque = 0.0;
  for (int tick = 0; tick * dt < 4.0; ++tick) {
    const double t = tick * dt;
    data->time = t;  // a sum of steps would drift from t by rounding
    data->qpos[0] = rate * t;
    data->qvel[0] = rate;
    data->qpos[1] = data->qvel[1] = data->qvel[2] = 0.0;
    data->qpos[2] = -depth;
    mj_step(model.get(), data.get());
    torque = -data->qfrc_passive[0];
    double exact = 0.0;
    for (TrailingPillar& pillar : pillars) exact += pillar.torque_at(rate * t);
    ASSERT_NEAR(torque, exact, 1e-3 * exact + 1e-9) << "at " << t << " s";
    peak = std::max(peak, torque);
    exact_peak = std::max(exact_peak, exact);
    for (const ContactEvent& event : pad_of(model.get(), data.get(), 0)->truth(FramePart::all).events) {
      if (event.kind == EventKind::slip && std::isnan(onset[event.unit])) onset[event.unit] = event.time;
    }
  }
  double steady = 0.0, longest = 0.0;
  for (std::size_t i = 0; i < 9; ++i) {
    steady += pillars[i].steady_torque();
    longest += mu * k_n * (depth - layout.elements[i].tip.z()) * layout.elements[i].tip.head<2>().norm();
    if (layout.elements[i].tip.head<2>().norm() == 0.0) {
      EXPECT_TRUE(std::isnan(onset[i])) << "the centre pillar only twists";
    } else {
      EXPECT_NEAR(onset[i], pillars[i].onset() / rate, 1e-3 * pillars[i].onset() / rate) << "pillar " << i;
    }
  }
  testing::Test::RecordProperty("peak_error", figure(peak / exact_peak - 1.0));
  testing::Test::RecordProperty("steady_error", figure(torque / steady - 1.0));
  EXPECT_NEAR(peak, exact_peak, 1e-3 * exact_peak);
  EXPECT_NEAR(torque, steady, 1e-3 * steady);
  EXPECT_GT(longest - exact_peak, lever * longest);
}

TEST(PluginMotion, RotatingBoxSlipsByRadiusAndPullsWithTheTrailingLever) {
  expect_torque(real_pillars(), 3900.0, 1e-3);
  // e is 2.6 times as long: the peak's lever r sqrt(1 - (e/2r)^2) is shorter than r by at least 0.8
  // % for the edges.
  expect_torque(pillars_of_three_heights(7100.0, 1500.0), 1500.0, 5e-3);
}

TEST(PluginMotion, HundredTouchDownsLeaveNoForceBehind) {
  // Down by 1 mm over 10 ms, a drag of 2 mm over 20 ms (mu k_n/k_t 1 mm = 3 mm for the first pads
  // of 500 N/m: some stick to the end), and straight up; then the same 0.1 mm further on.
  const double dt = 1e-3, k_n = 3000.0, k_t = 500.0;
  const Model model = load(pad_over_box(config("elements", square(3, 0.007, k_n, k_t)), dt));
  const Data data = data_of(model);
  const auto move = [&](double x, double z, double vx, double vz) {
    data->qpos[0] = data->qvel[0] = 0.0;
    data->qpos[1] = x;
    data->qpos[2] = z;
    data->qvel[1] = vx;
    data->qvel[2] = vz;
    mj_step(model.get(), data.get());
  };
  for (int cycle = 0; cycle < 100; ++cycle) {
    const double x = 1e-4 * cycle;
    for (int i = 0; i <= 15; ++i) move(x, 0.5e-3 - 1e-4 * i, 0.0, -0.1);
    // Touched straight down: nine springs pressed by 1 mm, with no sideways force except the
    // rounding of x.
    EXPECT_NEAR(data->qfrc_passive[2], 9.0 * k_n * 1e-3, 1e-9 * 27.0) << "cycle " << cycle;
    EXPECT_NEAR(data->qfrc_passive[1], 0.0, 1e-12) << "cycle " << cycle;
    for (int i = 1; i <= 20; ++i) move(x + 1e-4 * i, -1e-3, 0.1, 0.0);
    EXPECT_NEAR(data->qfrc_passive[1], -9.0 * k_t * 2e-3, 1e-9 * 9.0) << "cycle " << cycle;
    for (int i = 1; i <= 15; ++i) move(x + 2e-3, -1e-3 + 1e-4 * i, 0.0, 0.1);
    EXPECT_EQ(data->qfrc_passive[0], 0.0);
    EXPECT_EQ(data->qfrc_passive[1], 0.0);
    EXPECT_EQ(data->qfrc_passive[2], 0.0);
    const ContactFrame& truth = pad_of(model.get(), data.get(), 0)->truth(FramePart::all);
    EXPECT_EQ(truth.state, PadState::no_contact);
    EXPECT_TRUE((truth.force == 0.0).all());
  }
}

TEST(PluginMotion, DashpotsActOnTheSumAndNeverBeyondTheCone) {
  // One element of 3 kN/m and 500 N/m, pressed by 1 mm, moving at 2 mm/s across and 1 mm/s inwards
  // with tau = 1 ms: normal k_n (1 mm + tau 1 mm/s) = 3.003 N; tangential k_t tau 2 mm/s = 1e-3 N
  // at the instant of touch. At 10 m/s across, the sum is limited to mu k_n 1 mm = 1.5 N.
  std::string xml = pad_over_box(config("elements", "[[0, 0, 0, 3000, 500]]"), 1e-3);
  xml.replace(xml.find("'damping' value=\"0\""), 19, "'damping' value=\"1 ms\"");
  const Model model = load(xml);
  const Data data = data_of(model);
  data->qpos[2] = -1e-3;
  data->qvel[1] = 2e-3;
  data->qvel[2] = -1e-3;
  mj_forward(model.get(), data.get());
  EXPECT_NEAR(data->qfrc_passive[2], 3.003, 1e-12);
  EXPECT_NEAR(data->qfrc_passive[1], -1e-3, 1e-12);
  data->qvel[1] = 10.0;
  mj_forward(model.get(), data.get());
  EXPECT_NEAR(data->qfrc_passive[1], -1.5, 1e-12);
  data->qvel[2] = 2.0;  // pulled away faster than the spring pushes: 3 N - 6 N would pull
  mj_forward(model.get(), data.get());
  EXPECT_EQ(data->qfrc_passive[2], 0.0);
}

}  // namespace
}  // namespace slipbench::testing_plugin
