// Scenes with bodies that move by forces, run by the commands: shipped ones, and their output.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "sim/core/process/interrupted.h"
#include "tests/expect.h"
#include "tests/scenes.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/encoder.h"
#include "tools/formats/export/export.h"
#include "tools/registry/program_catalogues.h"
#include "tools/report/report.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {
namespace {

const std::string scenes = SLIPBENCH_SOURCE_DIR "/scenes/bodies/";

struct BodiesRun : testing::FolderTest {
  // Returns the summary of a run whose dataset is `output`.
  SweepSummary run(const std::string& scene, const std::string& output, std::size_t jobs = 1,
                   const std::vector<Override>& overrides = {}) const {
    SweepOptions options;
    options.scene_path = scene;
    options.overrides = overrides;
    options.jobs = jobs;
    options.output = path(output);
    return run_sweep(options, catalogues());
  }
};

// The pads slip at 2 mu F = m g. In addition to the motors' F = 4 N - 3.5 N/s (t - 0.5 s) their
// springs carry the force of the sliders' damping of 5 N s/m and of the pads' own dashpots (1 ms
// times the middle pillar's 7.1 kN/m, the last to touch) while they open at v = 3.5 N/s over 7.1
// kN/m: 12.1 N s/m * 0.493 mm/s = 6 mN, which is 1.7 ms.
TEST_F(BodiesRun, HeldBoxSlipsWhenTheGripIsTooWeak) {
  const SweepSummary summary = run(scenes + "held_box.yaml", "held.h5");
  const double closed_form = 0.5 + (4.0 - 0.981) / 3.5;
  EXPECT_NEAR(summary.trials.at(0).outcome.gross_slip_time, closed_form + 0.0017, 0.0005);
}

// The fingers of two_fingers.xml on a column that turns about the vertical through the box.
constexpr const char* turning_fingers = R"(<mujoco model="turning_fingers">
  <option integrator="implicitfast"/>
  <worldbody>
    <body name="column" pos="0 0 0.1">
      <joint name="turn" type="hinge" axis="0 0 1" damping="1"/>
      <geom type="box" size="0.01 0.01 0.01" pos="0 0 -0.08" mass="1"/>
      <body name="left_finger" pos="-0.01973 0 0">
        <joint name="left" type="slide" axis="1 0 0" damping="5"/>
        <geom type="box" pos="-0.01 0 0" size="0.005 0.012 0.012" mass="0.05"/>
        <site name="left_pad" zaxis="-1 0 0"/>
      </body>
      <body name="right_finger" pos="0.01973 0 0">
        <joint name="right" type="slide" axis="-1 0 0" damping="5"/>
        <geom type="box" pos="0.01 0 0" size="0.005 0.012 0.012" mass="0.05"/>
        <site name="right_pad" zaxis="1 0 0"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="left" joint="left" ctrlrange="0 20"/>
    <motor name="right" joint="right" ctrlrange="0 20"/>
    <position name="turn" joint="turn" kp="5" ctrlrange="-3 3"/>
  </actuator>
</mujoco>
)";

// `hold` is the value of the key.
std::string turning_scene(const std::string& hold) {
  return "slipbench: 1\nduration: 1.5 s\nseed: 7\nsurface: {material: acrylic}\nfriction: {static: 0.5, kinetic: 0.5}\n"
         "model: turning_fingers.xml\n"
         "bodies:\n  box: {shape: box, size: [40 mm, 40 mm, 60 mm], mass: 100 g, position: [0 mm, 0 mm, 100 mm]}\n"
         "controls: {left: 4 N, right: 4 N, turn: [[0.5 s, 0], [1.3 s, 1.57]]}\n"
         "sensors:\n  left: {type: papillarray, site: left_pad, touches: [box]}\n"
         "  right: {type: papillarray, site: right_pad, touches: [box]}\n"
         "hold: " +
         hold + "\n";
}

// 2 mu F = 4 N hold the box's 0.98 N while the hand turns it by most of a right angle about its own
// axis. In the world its middle circles a finger 20 mm away; relative to the finger it stays except
// for the pads' compliance, far below a millimetre.
TEST_F(BodiesRun, AHandThatTurnsHoldsItsBox) {
  std::ofstream(path("turning_fingers.xml")) << turning_fingers;
  std::ofstream(path("turning.yaml")) << turning_scene("{body: box, against: left, from: 0.4 s, within: 1 mm}");
  const SweepSummary summary = run(path("turning.yaml"), "turning.h5");
  const TrialRecord record = DatasetReader(path("turning.h5")).read_trial(0);
  const auto left = std::ranges::find(record.bodies, "left", &BodyRecord::name);
  ASSERT_NE(left, record.bodies.end());
  const auto first = [&](std::size_t i) { return left->pose.at(i); };
  const auto last = [&](std::size_t i) { return left->pose.at(left->pose.size() - 7 + i); };
  EXPECT_GT(std::hypot(last(0) - first(0), last(1) - first(1)), 0.02) << "the finger has gone round";
  ASSERT_TRUE(summary.trials.at(0).outcome.hold);
  EXPECT_TRUE(summary.trials.at(0).outcome.hold->held) << summary.trials.at(0).outcome.hold->moved;
}

// From 1.4999999 s on a trial of 1.5 s has no step left.
TEST_F(BodiesRun, AHoldThatIsNeverLookedAtIsRefused) {
  std::ofstream(path("turning_fingers.xml")) << turning_fingers;
  std::ofstream(path("turning.yaml")) << turning_scene("{body: box, against: left, from: 1.4999999 s, within: 1 mm}");
  EXPECT_THAT(refusal_of([&] { run(path("turning.yaml"), "turning.h5"); }),
              mentions({"turning.yaml:13", "hold.from", "1.4999999 s", "0 s"}));
  EXPECT_FALSE(std::filesystem::exists(path("turning.h5")));
}

// The tips of articulated pads settle before the first step, which may take seconds.
TEST(BodiesOfArticulatedPads, AnInterruptEndsWhatComesBeforeTheFirstStep) {
  const Scene scene = parsed(shipped("bodies/held_box.yaml", {{"fidelity", "articulated"}}));
  EXPECT_NO_THROW(check_trial(scene, 0));
  const std::atomic<bool> interrupt{true};
  const InterruptScope scope(&interrupt);
  EXPECT_THROW(check_trial(scene, 0), Interrupted);
}

// The same file with articulated pads, at 1 ms: they slip within a step of the field.
TEST_F(BodiesRun, ArticulatedPadsHoldTheSameBox) {
  const SweepSummary summary = run(scenes + "held_box.yaml", "held.h5", 1, {{"fidelity", "articulated"}});
  const double closed_form = 0.5 + (4.0 - 0.981) / 3.5;
  EXPECT_NEAR(summary.trials.at(0).outcome.gross_slip_time, closed_form + 0.0017, 0.001);
}

TEST_F(BodiesRun, DatasetsOpenInReportAndExport) {
  for (const std::string name : {"held_box", "pressed_box", "sliding_block"}) {
    run(scenes + name + ".yaml", name + ".h5");
    const DatasetReader reader(path(name + ".h5"));
    EXPECT_THAT(reader.bodies(0), Contains(name == "sliding_block" ? "sole" : "box"));
    const TrialRecord record = reader.read_trial(0);
    for (const BodyRecord& body : record.bodies) EXPECT_EQ(body.pose.size(), 7 * record.num_samples()) << body.name;
    write_report(path(name + ".h5"), path(name + ".html"));
    EXPECT_GT(std::filesystem::file_size(path(name + ".html")), 100'000U);
    EXPECT_EQ(export_dataset(path(name + ".h5"), path(name), {}).size(), 1U);
  }
}

TEST_F(BodiesRun, ContentDoesNotDependOnTheJobs) {
  const std::vector<Override> sweep{{"sweep", "{bodies.box.mass: [100 g, 50 g], friction.scale: [0.8, 1, 1.2]}"},
                                    {"duration", "0.3 s"}};
  run(scenes + "held_box.yaml", "one.h5", 1, sweep);
  run(scenes + "held_box.yaml", "two.h5", 2, sweep);
  EXPECT_EQ(DatasetReader(path("one.h5")).content_sha256(), DatasetReader(path("two.h5")).content_sha256());
}

TEST_F(BodiesRun, ArticulatedPadsRunTheSameScene) {
  const std::string stage = SLIPBENCH_SOURCE_DIR "/scenes/papillarray/stage.yaml";
  const std::vector<Override> articulated{{"fidelity", "articulated"}, {"duration", "2.5 s"}};
  const SweepSummary field = run(stage, "field.h5", 1, {{"duration", "2.5 s"}}),
                     other = run(stage, "articulated.h5", 1, articulated);
  const double from = 2.0, onset = field.trials.at(0).outcome.gross_slip_time - from;
  EXPECT_NEAR(other.trials.at(0).outcome.gross_slip_time - from, onset, 0.02 * onset);  // issue 4's limit for onsets
}

// The dataset identifies the model file's content at the time of the run.
TEST_F(BodiesRun, DatasetHasTheModelsDigest) {
  std::ofstream(path("abc")) << "abc";
  EXPECT_EQ(file_sha256(path("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");  // FIPS 180-4's own example
  EXPECT_THROW(file_sha256(path("none")), InputError);

  const auto record_of = [](const std::string& name) {
    return run_trial(parsed(shipped("bodies/" + name, {{"duration", "10 ms"}})), 0, Recording::full).record;
  };
  const auto digests = [](const TrialRecord& record) {
    std::vector<std::string> found;
    for (const EncodedAttribute& attribute : TrialEncoder().encode(record).attributes) {
      if (attribute.name == "model_sha256") found.push_back(std::get<std::string>(attribute.value));
    }
    return found;
  };
  EXPECT_THAT(digests(record_of("held_box.yaml")), ElementsAre(file_sha256(scenes + "two_fingers.xml")));
  EXPECT_THAT(digests(record_of("pressed_box.yaml")), IsEmpty());
}

TEST_F(BodiesRun, MessagesNameTheLineOfTheScene) {
  std::filesystem::copy_file(scenes + "two_fingers.xml", path("two_fingers.xml"));
  std::ofstream(path("scene.yaml")) << "slipbench: 1\n"
                                       "model: two_fingers.xml\n"
                                       "bodies: {box: {shape: box}}\n"
                                       "sensors:\n"
                                       "  left:\n"
                                       "    type: papillarray\n"
                                       "    site: lost\n"
                                       "    touches: [box]\n";
  EXPECT_THAT(refusal_of([&] { run(path("scene.yaml"), "x.h5"); }),
              refused_at(path("scene.yaml") + ":7", {"sensors.left.site", "lost"}));
}

// A run that fails on its way is a failed trial, not a result.
TEST_F(BodiesRun, RunThatGoesWrongFailsWithWhatWasSeen) {
  const SweepSummary summary = run(scenes + "pressed_box.yaml", "x.h5", 1, {{"bodies.box.position", "[0 mm, 0 mm, -15 mm]"}});
  ASSERT_EQ(summary.failed.size(), 1U);
  EXPECT_THAT(summary.failed[0].message, mentions({"trial 0", scenes + "pressed_box.yaml:6", "diverged"}));
  EXPECT_THAT(summary.failed[0].message, HasSubstr("body 'box'"));
}

// A box that lies on a table cannot yield to a pad that comes 5 mm further: pillars are 4.2 mm high.
TEST_F(BodiesRun, PillarsCompressedBeyondTheirHeightNameTheLineOfTheSensor) {
  const SweepSummary summary =
      run(scenes + "pressed_box.yaml", "x.h5", 1, {{"motion.compression", "5 mm"}, {"motion.start", "1.6 s"}});
  ASSERT_EQ(summary.failed.size(), 1U);
  EXPECT_THAT(summary.failed[0].message,
              refused_at("trial 0: " + scenes + "pressed_box.yaml:15", {"sensors.pad", "'box'", "4.2 mm"}));
}

// Ends a trial with an error that names no value of the scene.
class RefusingDetector final : public Detector {
 public:
  const SlipEstimate& update(const SensorFrame& /*frame*/) override { throw InputError("the detector refuses"); }
};

TEST_F(BodiesRun, ErrorOfATrialWithoutAValueNamesTheLineOfTheSensors) {
  register_detector({.name = "refusing", .summary = "s", .law = "l", .source = "s", .parameters = {}},
                    [](const Parameters&, const FrameSource&) { return std::make_unique<RefusingDetector>(); });
  std::ofstream(path("scene.yaml")) << "slipbench: 1\nduration: 0.5 s\n"
                                       "sensors: {pad: {type: taxels, rows: 1, columns: 1}}\ndetector: {type: refusing}\n";
  const SweepSummary summary = run(path("scene.yaml"), "x.h5");
  ASSERT_EQ(summary.failed.size(), 1U);
  EXPECT_THAT(summary.failed[0].message, refused_at("trial 0: " + path("scene.yaml") + ":3", {"the detector refuses"}));
}

// Tips of 1e-60 N/m on pillars that begin inside the box cannot come to rest: the run is refused
// before its first trial, at the line of its time step.
TEST_F(BodiesRun, ErrorBeforeTheFirstTrialNamesALine) {
  EXPECT_THAT(refusal_of([&] {
                run(scenes + "held_box.yaml", "x.h5", 1, {{"fidelity", "articulated"}, {"sensors.right.k_normal", "1e-60"}});
              }),
              refused_at(scenes + "held_box.yaml:7", {"rest"}));
}

}  // namespace
}  // namespace slipbench
