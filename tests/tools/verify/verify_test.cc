#include "tools/verify/verify.h"

#include <functional>
#include <limits>

#include "tests/expect.h"
#include "tests/scenes.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/batches.h"
#include "tools/dataset/writer.h"
#include "tools/trial/run_trial.h"
#include "tools/verify/cone.h"
#include "tools/verify/contact.h"
#include "tools/verify/verification.h"

namespace slipbench::testing::verify_test {
namespace {

// Pressed until 0.46 s, then moved sideways at 4 mm/s: all pillars slip from some 0.6 s on, see
// `sliding`.
const std::string scene_text = R"(slipbench: 1
duration: 0.9 s
time_step: 1 ms
surface: {material: acrylic}
friction: {static: 0.5, kinetic: 0.4}
motion: {kind: stage, compression: 1 mm, start: 0.5 s, speed: 8 mm/s}
sensors:
  pad: {type: papillarray, rate: 100 Hz}
)";
constexpr std::size_t pressed = 48, sliding = 88;  // samples, 10 ms each

struct VerifyTest : FolderTest {
  static const TrialRecord& sound() {
    static const TrialRecord record = run_trial(parsed(scene_text), 0, Recording::full).record;
    return record;
  }
  // Writes a dataset of trials 0 to 2, with trial 1 changed.
  std::string write(const std::function<void(TrialRecord&)>& change, bool complete = true,
                    std::uint64_t limit = DatasetWriter::default_shard_limit) {
    SweepWriter writer(path("a.h5"), {"1.2.3", scene_text, "{}", sound().seed, "slipbench run a.yaml"}, limit);
    for (std::size_t k = 0; k < 3; ++k) {
      TrialRecord record = sound();
      record.trial = k;
      if (k == 1) change(record);
      writer.append(TrialEncoder().encode(record));
    }
    return complete ? (writer.commit(), path("a.h5")) : writer.keep().front();
  }
  // Returns the failed checks: "cone: trial 1, labels/pad/force, sample 3: ...".
  std::vector<std::string> failures(const std::function<void(TrialRecord&)>& change) {
    const Verified verified = verify_datasets({write(change)});
    std::vector<std::string> list;
    EXPECT_TRUE(verified.readable);
    for (const auto& failure : verified.datasets.at(0).at("failures")) {
      EXPECT_EQ(failure.at("trial"), 1U);
      list.push_back(failure.at("check").get<std::string>() + ": " + failure.at("array").get<std::string>() +
                     (failure.at("sample").is_null() ? "" : " " + std::to_string(failure.at("sample").get<std::size_t>())) +
                     ": " + failure.at("what").get<std::string>());
    }
    EXPECT_EQ(verified.holds, list.empty());
    return list;
  }
  // Trials 0 and 2.
  template <class Writer>
  static void append_two(Writer& writer) {
    for (const std::size_t k : {0U, 2U}) {
      TrialRecord record = sound();
      record.trial = k;
      writer.append(TrialEncoder().encode(record));
    }
  }
};

LabelRecord& labels_of(TrialRecord& record) { return record.sensors[0].labels; }

TEST_F(VerifyTest, SoundDatasetHolds) {
  EXPECT_THAT(failures([](TrialRecord&) {}), IsEmpty());
  const LabelRecord& labels = sound().sensors[0].labels;
  ASSERT_EQ(labels.state.at(pressed), 1U);  // the samples changed by the tests below are in the expected states
  ASSERT_EQ(labels.state.at(sliding), 3U);
}

// Two level plates that overlap by half, under a pad 0.3 mm deep: the middle pillar presses with
// k_n d = 7100 N/m x 0.3 mm.
const std::string plates_text = R"(slipbench: 1
duration: 0.7 s
time_step: 1 ms
friction: {static: 0.5, kinetic: 0.5}
motion: {kind: stage, compression: 0.3 mm, start: 0.5 s, speed: 2 mm/s}
bodies:
  a: {shape: box, size: [40 mm, 40 mm, 20 mm], position: [0 mm, 0 mm, -10 mm], free: false}
  b: {shape: box, size: [40 mm, 40 mm, 20 mm], position: [20 mm, 0 mm, -10 mm], free: false}
sensors:
  pad: {type: papillarray, rate: 1 kHz, touches: [a, b]}
)";

std::vector<std::string> contact_failures(const std::function<void(LabelRecord&)>& change) {
  TrialRecord record = run_trial(parsed(plates_text), 0, Recording::full).record;
  change(record.sensors[0].labels);
  verify::Verification verification;
  verify::check_contact(parsed(plates_text), 0, record, record.sensors[0], verification);
  const Json json = verification.json();
  std::vector<std::string> failures;
  for (const Json& failure : json.at("failures")) failures.push_back(failure.at("what"));
  EXPECT_EQ(json.at("checks").back().at("checked"), 9U * record.body_time.size());
  return failures;
}

TEST(VerifyContact, AnElementPressesOnOneSurface) {
  constexpr std::size_t row = 600, middle = 9 * row + 4;
  EXPECT_THAT(contact_failures([](LabelRecord& labels) { EXPECT_NEAR(labels.force[3 * middle + 2], 7100.0 * 0.3e-3, 1e-6); }),
              IsEmpty());
  EXPECT_THAT(contact_failures([](LabelRecord& labels) { labels.force[3 * middle + 2] *= 2.0F; }),
              ElementsAre(AllOf(HasSubstr("unit 4: presses with 4.26 N at a depth of 0.3 mm"), HasSubstr("at most 2.201 N"))));
  EXPECT_THAT(contact_failures([](LabelRecord& labels) {
                labels.force[3 * middle + 2] = 0.0F;
                labels.unit_state[middle] = 0;
              }),
              ElementsAre(HasSubstr("unit 4: is detached, but element 4 is still 0.3 mm deep in the touched body")));
}

// Verifies a dataset of one trial of the scene.
Verified verified_run(const std::string& path, const std::string& text) {
  const Scene scene = parsed(text);
  DatasetWriter writer(path, {"1.2.3", text, "{}", scene.seed, "slipbench run a.yaml"});
  writer.append(TrialEncoder().encode(run_trial(scene, 0, Recording::full).record));
  writer.commit();
  return verify_datasets({path});
}

// With a rate law slipping bristles carry up to mu g(w) f_n, more than mu_static f_n, while others
// of their pillar stick: a partly slipping pillar has a margin below 0
// (ViscousFriction.PartOfAUnitThatSlipsBearsMoreThanStaticFriction).
TEST_F(VerifyTest, PillarsThatSlipInPartUnderARateLawHold) {
  const Verified verified = verified_run(
      path("a.h5"),
      "slipbench: 1\nduration: 0.9 s\ntime_step: 1 ms\nfriction: {static: 0.5, kinetic: 0.5}\n"
      "motion: {kind: stage, compression: 1 mm, start: 0.5 s, speed: 16 mm/s, acceleration: 1 m/s2}\n"
      "effects: [{viscous_friction: {gain: 0.4}}]\nsensors: {pad: {type: papillarray, bristles: 12, bristle_spread: 0.8}}\n");
  EXPECT_TRUE(verified.holds) << verified.datasets.dump(1);
}

// Slip to all sides alike has no direction: a dome pressed straight spreads at its rim.
TEST_F(VerifyTest, SlipWithoutTranslationHasNoDirection) {
  const Verified dome = verified_run(
      path("a.h5"),
      "slipbench: 1\nduration: 0.4 s\nfriction: {static: 0.5, kinetic: 0.5}\neffects: [{elastic_skin: {shear_modulus: 0.15 MPa}}]\n"
      "motion: {kind: stage, compression: 0.3 mm, gap: 0.1 mm, speed: 0 mm/s}\n"
      "sensors: {gel: {type: gel_markers, rate: 60 Hz, dome: 100 mm, field: 19 mm, distance: 22 mm, marker_rows: 8, marker_pitch: 1.8 mm}}\n");
  EXPECT_TRUE(dome.holds) << dome.datasets.dump(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with_direction = [&](std::size_t sample, double direction) {
    return failures([=](TrialRecord& record) { labels_of(record).slip_direction[sample] = static_cast<float>(direction); });
  };
  EXPECT_THAT(with_direction(sliding, nan).at(0),
              HasSubstr("values: labels/pad/slip_direction 88: is nan, but the slipping units have a mean velocity of 0.008"));
  EXPECT_THAT(
      with_direction(pressed, 0.5).at(0),
      HasSubstr("values: labels/pad/slip_direction 48: is 0.5 rad, but the slipping units have a mean velocity of 0 m/s"));
}

// A unit's points touch a sphere in several directions, and their margins do not combine to a
// margin of the unit's force.
TEST_F(VerifyTest, UnitsOfSeveralPointsOnASphereHold) {
  const std::string text =
      "slipbench: 1\nduration: 1 s\nsurface: {shape: sphere, radius: 20 mm}\nmotion: {compression: 0.6 mm, start: 0.5 s}\n"
      "sensors: {pad: {type: taxels, points: 3}}\n";
  const Verified verified = verified_run(path("a.h5"), text);
  EXPECT_TRUE(verified.holds) << verified.datasets.dump(1);
}

TEST_F(VerifyTest, ConeIsHeldForEveryUnit) {
  const auto with_pull = [&](std::size_t sample, double share) {
    return failures([=](TrialRecord& record) {
      float* force = labels_of(record).force.data() + 3 * (9 * sample + 4);
      force[0] = static_cast<float>(share * static_cast<double>(force[2]));
      force[1] = 0.0F;
    });
  };
  EXPECT_THAT(with_pull(pressed, 0.51).at(0), HasSubstr("cone: labels/pad/force 48: unit 4: sticks at f_t = "));
  EXPECT_THAT(with_pull(pressed, 0.49).at(0), HasSubstr("cone: labels/pad/margin 48: unit 4: is "));
  EXPECT_THAT(with_pull(sliding, 0.41).at(0), HasSubstr("cone: labels/pad/force 88: unit 4: slips at f_t = "));
  EXPECT_THAT(with_pull(sliding, 0.39).at(0), HasSubstr("less than mu_kinetic f_n"));
}

// Labels are float32, so f_t and mu f_n are known to 2^-24 = 6e-8 each, for any mu: a sliding pad holds
// where mu f_n is 30 times f_n and where it is no float32 at all, and a force of mu f_n (1 + 1e-6)
// does not hold.
TEST_F(VerifyTest, FrictionOfAnySizeIsHeldToTheRoundingOfItsForce) {
  for (const char* mu : {"30", "1e-60", "0"}) {
    const std::string text =
        std::string("slipbench: 1\nduration: 0.9 s\ntime_step: 1 ms\nfriction: {static: ") + mu + ", kinetic: " + mu +
        "}\nmotion: {compression: 1 mm, start: 0.5 s, speed: 1 m/s, acceleration: 10 m/s2}\nsensors: {pad: {type: papillarray}}\n";
    const Verified verified = verified_run(path(std::string(mu) + ".h5"), text);
    EXPECT_TRUE(verified.holds) << mu << verified.datasets.dump(1);
  }
  const auto with_friction = [&](double factor) {
    return failures([=](TrialRecord& record) {
      float* force = labels_of(record).force.data() + 3 * (9 * sliding + 4);
      force[0] = static_cast<float>(0.4 * factor * static_cast<double>(force[2]));
      force[1] = 0.0F;
    });
  };
  EXPECT_THAT(with_friction(1.0), IsEmpty());
  EXPECT_THAT(with_friction(1.0 + 1e-6).at(0), HasSubstr("cone: labels/pad/force 88: unit 4: slips at f_t = "));
}

// A tip with mass rings on after its contact ends: k u + c u' stays in the record, without f_n.
TEST_F(VerifyTest, FreeTipsWithMassRing) {
  const Scene scene = parsed(
      "slipbench: 1\nduration: 0.5 s\ntime_step: 1 ms\nfriction: {static: 0.5, kinetic: 0.5}\neffects: [inertia]\n"
      "motion: {compression: 1 mm, gap: 0 mm, approach_speed: 100 mm/s, acceleration: 10 m/s2, start: 0.2 s, speed: 20 mm/s, retract: 0.4 s}\n"
      "sensors: {pad: {type: papillarray}}\n");
  TrialRecord record = run_trial(scene, 0, Recording::full).record;
  LabelRecord& labels = record.sensors[0].labels;
  const auto cone_failures = [&] {
    verify::Verification verification;
    verify::check_cone(verify::cone_law(scene, 0), record.sensors[0], 0, verification);
    const Json json = verification.json();
    std::vector<std::string> found;
    for (const Json& failure : json.at("failures")) found.push_back(failure.at("what"));
    return found;
  };
  EXPECT_THAT(cone_failures(), IsEmpty());
  const std::size_t last = labels.unit_state.size() - 5;  // the centre pillar at the end, 1 mm above the surface
  ASSERT_EQ(labels.unit_state[last], 0);
  EXPECT_NE(labels.force[3 * last], 0.0F);
  labels.force[3 * last + 2] = 0.5F;
  EXPECT_THAT(cone_failures(), ElementsAre(HasSubstr("unit 4: is detached, but f_n is 0.5 N")));
}

TEST_F(VerifyTest, SlipIsHeldAgainstStates) {
  const auto with = [&](const auto& change) { return failures([&](TrialRecord& record) { change(labels_of(record)); }); };
  constexpr std::size_t stuck = 9 * pressed + 3, slips = 9 * sliding + 3;
  EXPECT_THAT(with([](LabelRecord& labels) { labels.slip_velocity[2 * stuck + 1] = 1e-9F; }),
              ElementsAre(HasSubstr("slip: labels/pad/slip_velocity 48: unit 3: is (0, 1e-09) m/s, but the unit sticks")));
  EXPECT_THAT(with([](LabelRecord& labels) { labels.slip_distance[slips] = 0.0F; }).at(0),
              HasSubstr("slip: labels/pad/slip_distance 88: unit 3: falls from "));
  EXPECT_THAT(with([](LabelRecord& labels) { labels.slip_distance[stuck] = 1e-9F; }).at(0),
              HasSubstr("slip: labels/pad/slip_distance 48: unit 3: grows from 0 m to 1e-09 m while no part slips"));
  EXPECT_THAT(with([](LabelRecord& labels) { labels.slip_angle[pressed] = 1e-3F; }).at(0),
              HasSubstr("slip: labels/pad/slip_angle 48: changes from 0 rad to 0.001 rad while no unit slips"));
  EXPECT_THAT(with([](LabelRecord& labels) { labels.slip_centre[2 * pressed] = 0.0F; }),
              ElementsAre(HasSubstr("slip: labels/pad/slip_centre 48: is not NaN")));
  EXPECT_THAT(with([](LabelRecord& labels) { labels.stuck_fraction[pressed] = 0.5F; }),
              ElementsAre(HasSubstr("slip: labels/pad/stuck_fraction 48: is 0.5; expected 1")));
  EXPECT_THAT(with([](LabelRecord& labels) { labels.stuck_fraction[sliding] = 0.5F; }),
              ElementsAre(HasSubstr("slip: labels/pad/stuck_fraction 88: is 0.5; expected 0")));
}

TEST_F(VerifyTest, EventsAreHeldAgainstOnsetsAndStates) {
  EXPECT_THAT(failures([](TrialRecord& record) { labels_of(record).event_kind[0] = 3; }).at(0),
              HasSubstr("3 is not possible in the state 0"));
  EXPECT_THAT(failures([](TrialRecord& record) { labels_of(record).onset_time.assign(9, 1.2345); }).at(0),
              HasSubstr("events: labels/pad/events/t: unit 0: onset_time_s is 1.2345 s, but its first such event is at "));
  EXPECT_THAT(failures([](TrialRecord& record) { labels_of(record).unit_state[9 * sliding + 3] = 3; }),
              Contains(HasSubstr("events: labels/pad/unit_state 88: unit 3: is 3 at 0.88 s")));
  EXPECT_THAT(failures([](TrialRecord& record) { labels_of(record).state[sliding] = 2; }).at(0),
              HasSubstr("events: labels/pad/state 88: is 2, but 3 by unit_state"));
  EXPECT_THAT(failures([](TrialRecord& record) {
                std::swap(labels_of(record).event_time.front(), labels_of(record).event_time.back());
              }).at(0),
              HasSubstr("events: labels/pad/events/t "));
  EXPECT_THAT(failures([](TrialRecord& record) { labels_of(record).event_unit[2] = 9; }).at(0),
              HasSubstr("events: labels/pad/events/unit 2: 9 is not a unit"));
}

TEST_F(VerifyTest, OutcomeIsThatOfTheLabels) {
  EXPECT_THAT(failures([](TrialRecord& record) { record.outcome.touch_time += 1e-3; }),
              ElementsAre(HasSubstr("events: outcome/touch_time_s: is ")));
  EXPECT_THAT(failures([](TrialRecord& record) { record.outcome.first_micro_slip_time = 0.1; }),
              ElementsAre(HasSubstr("events: outcome/first_micro_slip_time_s: is 0.1, but ")));
  EXPECT_THAT(failures([](TrialRecord& record) { record.outcome.max_slip_distance *= 0.5; }),
              ElementsAre(HasSubstr("events: outcome/max_slip_distance_m: is ")));
}

TEST_F(VerifyTest, ValuesAreFinite) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(failures([](TrialRecord& record) { record.sensors[0].channels[0].values[27 * 5 + 2] = nan; }).at(0),
              HasSubstr("values: sensors/pad/force 5: value 2 of the row is nan"));
  EXPECT_THAT(failures([](TrialRecord& record) { record.bodies[0].pose[7 * 4] = std::numeric_limits<float>::infinity(); }).at(0),
              HasSubstr("values: truth/" + sound().bodies[0].name + "/pose 4: value 0 of the row is inf"));
  EXPECT_THAT(
      failures([](TrialRecord& record) { record.bodies[0].pose[7 * 4 + 3] += 0.1F; }).at(0),
      AllOf(HasSubstr("values: truth/" + sound().bodies[0].name + "/pose 4: "), HasSubstr("the quaternion has the length")));
  EXPECT_THAT(failures([](TrialRecord& record) { labels_of(record).state_paper[4] = 4; }),
              ElementsAre(HasSubstr("values: labels/pad/state_paper 4: 4 is not a state of a pad")));
  EXPECT_THAT(failures([](TrialRecord& record) { labels_of(record).mu_kinetic[4] = 0.6; }).at(0),
              HasSubstr("values: labels/pad/mu_static: unit 4: is 0.5"));
  EXPECT_THAT(failures([](TrialRecord& record) { labels_of(record).margin[9 * sliding] = nan; }).at(0),
              HasSubstr("values: labels/pad/margin 88: value 0 of the row is nan"));
}

TEST_F(VerifyTest, TimesRiseAtTheRate) {
  EXPECT_THAT(failures([](TrialRecord& record) { record.sensors[0].time[7] += 1e-4; }),
              Contains(HasSubstr("times: sensors/pad/t 7: ")));
  EXPECT_THAT(failures([](TrialRecord& record) { record.sensors[0].rate = std::numeric_limits<double>::quiet_NaN(); }).at(0),
              HasSubstr("times: sensors/pad: rate_hz is nan"));
  EXPECT_THAT(failures([](TrialRecord& record) { record.body_time[7] = record.body_time[6]; }).at(0), HasSubstr("times: truth/"));
}

TEST_F(VerifyTest, GapIsNamed) {
  DatasetWriter writer(path("gap.h5"), {"1.2.3", scene_text, "{}", sound().seed, "slipbench run a.yaml"});
  append_two(writer);
  writer.commit();
  const Verified verified = verify_datasets({path("gap.h5")});
  EXPECT_FALSE(verified.holds);
  EXPECT_THAT(verified.datasets.at(0).at("failures").at(0).at("what"), mentions({"trial 0", "missing"}));
}

TEST_F(VerifyTest, PartialRunAndSeveralFilesAreVerified) {
  const Verified partial = verify_datasets({write([](TrialRecord&) {}, false)});
  EXPECT_TRUE(partial.holds);
  EXPECT_FALSE(partial.datasets.at(0).at("complete"));
  std::filesystem::remove_all(path("a.h5.partial"));
  const std::string first = write([](TrialRecord&) {}, true, 100'000);  // a trial takes more, so each gets a file
  const Verified verified = verify_datasets({path("a-0002.h5"), first, path("none.h5")});
  EXPECT_TRUE(verified.holds);
  EXPECT_FALSE(verified.readable);
  EXPECT_EQ(verified.datasets.at(0).at("files").size(), 3U);
  EXPECT_THAT(verified.datasets.at(1).at("error").get<std::string>(), mentions({"none.h5", "no such file"}));
  EXPECT_EQ(verified.datasets.at(2).at("file"), path("a-0002.h5"));
  EXPECT_TRUE(verified.datasets.at(2).contains("part_of"));
  EXPECT_FALSE(verify_datasets({path("a-0001.h5")}).readable);
}

// A killed run has no content_sha256; its trials have digests of their own.
TEST_F(VerifyTest, KilledRunHasItsTrialsVerified) {
  SweepWriter writer(path("a.h5"), {"1.2.3", scene_text, "{}", sound().seed, "slipbench run a.yaml"});
  append_two(writer);  // trial 1 failed, which is written at the run's end
  writer.finish_batch();
  const Verified verified = verify_datasets({path("a.h5.partial/batch.h5")});
  EXPECT_TRUE(verified.holds);
  const auto checks = verified.datasets.at(0).at("checks");
  EXPECT_EQ(checks.at(0).at("checked"), 2U);
  EXPECT_THAT(checks.dump(), HasSubstr("missing trials: the run was killed before it listed the failed trials"));
}

}  // namespace
}  // namespace slipbench::testing::verify_test
