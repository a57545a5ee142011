// Units and pads: states, margin, motion of the slip, and the order of events.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "sim/contact/contact_labels.h"
#include "tests/oracle/pads.h"
#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_field::contact_labels_test {
namespace {

constexpr double k_n = 7100.0, k_t = 3900.0, compression = 1e-3, pi = std::numbers::pi;

// Units in a row 10 mm apart; `weights[u]` lists the load of each bristle of unit u relative to the
// mean, with k_n and k_t per unit.
PadLayout row(const std::vector<std::vector<double>>& weights) {
  PadLayout pad;
  for (const auto& unit : weights) {
    const double n = static_cast<double>(unit.size());
    const double x = 10e-3 * static_cast<double>(pad.units.size());
    pad.units.push_back({pad.elements.size(), unit.size()});
    for (const double weight : unit) {
      Element element;
      element.tip.x() = x;
      element.k_normal = k_n * weight / n;
      element.k_tangential = k_t / n;
      pad.elements.push_back(element);
    }
  }
  return pad;
}

const std::vector<double> six_weights{1.6, 1.36, 1.12, 0.88, 0.64, 0.4};

struct Rig {
  Rig(const PadLayout& pad, Friction friction, double step) : field(pad, Plane{}, friction), labels(field.layout()), dt(step) {}

  const ContactFrame& to(const Pose& pose) {
    field.step(pose, dt);
    const ContactFrame& frame = labels.update({&field, 1}, tick++ * dt, dt);
    events.insert(events.end(), frame.events.begin(), frame.events.end());
    return frame;
  }

  // The kinds of unit u's events.
  [[nodiscard]] std::vector<EventKind> kinds(std::uint32_t u) const {
    std::vector<EventKind> result;
    for (const ContactEvent& event : events) {
      if (event.unit == u) result.push_back(event.kind);
    }
    return result;
  }

  Field field;
  ContactLabels labels;
  double dt;
  int tick = 0;
  std::vector<ContactEvent> events;
};

TEST(ContactLabels, BeforeTheTouchEverythingIsNothing) {
  Rig rig(oracle::nine_pillars(), {0.5, 0.5}, 1e-3);
  const ContactFrame& frame = rig.to(at(0.0, 0.0, 1e-3));
  EXPECT_EQ(frame.state, PadState::no_contact);
  EXPECT_EQ(frame.state_micro, PadState::no_contact);
  EXPECT_TRUE(std::isnan(frame.stuck_fraction));
  EXPECT_TRUE(std::isnan(frame.slip_direction));
  EXPECT_TRUE(frame.slip_centre.isNaN().all());
  EXPECT_EQ(frame.slip_angle, 0.0);
  for (Eigen::Index u = 0; u < 9; ++u) {
    EXPECT_TRUE(std::isnan(frame.margin[u]));
    EXPECT_TRUE((frame.force.col(u) == 0.0).all());
    EXPECT_TRUE((frame.displacement.col(u) == 0.0).all());
    EXPECT_EQ(frame.unit_state[static_cast<std::size_t>(u)], UnitState::detached);
  }
  EXPECT_TRUE(frame.events.empty());
}

TEST(ContactLabels, BothRulesAndTheStuckFractionAsBristlesLetGo) {
  // Unit 0 has six bristles, unit 1 one bristle with the load 2. A bristle of weight w slips after
  // w mu k_n d/k_t = w x 0.91 mm of travel.
  const double mu = 0.5, reach = mu * k_n * compression / k_t;
  Rig rig(row({six_weights, {2.0}}), {mu, mu}, 1e-3);
  struct Stage {
    double way;  // over `reach`
    UnitState unit;
    PadState strict, micro;
    double stuck;
  };
  using enum UnitState;
  const std::vector<Stage> stages{{0.0, stick, PadState::non_slip, PadState::non_slip, 1.0},
                                  {0.39, stick, PadState::non_slip, PadState::non_slip, 1.0},
                                  {0.41, partial, PadState::non_slip, PadState::incipient, 6.0 / 7.0},
                                  {0.9, partial, PadState::non_slip, PadState::incipient, 4.0 / 7.0},
                                  {1.59, partial, PadState::non_slip, PadState::incipient, 2.0 / 7.0},
                                  {1.61, slip, PadState::incipient, PadState::incipient, 1.0 / 7.0},
                                  {1.99, slip, PadState::incipient, PadState::incipient, 1.0 / 7.0},
                                  {2.01, slip, PadState::gross, PadState::gross, 0.0}};
  for (const Stage& stage : stages) {
    const ContactFrame& frame = rig.to(at(0.0, stage.way * reach, -compression));
    EXPECT_EQ(frame.unit_state[0], stage.unit) << stage.way;
    EXPECT_EQ(frame.state, stage.strict) << stage.way;
    EXPECT_EQ(frame.state_micro, stage.micro) << stage.way;
    EXPECT_EQ(frame.stuck_fraction, stage.stuck) << stage.way;
    EXPECT_EQ(std::isnan(frame.slip_direction), stage.micro == PadState::non_slip) << stage.way;
  }
}

TEST(ContactLabels, ForceDisplacementAndMarginOfAUnitAreThoseOfItsBristles) {
  // Sticking unit after s: f = (-k_t s, 0, k_n d), tip displaced by (-s, 0, d), margin 1 - k_t
  // s/(mu_s k_n d). Slipping: 1 - mu_k/mu_s.
  const double mu_s = 0.6, mu_k = 0.45;
  for (const std::vector<double>& weights : {std::vector<double>{1.0}, std::vector<double>(6, 1.0)}) {
    Rig rig(row({weights}), {mu_s, mu_k}, 1e-3);
    rig.to(at(0.0, 0.0, -compression));
    for (const double s : {0.1e-3, 0.5e-3, 1.0e-3}) {  // slip would begin at 1.09 mm
      const ContactFrame& frame = rig.to(at(s, 0.0, -compression));
      EXPECT_NEAR(frame.force(0, 0), -k_t * s, 1e-11);
      EXPECT_NEAR(frame.force(1, 0), 0.0, 1e-11);
      EXPECT_NEAR(frame.force(2, 0), k_n * compression, 1e-11);
      EXPECT_NEAR(frame.displacement(0, 0), -s, 1e-15);
      EXPECT_NEAR(frame.displacement(2, 0), compression, 1e-15);
      EXPECT_NEAR(frame.margin[0], 1.0 - k_t * s / (mu_s * k_n * compression), 1e-12);
    }
    const ContactFrame& frame = rig.to(at(2e-3, 0.0, -compression));
    EXPECT_NEAR(frame.margin[0], 1.0 - mu_k / mu_s, 1e-12);
    EXPECT_EQ(frame.unit_state[0], UnitState::slip);
  }
}

TEST(ContactLabels, MarginIsANumberWhileAUnitTouchesAFrictionlessSurface) {
  Rig rig(row({{1.0}}), {0.0, 0.0}, 1e-3);
  EXPECT_FALSE(std::isnan(rig.to(at(0.0, 0.0, -compression)).margin[0])) << "NaN means detached";
  EXPECT_FALSE(std::isnan(rig.to(at(1e-3, 0.0, -compression)).margin[0]));
}

TEST(ContactLabels, SlipOfAPureTranslationHasADirectionAndNoCentre) {
  const double v = 4e-3, dt = 1e-3;
  for (const double direction : {0.0, 0.5, 2.0, -3.0}) {
    for (const double turned : {0.0, 0.7}) {  // of the pad against the surface, before it slides
      Rig rig(oracle::nine_pillars(), {0.5, 0.5}, dt);
      for (int tick = 0; tick < 500; ++tick) {
        rig.to(oracle::turned(turned, {v * tick * dt * std::cos(direction), v * tick * dt * std::sin(direction), -compression}));
      }
      const ContactFrame& frame = rig.labels.frame();
      EXPECT_EQ(frame.state, PadState::gross);
      EXPECT_NEAR(std::remainder(frame.slip_direction - (direction - turned), 2.0 * pi), 0.0, 1e-9) << "in the pad's own frame";
      EXPECT_TRUE(frame.slip_centre.isNaN().all());
      for (Eigen::Index u = 0; u < 9; ++u) EXPECT_NEAR(frame.slip_velocity.col(u).matrix().norm(), v, 1e-12);
    }
  }
}

TEST(ContactLabels, SlipOfASteadyTurnIsThatTurnAboutItsPivot) {
  // In a steady turn every anchor runs on a circle about the pivot at the pad's rate, trailing its
  // root by mu f_n/k_t (oracle 3): the slip is a rigid turn about the pivot. The path of a step is
  // a chord; seen from the step's end it is turned back by rate dt/2 = 2.5e-5 and short by (rate
  // dt)^2/24: some 1e-4 of the pad's size in the centre, 1e-9 in the rate.
  const double rate = 0.5, dt = 1e-4, mu = 0.3;
  for (const Eigen::Vector2d& pivot : {Eigen::Vector2d(1e-3, 2e-3), Eigen::Vector2d(-20e-3, 5e-3)}) {
    const PadLayout pad = oracle::nine_pillars();
    Rig rig(pad, {mu, mu}, dt);
    const Eigen::Vector3d p(pivot.x(), pivot.y(), 0.0);
    double before = 0.0;
    for (int tick = 0; tick < 40000; ++tick) {  // 2 rad
      Pose pose = oracle::turned(rate * tick * dt, {0.0, 0.0, -compression});
      pose.position += p - pose.rotation * p;
      before = rig.labels.frame().slip_angle;
      rig.to(pose);
    }
    const ContactFrame& frame = rig.labels.frame();
    EXPECT_EQ(frame.state, PadState::gross);
    EXPECT_NEAR((frame.slip_angle - before) / dt, rate, 1e-6 * rate);
    EXPECT_NEAR((frame.slip_centre.matrix() - pivot).norm(), 0.0, 1e-4 * 20e-3);
  }
}

TEST(ContactLabels, SlipOfACombinedMotionTurnsAboutItsInstantaneousCentre) {
  // Pad velocity (v, 0) and rate w: the centre is at (0, v/w) from the pad's origin in the
  // surface's axes. Springs 1,000 times as stiff trail by e = mu f_n/k_t < 1 um, so tips move like
  // their roots except for w e; the chord turns by w dt/2 = 2.5e-5. Both are under 1e-3 of the slip
  // speeds, which are w x some mm.
  const double v = 4e-3, w = 0.5, dt = 1e-4;
  Rig rig(oracle::nine_pillars(1, k_n, 1e3 * k_t), {0.5, 0.5}, dt);
  double t = 0.0, before = 0.0;
  for (int tick = 0; tick < 3000; ++tick) {
    t = tick * dt;
    before = rig.labels.frame().slip_angle;
    rig.to(oracle::turned(w * t, {v * t, 0.0, -compression}));
  }
  const ContactFrame& frame = rig.labels.frame();
  EXPECT_EQ(frame.state, PadState::gross);
  const Eigen::Vector2d centre(v / w * std::sin(w * t), v / w * std::cos(w * t));  // (0, v/w) turned by -w t into the pad's axes
  EXPECT_NEAR((frame.slip_centre.matrix() - centre).norm(), 0.0, 1e-3 * v / w);
  EXPECT_NEAR((frame.slip_angle - before) / dt, w, 1e-3 * w);
  // The mean of the nine tips is the pad's origin: it moves along the surface's +X.
  EXPECT_NEAR(frame.slip_direction, -w * t, 1e-3);
}

TEST(ContactLabels, OneBristleTouchesSlipsSticksAndDetachesInOrder) {
  // Down at 4 mm/s to 1 mm, 2 mm sideways (slip at 0.91 mm), rest, up again. At rest the shear
  // force stays on the cone; as the load falls while the pad lifts, the unit slips again until it
  // detaches.
  Rig rig(row({{1.0}}), {0.5, 0.5}, 1e-3);
  for (int k = 0; k <= 300; ++k) rig.to(at(0.0, 0.0, 0.2e-3 - 4e-6 * k));
  for (int k = 1; k <= 500; ++k) rig.to(at(4e-6 * k, 0.0, -1e-3));
  for (int k = 0; k < 10; ++k) rig.to(at(2e-3, 0.0, -1e-3));
  for (int k = 1; k <= 300; ++k) rig.to(at(2e-3, 0.0, -1e-3 + 4e-6 * k));
  using enum EventKind;
  EXPECT_EQ(rig.kinds(0),
            (std::vector<EventKind>{touch, micro, EventKind::slip, EventKind::stick, micro, EventKind::slip, detach}));
  EXPECT_NEAR(rig.events[0].time, 0.2e-3 / 4e-3, 1e-12);
  EXPECT_EQ(rig.events[1].time, rig.events[2].time) << "of one bristle the first slip is the whole slip";
  EXPECT_NEAR(rig.events[1].time, 0.3 + 0.5 * k_n * 1e-3 / (k_t * 4e-3), 1e-9);
  EXPECT_NEAR(rig.events[3].time, 0.8, 1e-9);
  EXPECT_NEAR(rig.events[6].time, 0.81 + 1e-3 / 4e-3, 1e-9);
}

TEST(ContactLabels, SixBristlesSlipInPartsAndDetachTogether) {
  const double reach = 0.5 * k_n * compression / k_t, v = 4e-3;
  Rig rig(row({six_weights}), {0.5, 0.5}, 1e-3);
  rig.to(at(0.0, 0.0, 0.1e-3));
  for (int k = 0; k <= 500; ++k) rig.to(at(4e-6 * k, 0.0, -compression));
  rig.to(at(2e-3, 0.0, -compression));
  rig.to(at(2e-3, 0.0, 0.5e-3));
  using enum EventKind;
  EXPECT_EQ(rig.kinds(0), (std::vector<EventKind>{touch, micro, EventKind::slip, EventKind::stick, detach}));
  EXPECT_NEAR(rig.events[0].time, 0.1e-3 / 1.1e-3 * 1e-3, 1e-12);
  EXPECT_NEAR(rig.events[1].time, 1e-3 + 0.4 * reach / v, 1e-9);
  EXPECT_NEAR(rig.events[2].time, 1e-3 + 1.6 * reach / v, 1e-9);
  EXPECT_NEAR(rig.events[4].time, 0.502 + 1e-3 * compression / (compression + 0.5e-3), 1e-9);
}

TEST(ContactLabels, EventsTellEveryChangeOfAUnitsState) {
  // To and fro in several directions, with separations: after each step the last event of a unit
  // gives its state.
  Rig rig(row({six_weights, {1.0}, six_weights}), {0.6, 0.4}, 1e-3);
  std::vector<UnitState> from_events(3, UnitState::detached);
  std::size_t read = 0, changes = 0, again = 0;
  for (int k = 0; k < 12000; ++k) {
    const double t = 1e-3 * k;
    const ContactFrame& frame = rig.to(at(4e-3 * std::sin(23.0 * t), 3e-3 * std::sin(14.3 * t), -0.8e-3 * std::sin(1.1 * t)));
    for (; read < rig.events.size(); ++read) {
      const ContactEvent& event = rig.events[read];
      // Micro-slip begins only in a unit without any slip; a part sticks again only after full
      // slip.
      if (event.kind == EventKind::micro) {
        EXPECT_EQ(from_events[event.unit], UnitState::stick) << "t " << t;
      }
      if (event.kind == EventKind::part_sticks) {
        EXPECT_EQ(from_events[event.unit], UnitState::slip) << "t " << t;
      }
      again += event.kind == EventKind::part_sticks ? 1 : 0;
      from_events[event.unit] = event.kind == EventKind::detach        ? UnitState::detached
                                : event.kind == EventKind::slip        ? UnitState::slip
                                : event.kind == EventKind::micro       ? UnitState::partial
                                : event.kind == EventKind::part_sticks ? UnitState::partial
                                                                       : UnitState::stick;
      ++changes;
    }
    ASSERT_EQ(from_events, frame.unit_state) << "t " << t;
  }
  EXPECT_GT(changes, 100U);
  EXPECT_GT(again, 0U);
}

TEST(ContactLabels, BristlesThatLetGoTogetherReportNoSlip) {
  // Half of the bristles slip when the pad is pulled off within one step; the rest must not look
  // like the beginning of slip.
  Rig rig(row({six_weights, six_weights}), {0.5, 0.5}, 1e-3);
  const double reach = 0.5 * k_n * compression / k_t;
  rig.to(at(0.0, 0.0, -compression));
  EXPECT_EQ(rig.to(at(reach, 0.0, -compression)).unit_state[0], UnitState::partial);
  rig.to(at(reach, 0.0, 0.3e-3));
  using enum EventKind;
  for (const std::uint32_t unit : {0U, 1U}) EXPECT_EQ(rig.kinds(unit), (std::vector<EventKind>{touch, micro, detach}));
}

TEST(ContactLabels, EventsOfAllUnitsAreInOrderOfTimeAndInsideTheirStep) {
  RandomStream draw(11, 0, "event order");
  const PadLayout pad = random_pad(draw, 200, false);
  const RandomMotion motion(draw, Pose{});
  Rig rig(pad, {0.5, 0.4}, 10e-3);
  std::size_t seen = 0;
  std::vector<bool> touching(pad.units.size(), false);
  for (int tick = 0; tick < 200; ++tick) {
    const ContactFrame& frame = rig.to(motion.at(tick * rig.dt));
    seen += frame.events.size();
    EXPECT_TRUE(std::is_sorted(frame.events.begin(), frame.events.end(),
                               [](const ContactEvent& a, const ContactEvent& b) { return a.time < b.time; }));
    for (const ContactEvent& event : frame.events) {
      EXPECT_LE(event.time, frame.time);
      EXPECT_GE(event.time, frame.time - rig.dt);
      if (event.kind == EventKind::touch) touching[event.unit] = true;
      if (event.kind == EventKind::detach) touching[event.unit] = false;
    }
    // Events and states agree.
    for (std::size_t u = 0; u < touching.size(); ++u) EXPECT_EQ(touching[u], frame.unit_state[u] != UnitState::detached);
  }
  EXPECT_GT(seen, 100U);
}

// A slip that ends at the start of a step ends when the last step ended, at the same bits: times of
// steps are quotients k/1000, and (k + 1)/1000 - 1/1000 is often one rounding less than k/1000.
TEST(ContactLabels, NoEventIsBeforeTheStepThatItBelongsTo) {
  int earlier = 0;
  for (int k = 1; k < 10000; ++k) {
    const double begun = k / 1000.0, time = (k + 1) / 1000.0, dt = 1.0 / 1000.0;
    earlier += time - dt < begun ? 1 : 0;
    std::vector<unit_rules::UnitEvent> changes{{{0.0, 0, ElementState::slip, ElementState::stick}, 0}};
    std::vector<ContactEvent> events;
    const auto slips = [](std::uint32_t) { return unit_rules::Count{1, 1}; };
    unit_rules::report_unit_events(changes, slips, begun, time, dt, events);
    ASSERT_EQ(events.size(), 1U);
    EXPECT_GE(events.front().time, begun);
    EXPECT_NEAR(events.front().time, begun, 1e-12);
    // After a gap, as when a pad's time has been set back, the step alone counts.
    events.clear();
    changes = {{{0.0, 0, ElementState::slip, ElementState::stick}, 0}};
    unit_rules::report_unit_events(changes, slips, time + 1.0, time, dt, events);
    EXPECT_EQ(events.front().time, time - dt);
  }
  EXPECT_GT(earlier, 100) << "the case occurs";
}

TEST(ContactLabels, TiltedPadObeysTheConeInTheContactPlane) {
  // Tilted about X by 20 degrees, the plane's normal in P is (0, sin, cos). The sensor's force is
  // the vector in P; in the contact plane its z is f_n = k_n delta and its x, y are f_t = mu f_n,
  // and the slip is as long as the path.
  const double tilt = 20.0 * pi / 180.0, mu = 0.5, step = 1e-4;
  Rig rig(row({{1.0}}), {mu, mu}, 1e-3);
  ContactFrame frame;
  for (int i = 0; i <= 100; ++i) {
    Pose pose;
    pose.rotation = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
    pose.position = {0.3 * step * i, 0.4 * step * i, -compression};
    frame = rig.to(pose);
  }
  const double f_n = k_n * compression;
  EXPECT_EQ(frame.unit_state[0], UnitState::slip);
  EXPECT_NEAR(frame.contact_force(2, 0), f_n, 1e-12);
  EXPECT_NEAR(std::hypot(frame.contact_force(0, 0), frame.contact_force(1, 0)), mu * f_n, 1e-12);
  EXPECT_NEAR(frame.slip_velocity.col(0).matrix().norm(), 0.5 * step / 1e-3, 1e-12);
  // World force (-0.6 mu f_n, -0.8 mu f_n, f_n) seen in P = R_x(tilt)^T: y and z mix.
  const double y = -0.8 * mu * f_n, s = std::sin(tilt), c = std::cos(tilt);
  EXPECT_NEAR(frame.force(0, 0), -0.6 * mu * f_n, 1e-12);
  EXPECT_NEAR(frame.force(1, 0), c * y + s * f_n, 1e-12);
  EXPECT_NEAR(frame.force(2, 0), -s * y + c * f_n, 1e-12);
  // The shortest turn onto the normal is about X, so the contact plane's axes are the world's.
  EXPECT_NEAR(frame.contact_force(0, 0), -0.6 * mu * f_n, 1e-12);
  EXPECT_NEAR(frame.contact_force(1, 0), y, 1e-12);
}

TEST(ContactLabels, SlipOfATiltedPadIsTheTurnThatTheBenchMakes) {
  // The plane's normal is the world's Z, about which the bench turns a pad at 25 degrees to it,
  // through the plane point c = (5, 2) mm. In P the turn's axis is R' z: its rate in the contact
  // plane is the bench's, and the centre is the point of the axis at the height of the slipping
  // tips, seen in P: R' (c + h z - p), with p the pad's origin and h = 0, where the tips touch the
  // plane.
  const double tilt = 25.0 * pi / 180.0, rate = 0.35, step = 1e-3;
  const Eigen::Vector3d centre(5e-3, 2e-3, 0.0);
  const Eigen::Matrix3d tilted = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
  PadLayout pad;
  for (const double x : {-4e-3, 0.0, 4e-3}) {
    for (const double y : {-1e-3, 0.0, 1e-3}) {
      Element element;
      // Tips at equal depth under the tilted pad: they lie in a level plane of the world.
      element.tip = tilted.transpose() * Eigen::Vector3d(x, y, 0.0);
      element.k_normal = k_n;
      element.k_tangential = k_t;
      pad.units.push_back({pad.elements.size(), 1});
      pad.elements.push_back(element);
    }
  }
  Rig rig(pad, {0.05, 0.05}, step);
  double before = 0.0;
  for (int k = 0; k <= 4000; ++k) {
    Pose pose;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(rate * step * k, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    pose.rotation = turn * tilted;
    pose.position = centre - turn * centre - Eigen::Vector3d(0.0, 0.0, 0.1e-3);
    before = rig.labels.frame().slip_angle;
    rig.to(pose);
    if (k < 4000) continue;
    const ContactFrame& frame = rig.labels.frame();
    ASSERT_EQ(frame.state, PadState::gross);
    // Chords of a step are shorter than arcs by (rate step)^2/24 = 5e-9.
    EXPECT_NEAR((frame.slip_angle - before) / step, rate, 1e-7 * rate);
    const Eigen::Vector3d expected = pose.rotation.transpose() * (centre - pose.position);
    EXPECT_NEAR(frame.slip_centre.x(), expected.x(), 1e-6);
    EXPECT_NEAR(frame.slip_centre.y(), expected.y(), 1e-6);
  }
}

TEST(ContactLabels, UnitsThatLookAwayFromTheSurfaceHaveNoForce) {
  // Beyond the middle of a plate the nearest face is the far one, whose normal is -Z: nothing
  // touches, nothing is NaN.
  Field field(row({{1.0}}), Box{{20e-3, 20e-3, 0.5e-3}}, {0.5, 0.5});
  ContactLabels labels(field.layout());
  for (int k = 0; k < 3; ++k) {
    field.step(at(0.0, 0.0, -0.2e-3), 1e-3);
    const ContactFrame& frame = labels.update({&field, 1}, 1e-3 * k, 1e-3);
    EXPECT_EQ(frame.unit_state[0], UnitState::detached);
    EXPECT_TRUE((frame.contact_force == 0.0).all());
    EXPECT_TRUE((frame.slip_velocity == 0.0).all());
  }
}

TEST(ContactLabels, SlippedDistanceIsTheMeanOfAUnitsElements) {
  // Bristle of weight w has slipped s - w reach.
  const double reach = 0.5 * k_n * compression / k_t, way = 3e-3;
  Rig rig(row({six_weights}), {0.5, 0.5}, 1e-3);
  for (int k = 0; k <= 300; ++k) rig.to(at(way * k / 300.0, 0.0, -compression));
  EXPECT_NEAR(rig.labels.frame().slip_distance[0], way - reach, 1e-15);  // the mean weight is 1
}

TEST(ContactLabels, UnitsOfALevelPadAreToTheBitWhatTheirElementsAre) {
  const auto expect_same = [](const auto& found, const auto& expected, const char* what, int k) {
    ASSERT_EQ(std::memcmp(found.data(), expected.data(), sizeof(double) * static_cast<std::size_t>(expected.size())), 0)
        << what << k;
  };
  constexpr double dt = 1e-3;
  for (const Eigen::Index units : {4, 5, 9}) {  // whole groups of lanes, and partial ones
    PadLayout pad = row(std::vector(static_cast<std::size_t>(units), std::vector{1.0}));
    for (std::size_t u = 0; u < pad.elements.size(); ++u) pad.elements[u].tip.z() = 0.2e-3 * static_cast<double>(u);
    Rig rig(pad, {0.5, 0.4}, dt);
    Eigen::Array3Xd force(3, units), displacement(3, units);
    Eigen::Array2Xd velocity(2, units);
    Eigen::ArrayXd distance(units), margin(units);
    for (int k = 0; k <= 200; ++k) {  // down and up while sliding and turning: all states and all their changes
      Pose pose = at(10e-6 * k, -5e-6 * k, 0.2e-3 - 2.0 * compression * std::sin(pi * k / 200.0));
      pose.rotation.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(1e-3 * k).toRotationMatrix();
      const ContactFrame& frame = rig.to(pose);
      ASSERT_TRUE(rig.field.level());
      rig.field.view_from_pad();
      for (Eigen::Index u = 0; u < units; ++u) {
        const auto i = static_cast<std::size_t>(u);
        force.col(u) = rig.field.force_on_pad(i);
        displacement.col(u) = rig.field.deflection(i);
        velocity.col(u) = (1.0 / dt) * rig.field.slip_in_pad(i).head<2>();
        distance[u] = rig.field.slip_path(i);
        const bool touches = rig.field.state(i) != ElementState::detached;
        margin[u] = touches ? 1.0 - rig.field.tangential_force(i).norm() / rig.field.stick_limit(i) : std::nan("");
        ASSERT_EQ(static_cast<int>(frame.unit_state[i]), static_cast<int>(rig.field.state(i)));
      }
      expect_same(frame.force, force, "force at step ", k);
      expect_same(frame.contact_force, force, "force in the contact plane at step ", k);
      expect_same(frame.displacement, displacement, "displacement at step ", k);
      expect_same(frame.slip_velocity, velocity, "slip velocity at step ", k);
      expect_same(frame.slip_distance, distance, "slip distance at step ", k);
      expect_same(frame.margin, margin, "margin at step ", k);
    }
  }
}

}  // namespace
}  // namespace slipbench::testing_field::contact_labels_test
