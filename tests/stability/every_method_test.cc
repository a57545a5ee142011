// Every hard case with every simulation method: fields with explicit pads under each of MuJoCo's
// integrators, fields with implicit pads, articulated pads. The other files of this folder test a
// case against its closed form with one or two of these. Here each run must
// - end with finite values and without a warning (otherwise DynamicSimulation throws),
// - gain no energy beyond the error of a touch within a step,
// - carry its weight at rest, and the push that it resists,
// - converge as the step shrinks, to a closed form or to the finest run of explicit pads under
//   implicitfast,
// or be refused before the first step.
#include <cctype>
#include <functional>
#include <limits>
#include <numbers>
#include <tuple>

#include "tests/stability/hard_case.h"

namespace slipbench::hard {
namespace {

struct Method {
  std::string name, fidelity, solver, integrator;
};

const std::vector<Method>& methods() {
  static const std::vector<Method> all{{"Euler", "field", "explicit", "Euler"},
                                       {"implicit", "field", "explicit", "implicit"},
                                       {"implicitfast", "field", "explicit", "implicitfast"},
                                       {"discrete", "field", "explicit", "discrete"},
                                       {"RK4", "field", "explicit", "RK4"},
                                       {"implicit_pads", "field", "implicit", "discrete"},
                                       {"articulated", "articulated", "explicit", "discrete"}};
  return all;
}

// Results of a run.
struct Outcome {
  double phase = 0.0;        // h omega of the fastest mode
  double answer = 0.0;       // the value that must converge
  double energy_gain = 0.0;  // largest energy above the initial one plus the push's work, relative to the largest energy
  double carried_off = 0.0;  // force of the pad over the second half of the run minus the weight, relative to the weight
  double held_off = 0.0;     // the same along x, minus the push, relative to the weight
};

// A box on a pad. The run ends 2 ms before its duration.
struct HardCase {
  std::string name;
  BoxOnPad box;
  std::function<double(CaseRun&)> answer;
  double scale = 1.0;                                          // of the answer
  double expected = std::numeric_limits<double>::quiet_NaN();  // the answer by a closed form; NaN: the finest implicitfast run's
  double tolerance = 0.0;                                      // of the closed form, relative to the scale
  double articulated = 0.03;  // error of articulated pads at the finest step, relative to the scale; README.md lists exceptions
  bool rattles = false;       // articulated tips rattle so much in sliding that convergence is not visible
  bool rests = false;         // rests on the pad, vertically
  bool held = false;          // also sideways, against the push
  bool smooth = true;         // no touch, slip or separation within a step decides the answer
  bool fast = false;          // over 100 mm/s on the surface, where articulated tips chatter: their load is right only on average
};

double push_at(const BoxOnPad& box, double time) {
  for (std::size_t i = 1; i < box.push.size(); ++i) {
    const auto [t0, f0] = box.push[i - 1];
    const auto [t1, f1] = box.push[i];
    if (time <= t1) return time <= t0 ? f0 : f0 + (f1 - f0) * (time - t0) / (t1 - t0);
  }
  return box.push.back().second;
}

Outcome run_of(const HardCase& hard, const std::string& time_step) {
  BoxOnPad box = hard.box;
  box.time_step = time_step;
  CaseRun run(box);
  Outcome outcome;
  const double step = run->time_step(0);
  outcome.phase = step * modes_of(box).fastest;
  const double end = longest_sample * (std::ceil(box.duration / longest_sample - 1e-9) - 1.0), weight = box.mass * box.gravity;
  const auto ticks = static_cast<int>(std::lround(end / step));
  const Eigen::Vector3d inertia = inertia_of(box.mass);
  // Single-stage integrators have a tick's velocities half a step before its positions, so motion
  // is evaluated between two ticks.
  const bool staggered = box.fidelity == "field" && box.solver == "explicit" && box.integrator != "RK4";
  double start = 0.0, given = 0.0, most = 0.0, gain = 0.0, carried = 0.0, held = 0.0, windows = 0.0, x = 0.0;
  double potential = 0.0, stored = 0.0;                                 // J, of the previous tick
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero(), spin = momentum;  // of the previous tick
  for (int tick = 0; tick <= ticks; ++tick) {
    run.step();
    const BodyState& body = run.body("box");
    const Eigen::Vector3d momentum_now = run.momentum(), spin_now = body.pose.rotation.transpose() * body.angular_velocity;
    if (tick > 0) {
      const Eigen::Vector3d p = staggered ? Eigen::Vector3d(0.5 * (momentum + momentum_now)) : momentum;
      const Eigen::Vector3d w = staggered ? Eigen::Vector3d(0.5 * (spin + spin_now)) : spin;
      const double kinetic = 0.5 * p.squaredNorm() / box.mass + 0.5 * w.cwiseAbs2().dot(inertia);
      most = std::max(most, kinetic + stored);
      // An articulated pad's labels are tip forces, including joint damping, not the springs'
      // forces; the stored energy is left out after the start.
      const double energy = kinetic + (box.fidelity == "articulated" && tick > 1 ? 0.0 : stored) + potential;
      if (tick == 1) start = energy;
      gain = std::max(gain, energy - start - given);
      given += push_at(box, (tick - 0.5) * step) * (body.pose.position.x() - x);
    }
    momentum = momentum_now;
    spin = spin_now;
    x = body.pose.position.x();
    potential = weight * (body.pose.position + body.pose.rotation * centre).z();
    stored = 0.0;
    const ContactFrame& truth = run->contact(0);
    for (Eigen::Index i = 0; i < truth.contact_force.cols(); ++i) {
      const Element& element = box.pad.elements[static_cast<std::size_t>(i)];
      stored += 0.5 * std::pow(truth.contact_force(2, i), 2) / element.k_normal +
                0.5 * truth.contact_force.col(i).head<2>().matrix().squaredNorm() / element.k_tangential;
    }
    if (2 * tick >= ticks) {
      const double window = std::pow(std::sin(2.0 * std::numbers::pi * tick / ticks), 2);  // averages ringing out
      carried += window * run.force().z();
      held += window * (run.force().x() + push_at(box, tick * step));
      windows += window;
    }
  }
  outcome.answer = hard.answer(run);
  outcome.energy_gain = gain / most;
  outcome.carried_off = weight > 0.0 ? carried / windows / weight - 1.0 : 0.0;
  outcome.held_off = weight > 0.0 ? held / windows / weight : 0.0;
  return outcome;
}

double momentum_along(CaseRun& run) { return run.momentum().x(); }

// Put down askew and pushed with `part` of the friction limit.
HardCase pushed(const std::string& name, const BoxOnPad& box, double part) {
  HardCase hard{name, box, momentum_along};
  const double period = 2.0 * std::numbers::pi / modes_of(box).slowest, push = part * box.mu * box.mass * g;
  hard.box.push = {{0.0, 0.0}, {2.0 * period, push}};
  hard.box.duration = (part < 1.0 ? 15.0 : 4.0) * period + 2.0 * longest_sample;
  hard.scale = part < 1.0 ? push / modes_of(box).slowest : (part - 1.0) * push * 3.0 * period;
  hard.rests = hard.held = part < 1.0;
  if (part < 1.0) {
    hard.expected = 0.0;  // has decayed; articulated pads, whose dashpots are limited to 1 ms, not quite
    hard.tolerance = 1e-4;
    return hard;
  }
  // Sticks until the push is mu m g, then gains the excess. By then it has the momentum of the
  // springs' motion, (1 -+ 1) m rate/K_t: 0.6 % of the scale either way; the skew position
  // contributes as much.
  const double slips = 2.0 * period / part, bears = push / part;
  const double end = longest_sample * (std::ceil(hard.box.duration / longest_sample - 1e-9) - 1.0);
  const double lateral = static_cast<double>(box.pad.elements.size()) * box.pad.elements[0].k_tangential;
  hard.expected =
      box.mass * push / (2.0 * period) / lateral + (push - bears) * (0.5 * (2.0 * period - slips) + end - 2.0 * period);
  hard.tolerance = 0.012;
  hard.articulated = 0.04 * hard.expected / hard.scale;
  return hard;
}

// Kinetic energy of translation and rotation [J].
double motion_of(CaseRun& run) {
  const BodyState& box = run.body("box");
  const double mass = run->model()->body_mass[mj_name2id(run->model(), mjOBJ_BODY, "box")];
  const Eigen::Vector3d spin = box.pose.rotation.transpose() * box.angular_velocity;
  return 0.5 * run.momentum().squaredNorm() / mass + 0.5 * spin.cwiseAbs2().dot(inertia_of(mass));
}

// At 0.5 m/s, without weight and dashpots; sideways at 0.1 m/s with friction.
HardCase blow(const std::string& name, double mass, double stiffer, double mu) {
  HardCase hard{name, {}, motion_of};
  BoxOnPad& box = hard.box;
  box.mass = mass;
  box.mu = mu;
  box.gravity = 0.0;
  box.pad = flat_square(3, pitch, stiffer * k_n, stiffer * k_t);
  const double omega = std::sqrt(9.0 * stiffer * k_n / mass), deep = 0.5 / omega;
  box.turn = {0.3 * deep / pitch, 0.2 * deep / pitch, 0.004};
  box.position.z() = 0.5 * deep;
  box.velocity = {mu > 0.0 ? 0.1 : 0.0, 0.0, -0.5};
  box.duration = 12.0 / omega + 2.0 * longest_sample;
  hard.scale = 0.5 * mass * 0.25;
  if (mu == 0.0) hard.expected = hard.scale;  // all energy is returned
  hard.articulated = mu == 0.0 ? 0.2 : 0.35;  // converges more slowly than first order
  hard.smooth = false;
  return hard;
}

// The box passes at 100 mm/s, touches at 1 mm/s, rebounds at 1 mm/s, and slips all the time. It
// touches askew by a twentieth of its depth, and some of the impact goes into rotation.
HardCase grazing() {
  HardCase hard = blow("grazing touch and lift-off", 0.1, 1.0, 0.5);
  const double omega = std::sqrt(9.0 * k_n / 0.1), deep = 1e-3 / omega;
  hard.box.turn = {0.05 * deep / pitch, 0.03 * deep / pitch, 4e-3};
  hard.box.position.z() = 0.3 * deep;
  hard.box.velocity = {0.1, 0.0, -1e-3};
  // Friction takes mu times the impact's momentum; the answer is relative to that.
  hard.answer = [](CaseRun& run) {
    const Eigen::Vector3d speed = run.momentum() / 0.1;
    return (0.1 - speed.x()) / (0.5 * (1e-3 + speed.z()));
  };
  hard.scale = hard.expected = 1.0;
  return hard;
}

HardCase tumbling() {
  HardCase hard{"leaning, tumbling box falls", {}, [](CaseRun& run) {
                  const Eigen::Vector3d at = run.body("box").pose.position, up = run.body("box").pose.rotation.col(2);
                  return -at.dot(up) / up.z();
                }};
  BoxOnPad& box = hard.box;
  box.turn = {0.052, 0.035, 0.1};
  box.position.z() = 2e-3 + pitch * (box.turn.x() + box.turn.y());
  box.spin = {5.0, -3.0, 2.0};
  box.damping = 0.4 / modes_of(box).fastest;
  box.duration = 1.4;
  hard.scale = hard.expected = sag_of(box);  // depth of the face over the pad's middle
  hard.tolerance = 2e-3;
  hard.rests = true;
  hard.smooth = false;
  return hard;
}

// Every element slips, f_n = m g/9 each, and the torque mu f_n sum sqrt(r^2 - e^2), with e = mu
// f_n/k_t = 14 um hardly less than r, slows the box down by torque/I per second.
HardCase spinning() {
  HardCase hard{"spins at 100 rad/s", {}, {}};
  BoxOnPad& box = hard.box;
  box.position.z() = -sag_of(box);
  box.turn = {0.2 * sag_of(box) / pitch, 0.13 * sag_of(box) / pitch, 0.0};
  box.damping = 0.4 / modes_of(box).fastest;
  box.spin = {0.0, 0.0, 100.0};
  box.duration = 0.15;
  // Loss of spin, relative to the expected one.
  const double slower = box.mu * box.mass * g / 9.0 * pitch * (4.0 + 4.0 * std::sqrt(2.0)) / inertia_of(box.mass).z();
  const double end = box.duration - longest_sample;
  hard.answer = [=](CaseRun& run) { return (100.0 - run.body("box").angular_velocity.z()) / (slower * end); };
  hard.scale = hard.expected = 1.0;
  hard.tolerance = 2e-3;
  hard.rests = true;
  hard.fast = true;
  hard.articulated = 0.25;  // chattering tips take 20 % more
  return hard;
}

HardCase shaken(const std::string& name, double part) {
  HardCase hard{name, box_of(0.1, 1.0, 0.5), momentum_along};
  const double peak = part * hard.box.mu * hard.box.mass * g;
  hard.box.push = {{0.01, 0.0}};
  for (int k = 0; k < 20; ++k) hard.box.push.emplace_back(0.015 + 0.01 * k, k % 2 == 0 ? peak : -peak);
  hard.box.duration = 0.2;
  hard.scale = peak * 5e-3;
  hard.smooth = part < 1.0;
  hard.rests = true;
  return hard;
}

std::vector<HardCase> made_hard_cases() {
  std::vector<HardCase> all;
  all.push_back(pushed("5 g on stiffness x100, pushed", box_of(0.005, 100.0, 0.5), 0.25));
  all.push_back(pushed("5 g on stiffness x100, slides", box_of(0.005, 100.0, 0.5), 1.5));
  all.back().rattles = true;
  all.push_back(pushed("5 kg on stiffness x0.1, pushed", box_of(5.0, 0.1, 0.5), 0.1));
  all.push_back(pushed("mu 0.01, slides", box_of(0.1, 1.0, 0.01), 1.5));
  all.push_back(pushed("mu 2, slides", box_of(0.1, 10.0, 2.0), 1.5));
  all.back().rattles = true;
  all.push_back(blow("blow at 0.5 m/s", 0.1, 1.0, 0.0));
  all.push_back(blow("blow at 0.5 m/s, rough", 0.005, 100.0, 0.5));
  all.push_back(grazing());
  all.push_back(tumbling());
  all.push_back(spinning());
  all.push_back(shaken("shaken at 50 Hz", 0.5));
  all.push_back(shaken("shaken at 50 Hz, slips", 1.2));
  BoxOnPad many;
  many.pad = flat_square(32, 0.04 / 31.0, k_n * 9.0 / 1024.0, k_t * 9.0 / 1024.0);
  all.push_back(pushed("1,024 elements, pushed", put_down(many), 0.25));
  return all;
}

const std::vector<HardCase>& hard_cases() {
  static const std::vector<HardCase> all = made_hard_cases();
  return all;
}

// Text printed with a failure, also stored as a property of the test.
std::string runs_text(const std::vector<Outcome>& runs, double scale) {
  std::string text;
  for (const Outcome& run : runs) {
    text += "h omega " + std::to_string(run.phase) + ": answer/scale " + exact(run.answer / scale) + ", gain " +
            exact(run.energy_gain) + ", carried off by " + exact(run.carried_off) + ", held off by " + exact(run.held_off) + "; ";
  }
  return text;
}

using Pair = std::tuple<std::size_t, std::size_t>;  // method, case

// All except 1,024 articulated pillars: over 3,000 degrees of freedom, which noslip turns into a
// dense matrix, take seconds per step.
std::vector<Pair> pairs() {
  std::vector<Pair> all;
  for (std::size_t m = 0; m < methods().size(); ++m) {
    for (std::size_t c = 0; c < hard_cases().size(); ++c) {
      if (methods()[m].fidelity != "articulated" || hard_cases()[c].box.pad.elements.size() < 1000) all.emplace_back(m, c);
    }
  }
  return all;
}

// As gtest requires: letters, digits and underscores.
std::string name_of(const std::string& text) {
  std::string name;
  for (const char c : text) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

// h_0 with pads of this method: the longest allowed step; if nothing or only the recipe limits it,
// at most h omega = `phase`.
double longest_of(const Method& method, const std::function<double()>& automatic, double fastest, double phase) {
  const double longest = method.solver == "implicit" ? longest_sample : automatic();
  if (method.fidelity == "field" && method.solver == "explicit") return longest;
  return longest_sample / std::ceil(longest_sample / std::min(longest, phase / fastest));
}

// The answer at the finest step of explicit pads under implicitfast.
double reference(const HardCase& hard) {
  HardCase other = hard;
  other.box.fidelity = "field";
  other.box.solver = "explicit";
  other.box.integrator = "implicitfast";
  other.box.time_step = "auto";
  return run_of(other, exact(CaseRun(other.box)->time_step(0) / 8.0) + " s").answer;
}

class EveryMethod : public ::testing::TestWithParam<Pair> {};

TEST_P(EveryMethod, EndsRightAndConverges) {
  const Method& method = methods()[std::get<0>(GetParam())];
  HardCase hard = hard_cases()[std::get<1>(GetParam())];
  hard.box.fidelity = method.fidelity;
  hard.box.solver = method.solver;
  hard.box.integrator = method.integrator;
  const bool articulated = method.fidelity == "articulated";
  // Dashpots of articulated pads are joint dampers of at most 1 ms.
  if (articulated) hard.box.damping = std::min(hard.box.damping, 1e-3);
  const auto automatic = [&hard] {
    BoxOnPad probe = hard.box;
    probe.time_step = "auto";
    return CaseRun(probe)->time_step(0);
  };
  // Both lose energy in an impact, to first order in h omega, which must be small to show the
  // order.
  const double longest = longest_of(method, automatic, modes_of(hard.box).fastest, hard.smooth ? 3.0 : 0.4);
  std::vector<Outcome> runs;
  for (const double part : {1.0, 0.5, 0.25, 0.125}) runs.push_back(run_of(hard, exact(longest * part) + " s"));
  SCOPED_TRACE(hard.name + ", " + method.name + ": " + runs_text(runs, hard.scale));
  RecordProperty("runs", runs_text(runs, hard.scale) + " expected " + exact(hard.expected / hard.scale));
  const bool explicit_pads = !articulated && method.solver == "explicit";
  for (const Outcome& run : runs) {
    ASSERT_TRUE(std::isfinite(run.answer));
    // With v between two ticks a spring stepped velocity first has y^2 + v^2 within z^2/4 of its
    // invariant, y = omega x, and touch and lift-off within a step multiply the invariant by at
    // most 1/(1 - z^2/4) (impact_test.cc). Implicit and articulated pads lose energy.
    const double lost = 0.25 * run.phase * run.phase;
    EXPECT_LE(run.energy_gain, explicit_pads ? lost / (1.0 - lost) : 1e-6);
  }
  if (hard.rests) {
    EXPECT_LT(std::abs(runs.back().carried_off), articulated && hard.fast ? 1e-2 : 1e-3);
  }
  if (hard.held) {
    EXPECT_LT(std::abs(runs.back().held_off), 1e-4);
  }
  const auto change = [&](std::size_t k) { return std::abs(runs[k + 1].answer - runs[k].answer) / hard.scale; };
  // To first order the finest run's error equals its last change; three times that covers the
  // reference's own error and higher orders. If a touch or a change of state within a step decides,
  // its position in the step is worth z^2/4.
  const double finest = hard.smooth ? 0.0 : 0.25 * std::pow(runs.back().phase, 2);
  const double expected = std::isnan(hard.expected) ? reference(hard) : hard.expected;
  EXPECT_LE(std::abs(runs.back().answer - expected) / hard.scale,
            articulated ? hard.articulated : hard.tolerance + 3.0 * change(2) + finest)
      << "expected " << exact(expected / hard.scale);
  const double noise = hard.smooth ? 1e-4 : 0.5 * std::pow(runs[2].phase, 2);  // either sign
  if (!articulated || !hard.rattles) {
    EXPECT_LT(change(2), std::max(0.6 * change(0), articulated ? hard.articulated : noise));
  }
  if (hard.smooth && explicit_pads && change(0) > 1e-3) {
    EXPECT_GT(0.5 * std::log2(change(0) / change(2)), 0.9) << "order of convergence";
  }
}

INSTANTIATE_TEST_SUITE_P(Stability, EveryMethod, ::testing::ValuesIn(pairs()), [](const auto& info) {
  return methods()[std::get<0>(info.param)].name + "_" + name_of(hard_cases()[std::get<1>(info.param)].name);
});

// Steps of 0.1 to 2 ms given by a scene: explicit pads are refused exactly if h > 0.75/omega,
// articulated ones if MuJoCo's contact would yield too much, both before the first step and with
// the longest allowed step, which is then accepted. Accepted runs complete.
class GivenStep : public ::testing::TestWithParam<std::size_t> {};

TEST_P(GivenStep, IsTakenOrRefusedWithTheLongest) {
  const Method& method = methods()[GetParam()];
  int refused = 0, taken = 0;
  for (const auto& [mass, stiffer] : {std::pair{0.005, 100.0}, {0.005, 1.0}, {0.1, 1.0}, {5.0, 0.1}}) {
    for (const double step : {1e-4, 5e-4, 1e-3, 2e-3}) {
      BoxOnPad box = box_of(mass, stiffer, 0.5);
      box.fidelity = method.fidelity;
      box.solver = method.solver;
      box.integrator = method.integrator;
      if (method.fidelity == "articulated") box.damping = std::min(box.damping, 1e-3);
      box.time_step = exact(step) + " s";
      box.duration = 0.02;
      SCOPED_TRACE(method.name + ", " + exact(mass) + " kg, x" + exact(stiffer) + ", " + box.time_step);
      const std::string text = refusal(box);
      if (text == "accepted") {
        ++taken;
        CaseRun run(box);
        EXPECT_NO_THROW(run.to_end());
      } else {
        ++refused;
        ASSERT_THAT(text, HasSubstr(" is too long for "));
        const std::string limit = "allowed: up to ";
        ASSERT_THAT(text, HasSubstr(limit));
        const double allowed = parse_quantity(text.substr(text.find(limit) + limit.size()), Quantity::time);
        EXPECT_LT(allowed, step);
        box.time_step = exact(longest_sample / std::ceil(longest_sample / allowed)) + " s";
        EXPECT_EQ(refusal(box), "accepted");
      }
      if (method.fidelity == "field") {
        EXPECT_EQ(text == "accepted", method.solver == "implicit" || step <= 0.75 / modes_of(box).fastest);
      }
    }
  }
  EXPECT_GT(taken, 0);
  EXPECT_EQ(refused > 0, method.solver == "explicit");
}

INSTANTIATE_TEST_SUITE_P(Stability, GivenStep, ::testing::Range<std::size_t>(0, methods().size()),
                         [](const auto& info) { return methods()[info.param].name; });

// Cases other than a free box on a pad. Here the bench itself checks energy and, for free bodies,
// weight.
struct OtherCase {
  std::string name;
  std::string model;  // without its integrator, marked by '@'
  std::string scene;  // without time_step and pads
  std::vector<PadLayout> pads;
  double fastest;                          // rad/s, approximately
  double end;                              // s
  std::function<double(CaseRun&)> answer;  // relative to the expected value or to a relevant scale
  double expected, tolerance;              // NaN: that of the finest run of explicit pads under implicitfast
  bool fast = false;                       // 100 mm/s on the surface or more
};

double position_of(CaseRun& run, const char* joint) {
  return run->data()->qpos[run->model()->jnt_qposadr[mj_name2id(run->model(), mjOBJ_JOINT, joint)]];
}

// A pad under a finger of 1 kg on guides, over the edge or the corner of a fixed box, pushed with
// half of the friction limit: n elements carry everything, at the depth m g/(n k_n), and yield by
// 0.25 g/(n k_t).
OtherCase on_edge(int touching, double x, double y) {
  const std::string model =
      "<mujoco><compiler angle='radian'/><option integrator='@'/><worldbody><geom name='box' type='box' size='0.1 0.1 0.02' euler='0 0 0.004' pos='" +
      exact({x - 0.1 + 1e-4, (touching % 3 == 0 ? 0.0 : y - 0.1) + 1e-4, -0.02}) +
      "'/><body name='finger'><joint name='height' type='slide' axis='0 0 1'/><joint name='travel' type='slide' axis='0 -1 0'/><geom type='box' pos='0 0 0.03' size='0.01 0.01 0.01' mass='1'/><site name='pad'/></body></worldbody><actuator><motor name='push' joint='travel'/></actuator></mujoco>";
  const std::string scene = "duration: 0.9 s\nfriction: {static: 0.5, kinetic: 0.5}\ncontrols: {push: [[0.4 s, 0 N], [0.6 s, " +
                            exact(0.25 * g) +
                            " N]]}\nsensors: {pad: {type: papillarray, site: pad, touches: [box], damping: 1 ms}}\n";
  const double k = touching * 10.0;
  return {std::to_string(touching) + " of nine elements on an edge",
          model,
          scene,
          {flat_square(3, pitch, 10.0 * k_n, 10.0 * k_t)},
          std::sqrt(90.0 * k_n),
          0.898,
          [k](CaseRun& run) {
            return position_of(run, "travel") / (0.25 * g / (k * k_t)) - position_of(run, "height") / (g / (k * k_n));
          },
          2.0,
          1e-3};
}

// A pad driven over a free box on another pad, with reversal: it pulls with mu N on the box's face.
OtherCase driven(double speed) {
  BoxOnPad box;
  box.integrator = "@";
  box.position.z() = -sag_of(box);
  box.turn = {1e-4, 0.6e-4, 4e-3};
  const double there = std::max(0.1, 0.1e-3 / speed), end = 0.2 + there + std::max(0.1, 0.2e-3 / speed);
  const std::string scene =
      "duration: " + exact(longest_sample * std::ceil(end / longest_sample + 1.0)) +
      " s\nfriction: {static: 0.2, kinetic: 0.2}\nsensors:\n  top: {type: papillarray, touches: [box], damping: 0.4 ms}\n  bottom: {type: papillarray, site: pad, touches: [box], damping: 0.4 ms}\nmotion: {compression: 0.04 mm, gap: 0.05 mm, start: 0.2 s, acceleration: inf, speed: " +
      exact(speed) + " m/s, reverse: " + exact(there) + " s}\n";
  return {format_quantity(speed, Quantity::speed) + " and back",
          stacked_model(box),
          scene,
          {box.pad, box.pad},
          std::sqrt(18.0 * k_n / box.mass),
          end,
          [](CaseRun& run) {
            const Eigen::Vector3d on_face = run.body("box").pose.rotation.transpose() * run.force(0);
            return on_face.x() / (0.2 * on_face.z());
          },
          1.0,
          1e-3,
          speed >= 0.1};
}

// A finger presses a free box onto a pad; one of them is a thousand times as heavy as the other.
OtherCase mass_ratio(double finger, double mass) {
  BoxOnPad box{.mass = mass, .integrator = "@"};
  box.position.z() = -sag_of(box);
  box.turn = {1e-4, 0.6e-4, 4e-3};
  const double fastest = fastest_of_ratio(finger, mass);
  const std::string tau = exact(0.4 / fastest);
  const std::string scene =
      "duration: 0.2 s\nfriction: {static: 0.5, kinetic: 0.5}\ncontrols: {press: [[0.02 s, 0 N], [0.12 s, 5 N]]}\nsensors:\n"
      "  top: {type: papillarray, site: finger, touches: [box], damping: " +
      tau + " s}\n  bottom: {type: papillarray, site: pad, touches: [box], damping: " + tau + " s}\n";
  return {"finger and box " + exact(finger) + " to " + exact(mass) + " kg",
          fingered_model(box, finger),
          scene,
          {box.pad, box.pad},
          fastest,
          0.198,
          [](CaseRun& run) { return position_of(run, "down") / (5.0 / (9.0 * k_n)); },
          std::numeric_limits<double>::quiet_NaN(),
          0.0};
}

const std::vector<OtherCase>& other_cases() {
  static const std::vector<OtherCase> all{on_edge(6, 0.01, 0.0), on_edge(1, -0.01, -0.01), driven(1e-4),         driven(1e-2),
                                          driven(1e-1),          mass_ratio(1e-3, 1.0),    mass_ratio(1.0, 1e-3)};
  return all;
}

class EveryMethodToo : public ::testing::TestWithParam<Pair> {};

TEST_P(EveryMethodToo, EndsRightAndConverges) {
  const Method& method = methods()[std::get<0>(GetParam())];
  const OtherCase& other = other_cases()[std::get<1>(GetParam())];
  std::vector<const PadLayout*> pads;
  for (const PadLayout& pad : other.pads) pads.push_back(&pad);
  const auto run_at = [&](const Method& by, const std::string& step) {
    std::string model = other.model;
    model.replace(model.find('@'), 1, by.integrator);
    return CaseRun("slipbench: 1\nmodel: box.xml\ntime_step: " + step + "\n" + pads_of(by.fidelity, by.solver) + other.scene,
                   "box.xml", model, pads);
  };
  const auto answer_at = [&](const Method& by, double step) {
    CaseRun run = run_at(by, exact(step) + " s");
    run.to(other.end);
    return other.answer(run);
  };
  const double longest = longest_of(
      method, [&] { return run_at(method, "auto")->time_step(0); }, other.fastest, method.fidelity == "field" ? 1.0 : 0.6);
  std::vector<double> answers;
  for (const double part : {1.0, 0.5, 0.25}) answers.push_back(answer_at(method, longest * part));
  SCOPED_TRACE(other.name + ", " + method.name + ", h omega " + exact(longest * other.fastest) + ": " + exact(answers[0]) + " " +
               exact(answers[1]) + " " + exact(answers[2]));
  const bool articulated = method.fidelity == "articulated";
  const double first = std::abs(answers[1] - answers[0]), last = std::abs(answers[2] - answers[1]);
  double expected = other.expected, tolerance = other.tolerance;
  if (std::isnan(expected)) {
    const auto& implicitfast = *std::ranges::find(methods(), "implicitfast", &Method::name);
    expected = answer_at(implicitfast, run_at(implicitfast, "auto")->time_step(0) / 4.0);
    tolerance = 3.0 * last + 1e-3 * std::abs(expected);
  }
  RecordProperty("answers",
                 exact(answers[0]) + " " + exact(answers[1]) + " " + exact(answers[2]) + " expected " + exact(expected));
  EXPECT_NEAR(answers.back(), expected, articulated ? 0.05 * std::abs(expected) : tolerance);
  EXPECT_LT(last, std::max(0.6 * first, (articulated ? 0.02 : 1e-3) * std::abs(answers.back())));
}

// All except articulated pillars at 100 mm/s: their tips chatter, and their instantaneous press
// means nothing.
std::vector<Pair> other_pairs() {
  std::vector<Pair> all;
  for (std::size_t m = 0; m < methods().size(); ++m) {
    for (std::size_t c = 0; c < other_cases().size(); ++c) {
      if (methods()[m].fidelity != "articulated" || !other_cases()[c].fast) all.emplace_back(m, c);
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Stability, EveryMethodToo, ::testing::ValuesIn(other_pairs()), [](const auto& info) {
  return methods()[std::get<0>(info.param)].name + "_" + name_of(other_cases()[std::get<1>(info.param)].name);
});

}  // namespace
}  // namespace slipbench::hard
