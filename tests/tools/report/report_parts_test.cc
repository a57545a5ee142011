
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>

#include "sim/api/contact_frame.h"
#include "tests/expect.h"
#include "tests/tools/report/sample.h"
#include "tools/report/report_grasp.h"
#include "tools/report/report_summary.h"
#include "tools/report/report_trial.h"

namespace slipbench::report {
namespace {

constexpr std::size_t everything = 1'000'000;

std::vector<std::vector<double>> curve(const Json& payload, const std::string& key) {
  return unpack(payload.at("curves").at(key).at("data"));
}

// From row 3 on the arm rises by 2 mm per row, the box by 1 mm, and the box turns about the
// vertical by 0.01 rad per row (sample.h).
TEST(GraspPayload, SlipIsInTheArmsFrameFromTheLiftOn) {
  const Json payload = grasp_payload(sample_grasp(0), everything, "demo_0");
  EXPECT_DOUBLE_EQ(payload.at("lift_s").get<double>(), 3e-3);
  const auto height = curve(payload, "height"), slip = curve(payload, "slip"), rotation = curve(payload, "rotation");
  for (std::size_t row = 0; row < 8; ++row) {
    const double since = row < 3 ? 0.0 : static_cast<double>(row) - 3.0;
    // Half a step of 16 bits of each range, plus the float rounding of a pose of some 0.1 m.
    EXPECT_NEAR(height[0][row], 1e-3 * since, 0.5 * 10e-3 / 32767 + 1e-8) << row;
    EXPECT_NEAR(height[1][row], 2e-3 * since, 0.5 * 10e-3 / 32767 + 1e-8) << row;
    EXPECT_NEAR(slip[0][row], 1e-3 * since, 0.5 * 5e-3 / 32767 + 1e-8) << row;
    EXPECT_NEAR(rotation[0][row], 0.01 * since, 0.5 * 0.05 / 32767 + 1e-6) << row;
  }
}

// An arm turned by 90 degrees sees the box move as far, along another of its axes.
TEST(GraspPayload, SlipDoesNotDependOnHowTheArmStands) {
  TrialRecord record = sample_grasp(0);
  const auto half = static_cast<float>(std::numbers::sqrt2 / 2.0);
  for (std::size_t row = 0; row < 8; ++row) {
    float* const turn = &record.bodies[1].pose[7 * row + 3];
    turn[0] = half, turn[1] = 0.0F, turn[2] = half, turn[3] = 0.0F;
  }
  EXPECT_NEAR(curve(grasp_payload(record, everything, "demo_0"), "slip")[0][7], 4e-3, 0.5 * 4e-3 / 32767 + 1e-8);
}

TEST(GraspPayload, NoSlipOnceDropped) {
  TrialRecord record = sample_grasp(0);
  record.outcome.grasp->dropped = true;
  record.outcome.grasp->drop_time = 5.5e-3;
  const Json payload = grasp_payload(record, everything, "demo_0");
  for (const char* key : {"slip", "rotation"}) {
    const auto column = curve(payload, key)[0];
    EXPECT_FALSE(std::isnan(column[5])) << key;
    EXPECT_TRUE(std::isnan(column[6])) << key;
    EXPECT_TRUE(std::isnan(column[7])) << key;
  }
  EXPECT_FALSE(std::isnan(curve(payload, "height")[0][7]));
}

TEST(GraspPayload, HoldsForceAndRegisters) {
  const Json payload = grasp_payload(sample_grasp(0), everything, "demo_0");
  const auto force = curve(payload, "grip_force")[0];
  for (std::size_t row = 0; row < 8; ++row) EXPECT_NEAR(force[row], 0.5 * static_cast<double>(row), 0.5 * 3.5 / 32767 + 1e-12);
  const auto position = curve(payload, "position");
  // Counts of up to 78: to half of 78/32767.
  EXPECT_NEAR(position[0][7], 78.0, 0.5 * 78.0 / 32767);
  EXPECT_NEAR(position[1][7], 77.0, 0.5 * 78.0 / 32767);
  EXPECT_EQ(payload.at("controller"), "step_on_slip");
  EXPECT_EQ(payload.at("detector"), "truth");
}

// Without a detector and a controller nothing reads the gripper.
TEST(GraspPayload, OpenLoopHasPosesAlone) {
  TrialRecord record = sample_grasp(0);
  record.control.reset();
  const Json payload = grasp_payload(record, everything, "demo_0");
  EXPECT_FALSE(payload.at("curves").contains("grip_force"));
  EXPECT_FALSE(payload.at("curves").contains("position"));
  EXPECT_TRUE(payload.at("curves").contains("slip"));
  EXPECT_EQ(payload.at("controller"), "");
}

// 1 kHz: one pose in 17 is 58.8 per second. 8 rows then leave only row 0.
TEST(GraspPayload, PosesAreAtMostSixtyASecond) {
  const Json poses = grasp_payload(sample_grasp(0), everything, "demo_0").at("poses");
  EXPECT_EQ(poses.at("stride"), 17);
  ASSERT_EQ(poses.at("bodies").size(), 3U);
  const Json& box = poses.at("bodies").at(2);
  EXPECT_EQ(box.at("name"), "box");
  EXPECT_EQ(box.at("size"), Json::parse("[0.0625, 0.05, 0.1]"));
  EXPECT_TRUE(poses.at("bodies").at(1).at("size").is_null());
  EXPECT_EQ(box.at("position").at("rows"), 1);
  EXPECT_EQ(box.at("turn").at("columns"), 4);

  TrialRecord slow = sample_grasp(0);
  for (double& time : slow.body_time) time *= 20.0;  // 50 Hz
  const Json all = grasp_payload(slow, everything, "demo_0").at("poses");
  EXPECT_EQ(all.at("stride"), 1);
  const auto position = unpack(all.at("bodies").at(2).at("position"));
  EXPECT_NEAR(position[2][7], -0.02 + 4e-3, 0.5 * 0.02 / 32767 + 1e-8);
}

// 8 rows of box and arm height, slip, rotation, force, commanded and measured position are 56
// values.
TEST(GraspPayload, CurvesAreThinnedToTheirLimit) {
  EXPECT_EQ(grasp_payload(sample_grasp(0), 56, "demo_0").at("stride"), 1);
  const Json thin = grasp_payload(sample_grasp(0), 28, "demo_0");
  EXPECT_EQ(thin.at("stride"), 2);
  EXPECT_EQ(thin.at("curves").at("slip").at("data").at("rows"), 4);
  EXPECT_EQ(thin.at("time").at("rows"), 8);
}

TEST(GraspPayload, RefusesARecordWithoutItsBodies) {
  TrialRecord record = sample_grasp(0);
  record.bodies.pop_back();
  EXPECT_THAT(refusal_of([&] { static_cast<void>(grasp_payload(record, everything, "lift.h5: /data/demo_0")); }),
              refused_at("lift.h5", {"/data/demo_0", "truth/box"}));
}

TEST(GraspSummary, NullStandsForNever) {
  const Json summary =
      grasp_summary({.slip_translation = 1e-3, .max_grip_force = 6.0, .final_grip_force = 5.0, .ideal_grip_force = 4.0});
  EXPECT_FALSE(summary.at("dropped").get<bool>());
  EXPECT_TRUE(summary.at("drop_s").is_null());
  EXPECT_TRUE(summary.at("rotation_rad").is_null());
  EXPECT_TRUE(summary.at("reaction_s").is_null());
  EXPECT_EQ(summary.at("slip_m"), 1e-3);
  EXPECT_EQ(summary.at("max_force_N"), 6.0);
  EXPECT_EQ(summary.at("final_force_N"), 5.0);
  EXPECT_EQ(summary.at("ideal_force_N"), 4.0);
}

TEST(Summary, CountsSharesOfTime) {
  const Json summary = summarise(sample_trial(0, "{}").sensors[0]);
  // Eight samples, by the table in sample.h.
  EXPECT_EQ(summary.at("shares").at("strict"), Json::parse("[0.125, 0.375, 0.25, 0.25]"));
  EXPECT_EQ(summary.at("shares").at("micro"), Json::parse("[0.125, 0.25, 0.25, 0.375]"));
  EXPECT_EQ(summary.at("shares").at("paper"), Json::parse("[0.125, 0.5, 0.125, 0.25]"));
}

TEST(Summary, TakesOnsetsFromInsideTheStep) {
  const Json summary = summarise(sample_trial(0, "{}").sensors[0]);
  EXPECT_EQ(summary.at("first_touch_s"), 0.5e-3);
  EXPECT_EQ(summary.at("first_micro_s"), 2.25e-3);
  EXPECT_EQ(summary.at("first_full_s"), 3.5e-3);
  EXPECT_EQ(summary.at("gross_s"), 5.75e-3);  // not 6 ms, the sample's time
  EXPECT_NEAR(summary.at("incipient_s").get<double>(), 3.5e-3, 1e-15);
}

// Both units slip at one instant, with one time lower by a unit in the last place.
TEST(Summary, APhaseOfRoundingIsZero) {
  SensorRecord sensor = sample_trial(0, "{}").sensors[0];
  sensor.labels.micro_onset_time.assign(2, std::nextafter(5.75e-3, 0.0));
  EXPECT_EQ(summarise(sensor).at("incipient_s"), 0.0);
}

TEST(Summary, GrossWithoutAnEventBeginsAtItsSample) {
  SensorRecord sensor = sample_trial(0, "{}").sensors[0];
  sensor.labels.event_kind.back() = 3;  // the other unit's slip ends by detachment
  EXPECT_EQ(summarise(sensor).at("gross_s"), 6e-3);
}

TEST(Summary, ComparesRulesWhereEitherSeesContact) {
  const Json summary = summarise(sample_trial(0, "{}").sensors[0]);
  // Seven samples in contact; paper differs in sample 4, micro in samples 3 and 5.
  EXPECT_NEAR(summary.at("disagreement").at("paper").get<double>(), 1.0 / 7.0, 1e-15);
  EXPECT_NEAR(summary.at("disagreement").at("micro").get<double>(), 2.0 / 7.0, 1e-15);
}

TEST(Summary, SaysNeverForWhatDoesNotHappen) {
  SensorRecord sensor = sample_trial(0, "{}").sensors[0];
  sensor.labels.state.assign(8, 0);
  sensor.labels.state_paper.assign(8, 0);
  sensor.labels.micro_onset_time.assign(2, std::nan(""));
  const Json summary = summarise(sensor);
  EXPECT_TRUE(summary.at("gross_s").is_null());
  EXPECT_TRUE(summary.at("first_micro_s").is_null());
  EXPECT_TRUE(summary.at("incipient_s").is_null());
  EXPECT_TRUE(summary.at("disagreement").at("paper").is_null());
}

TEST(MotionStart, IgnoresThePressAndWhatCameBefore) {
  const TrialRecord trial = sample_trial(0, "{}");
  EXPECT_DOUBLE_EQ(motion_start(trial, 0.0), 2e-3);  // samples 0 and 1 only press
  EXPECT_DOUBLE_EQ(motion_start(trial, 4.5e-3), 5e-3);
  EXPECT_TRUE(std::isnan(motion_start(trial, 1.0)));
}

TEST(CheckLabels, RefusesWhatDoesNotExist) {
  const std::vector<std::pair<std::function<void(SensorRecord&)>, std::vector<std::string>>> cases = {
      {[](SensorRecord& s) { s.labels.unit_state[3] = 4; }, {"x.h5", "labels/pad", "state 4", "3"}},
      {[](SensorRecord& s) { s.labels.state_paper[3] = 9; }, {"state 9"}},
      {[](SensorRecord& s) { s.labels.event_unit[0] = 2; }, {"event", "unit 2"}},
      {[](SensorRecord& s) { s.labels.event_kind[0] = 6; }, {"event", "kind 6", "5"}},
      {[](SensorRecord& s) { s.time.clear(); }, {"no sample"}},
      {[](SensorRecord& s) { s.channel_names.pop_back(); }, {"sensors/pad", "11 channels", "12"}},
  };
  SensorRecord sound = sample_trial(0, "{}").sensors[0];
  sound.labels.event_kind.back() = static_cast<std::uint8_t>(EventKind::part_sticks);
  EXPECT_NO_THROW(check_labels(sound, "x.h5"));
  for (const auto& [damage, words] : cases) {
    SensorRecord sensor = sample_trial(0, "{}").sensors[0];
    damage(sensor);
    EXPECT_THAT(refusal_of([&] { check_labels(sensor, "x.h5"); }), mentions(words));
  }
}

TEST(PlainValue, TurnsTextWithAUnitIntoSi) {
  EXPECT_EQ(plain_value("motion.speed", "4 mm/s"), Json::parse(R"({"value": 0.004, "unit": "m/s"})"));
  EXPECT_EQ(plain_value("any.path", "2 s").at("unit"), "s");
}

TEST(PlainValue, TakesTheUnitOfABareNumberFromItsKey) {
  EXPECT_EQ(plain_value("motion.speed", 0.004), Json::parse(R"({"value": 0.004, "unit": "m/s"})"));
  EXPECT_EQ(plain_value("motion.compression", "0.001"), Json::parse(R"({"value": 0.001, "unit": "m"})"));
  EXPECT_EQ(plain_value("motion.tilt.0", 0.02).at("unit"), "rad");  // an index is not a key
  EXPECT_EQ(plain_value("friction.static", 0.5).at("unit"), "");
  // As the entries declare, at any place.
  EXPECT_EQ(plain_value("motion.travel", 0.02).at("unit"), "m");
  EXPECT_EQ(plain_value("motion.clearance", 0.0).at("unit"), "m");
  EXPECT_EQ(plain_value("sensors.pad.tip_radius", 0.1).at("unit"), "m");
  EXPECT_EQ(plain_value("sensors.pad.k_tangential", 9000.0).at("unit"), "N/m");
  EXPECT_EQ(plain_value("box.mass", 0.1).at("unit"), "kg");
  EXPECT_EQ(plain_value("motion.vibration", 2.0).at("unit"), "") << "a level";
  EXPECT_EQ(plain_value("duration", 2.0).at("unit"), "s");
  EXPECT_EQ(plain_value("detector.window", 0.1).at("unit"), "s");
  EXPECT_EQ(plain_value("detector.parameters.window", 0.1).at("unit"), "") << "a library's own, which only the library knows";
}

TEST(PlainValue, HasNoNumberForInfinity) {
  EXPECT_EQ(plain_value("motion.stop", "inf"), Json::parse(R"({"value": null, "unit": "s"})"));
}

TEST(PlainValue, KeepsNamesAndListsAsText) {
  EXPECT_EQ(plain_value("surface.material", "acrylic"), Json::parse(R"({"text": "acrylic"})"));
  EXPECT_EQ(plain_value("motion.pivot", Json::parse("[0.004, \"1 mm\"]")), Json::parse(R"j({"text": "(4 mm, 1 mm)"})j"));
  EXPECT_EQ(plain_value("effects", Json::parse("{\"noise\": true}")), Json::parse(R"({"text": "{\"noise\":true}"})"));
}

TEST(Axes, SaysWhatVaries) {
  std::vector<Json> trials(2, Json::object());
  trials[0]["motion.speed"] = plain_value("motion.speed", "4 mm/s");
  trials[1]["motion.speed"] = plain_value("motion.speed", "8 mm/s");
  for (Json& trial : trials) trial["surface.material"] = plain_value("surface.material", "acrylic");
  trials[1]["friction.static"] = plain_value("friction.static", 0.5);
  const Json expected = Json::parse(R"([
    {"path": "motion.speed", "unit": "m/s", "numeric": true, "varied": true},
    {"path": "surface.material", "unit": "", "numeric": false, "varied": false},
    {"path": "friction.static", "unit": "", "numeric": true, "varied": true}])");
  EXPECT_EQ(axes(trials), expected);
}

// A nib pad's FL clusters: their difference is a sine of `frequency` [Hz] and amplitude 10 counts.
SensorRecord nib_record(double frequency, std::size_t samples) {
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "nib_pad";
  sensor.rate = 300.0;
  SensorColumn fl{"fl", "counts", {2}, {}, std::vector<double>{}};
  for (std::size_t row = 0; row < samples; ++row) {
    const double t = static_cast<double>(row) / sensor.rate;
    sensor.time.push_back(t);
    fl.time->push_back(t - 1e-3);
    const auto half = static_cast<float>(5.0 * std::sin(2.0 * std::numbers::pi * frequency * t));
    fl.values.insert(fl.values.end(), {half, -half});
  }
  sensor.channels.push_back(std::move(fl));
  return sensor;
}

TEST(Spectra, ASpectrogramHasARowAWindowAndItsBinsUpToTheHighest) {
  const Json spectra = spectra_of(nib_record(8.0, 300), 100000);
  ASSERT_EQ(spectra.size(), 1U);  // there is no FR
  const Json& fl = spectra[0];
  EXPECT_DOUBLE_EQ(fl["bin_hz"], 2.0);   // 1/0.5 s
  EXPECT_EQ(fl["data"]["columns"], 11);  // 0, 2, ... 20 Hz
  EXPECT_EQ(fl["data"]["rows"], 6);      // windows of 150 samples that end with sample 150, 180, ... 300
  EXPECT_EQ(fl["time"]["rows"], 6);
  // The largest magnitude is at 8 Hz: half the sine's amplitude times the sum of Hamming's window,
  // 0.54 * 150, minus what the line removes (a few percent). `step` is 1/32767 of it.
  EXPECT_NEAR(fl["data"]["step"].get<double>() * 32767.0, 0.5 * 10.0 * 0.54 * 150.0, 0.05 * 405.0);
}

TEST(Spectra, FewerWindowsWhereThereIsNoRoom) {
  const Json spectra = spectra_of(nib_record(8.0, 300), 33);  // three windows of 11 bins
  ASSERT_EQ(spectra.size(), 1U);
  EXPECT_LE(spectra[0]["data"]["rows"].get<int>(), 3);
  EXPECT_GE(spectra[0]["data"]["rows"].get<int>(), 2);
}

TEST(Spectra, NoneOfWhatIsShorterThanAWindowOrOfAnotherSensor) {
  EXPECT_TRUE(spectra_of(nib_record(8.0, 149), 100000).empty());
  SensorRecord other = nib_record(8.0, 300);
  other.type = "papillarray";
  EXPECT_TRUE(spectra_of(other, 100000).empty());
}

const std::string lift_text =
    "slipbench: 1\nsurface: {material: felt}\nbox: {mass: 0.5 kg, size: [50 mm, 60 mm, 90 mm]}\ngrip: {protocol: as_printed}\n"
    "motion: {kind: lift, distance: 80 mm}\n";

Json rows(const std::string& text = lift_text, const Json& overrides = Json::object(), const Json& swept = Json::object()) {
  return grasp_parameters(text, overrides, swept, "lift.h5: attribute scene");
}

Json row(const Json& rows, const std::string& path) {
  for (const Json& candidate : rows) {
    if (candidate.at("path") == path) return candidate;
  }
  return nullptr;
}

void expect_row(const Json& found, const std::string& value, const std::string& by, bool assumed) {
  ASSERT_FALSE(found.is_null());
  EXPECT_EQ(found.at("value"), value) << found;
  EXPECT_EQ(found.at("by"), by) << found;
  EXPECT_EQ(found.at("assumed").get<bool>(), assumed) << found;
}

TEST(GraspParameters, SayWhoSetThemAndWhetherTheyAreAssumed) {
  const Json all = rows();
  expect_row(row(all, "box.mass"), "0.5 kg", "scene", true);
  expect_row(row(all, "box.size"), "[50 mm, 60 mm, 90 mm]", "scene", true);
  expect_row(row(all, "grip.stiffness"), "[8 N/mm, 15 N/mm, 15 N/mm]", "default", true);
  expect_row(row(all, "grip.count"), "0.374 mm", "default", false);
  expect_row(row(all, "grip.preset"), "1 N", "protocol", false);      // as the paper prints it
  expect_row(row(all, "motion.speed"), "5 mm/s", "protocol", false);  // likewise
  expect_row(row(all, "motion.distance"), "80 mm", "scene", false);   // recorded
  expect_row(row(all, "surface.material"), "felt", "scene", true);
}

TEST(GraspParameters, ProtocolIsAsRecordedUnlessSaid) {
  expect_row(row(rows("slipbench: 1\nbox: {mass: 0.2 kg}\nmotion: {kind: lift}\n"), "motion.speed"), "43 mm/s", "protocol",
             false);
}

TEST(GraspParameters, CommandLineCountsAsTheScene) {
  expect_row(row(rows(lift_text, {{"grip.latency", "40 ms"}}), "grip.latency"), "40 ms", "scene", true);
}

// Neither the scene's value nor the protocol's holds for every trial.
TEST(GraspParameters, SweptValuesAreNotShown) {
  const Json all = rows(lift_text, Json::object(), {{"box.size.0", 1}, {"grip.protocol", 1}});
  expect_row(row(all, "box.size"), "", "sweep", true);
  expect_row(row(all, "motion.speed"), "43 mm/s", "default", false);
}

TEST(GraspParameters, ScatterIsThereWhenTheSceneHasIt) {
  EXPECT_TRUE(row(rows(), "scatter.yaw").is_null());
  expect_row(row(rows(lift_text + "scatter: {}\n"), "scatter.yaw"), "1 deg", "default", true);
}

TEST(GraspParameters, AreThoseOfEverythingThatTheSceneNames) {
  const Json all = rows(lift_text +
                        "friction: {static: 0.3}\neffects: [{anisotropic_friction: {ratio: 0.7}}, patchy_friction]\n"
                        "sensors: {left: {type: papillarray}}\ndetector: {type: force_ratio, ratio: 0.2}\n"
                        "controller: {type: step_on_slip}\n");
  expect_row(row(all, "friction.static"), "0.3", "scene", true);
  expect_row(row(all, "effects.0.anisotropic_friction.ratio"), "0.7", "scene", true);
  EXPECT_FALSE(row(all, "effects.1.patchy_friction.sd").is_null());
  expect_row(row(all, "sensors.left.damping"), "1 ms", "default", true);
  EXPECT_FALSE(row(all, "sensors.left.bristles").is_null());
  expect_row(row(all, "detector.ratio"), "0.2", "scene", true);
  expect_row(row(all, "controller.force_per_count"), "1.6 N", "default", true);
}

TEST(GraspParameters, ContactIsThereWithItsFidelity) {
  EXPECT_TRUE(row(rows(), "contact.noslip").is_null());
  const std::string own = lift_text + "fidelity: mujoco_contact\n";
  const Json all = rows(own + "contact: {noslip: 10, solref: [0.001, 1]}\n");
  expect_row(row(all, "contact.noslip"), "10", "scene", false);
  expect_row(row(all, "contact.solref"), "[0.001, 1]", "scene", false);
  expect_row(row(all, "contact.cone"), "pyramidal", "default", false);
  expect_row(row(all, "contact.tip_mass"), "0.1 g", "default", true);
  expect_row(row(rows(own), "contact.noslip"), "0", "default", false);
  expect_row(row(rows(own, {{"contact", "{noslip: 3}"}}), "contact.noslip"), "3", "scene", false);
  expect_row(row(rows(own, Json::object(), {{"contact.noslip", 1}}), "contact.noslip"), "", "sweep", false);
  EXPECT_TRUE(row(rows(own, Json::object(), {{"fidelity", 1}}), "contact.noslip").is_null());
  EXPECT_FALSE(row(rows(lift_text, {{"fidelity", "mujoco_contact"}}), "contact.noslip").is_null());
}

TEST(GraspParameters, RefusesOverridesThatDoNotFit) {
  EXPECT_THROW(rows(lift_text, {{"slipbench.a", "1"}}), InputError);
  EXPECT_THROW(rows(lift_text, {{"box.mass", 1}}), InputError);
}

}  // namespace
}  // namespace slipbench::report
