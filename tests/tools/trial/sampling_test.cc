// Parts of a trial by themselves: samples of a multiplexed sensor, the control loop, the judge, and
// a detector's latency.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "sim/grasp/grasp.h"
#include "sim/motion/guided.h"
#include "sim/stage/stage_simulation.h"
#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/trial/judge.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/trial_run.h"

namespace slipbench::sampling_test {
namespace {

TEST(Sampling, ASampleIsCompleteWithTheLastOfItsReadings) {
  const Sampling sampling{.stride = 2, .scans = 3};
  std::vector<std::size_t> reads, completes;
  for (std::size_t tick = 0; tick < 14; ++tick) {
    if (sampling.reads_at(tick)) reads.push_back(tick);
    if (sampling.completes_at(tick)) completes.push_back(tick);
  }
  EXPECT_THAT(reads, ElementsAre(0, 2, 4, 6, 8, 10, 12));
  EXPECT_THAT(completes, ElementsAre(4, 10));
  EXPECT_EQ(sampling.samples(14), 2U);  // readings at 12 and after would be the third sample's
  EXPECT_EQ(sampling.samples(4), 0U);   // tick 4 is not reached
  EXPECT_EQ(sampling.samples(5), 1U);
}

TEST(Sampling, WithOneReadingASampleTheFirstIsAtTheBeginning) {
  const Sampling sampling{.stride = 4, .scans = 1};
  EXPECT_TRUE(sampling.completes_at(0));
  EXPECT_EQ(sampling.samples(1), 1U);
  EXPECT_EQ(sampling.samples(5), 2U);
}

// 250 samples a second of four readings; values are the numbers of the latest reading and the
// latest sample.
class Multiplexed final : public Sensor {
 public:
  explicit Multiplexed(PadLayout layout) : layout_(std::move(layout)) {
    channels_ = {{.name = "reading", .unit = "1", .shape = {1}, .channel_names = {"R"}},
                 {.name = "image", .unit = "1", .shape = {1}, .channel_names = {"I"}, .every = 3, .age = 2e-3}};
  }
  [[nodiscard]] const PadLayout& layout() const override { return layout_; }
  [[nodiscard]] double rate() const override { return 250.0; }
  [[nodiscard]] std::size_t scans() const override { return 4; }
  [[nodiscard]] const std::vector<Channel>& channels() const override { return channels_; }
  const SensorFrame& measure(const ContactFrame& truth) override {
    values_ = {static_cast<float>(reads_), static_cast<float>(reads_ / 4)};
    ++reads_;
    frame_ = {truth.time, values_};
    return frame_;
  }
  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool) const override { return truth.state; }

 private:
  PadLayout layout_;
  std::vector<Channel> channels_;
  std::array<float, 2> values_{};
  int reads_ = 0;
  SensorFrame frame_;
};

// The shipped press-and-slide, cut to `duration`, at steps of 1 ms.
Scene scene_of(const std::string& duration) { return stage_scene({{"duration", duration}}); }

TrialRecord record_of(const Scene& scene) {
  std::vector<std::unique_ptr<Sensor>> sensors;
  sensors.push_back(std::make_unique<Multiplexed>(make_sensor(scene.sensors.front(), scene.seed, 0)->layout()));
  const PadLayout* pad = &sensors.front()->layout();
  const double readings = 1000.0;
  StageSimulation simulation(scene, {&pad, 1}, {&readings, 1}, 0);
  Sampler sampler(scene, sensors, simulation);
  TrialRecord record = new_record(scene, sensors, simulation, 0);
  Recorder recorder(scene, sensors, simulation, nullptr, sampler, max_record_bytes, record);
  while (!sampler.finished()) {
    simulation.step();
    recorder.record(sampler.measure(), ControlLoop());
  }
  return record;
}

TEST(Sampling, TheRecordHoldsWholeSamplesAndASlowChannelItsOwnTime) {
  const TrialRecord record = record_of(scene_of("30 ms"));
  const SensorRecord& sensor = record.sensors.front();
  // 30 readings at 0 to 29 ms: seven samples, complete at 3, 7, ... 27 ms, with two images,
  // complete with the third and the sixth sample.
  ASSERT_EQ(sensor.time.size(), 7U);
  EXPECT_EQ(record.num_samples(), 7U);
  for (std::size_t k = 0; k < 7; ++k) {
    EXPECT_NEAR(sensor.time[k], 3e-3 + 4e-3 * static_cast<double>(k), 1e-12);
    EXPECT_EQ(sensor.time[k], record.body_time[k]);
    EXPECT_EQ(sensor.channels[0].values[k], 3.0F + 4.0F * static_cast<float>(k));
  }
  EXPECT_FALSE(sensor.channels[0].time.has_value());
  ASSERT_TRUE(sensor.channels[1].time.has_value());
  EXPECT_THAT(sensor.channels[1].values, ElementsAre(2.0F, 5.0F));
  EXPECT_EQ(sensor.labels.state.size(), 7U);
  ASSERT_EQ(sensor.channels[1].time->size(), 2U);
  EXPECT_NEAR(sensor.channels[1].time->at(0), 11e-3 - 2e-3, 1e-12);  // complete at 11 ms, read 2 ms before
  EXPECT_NEAR(sensor.channels[1].time->at(1), 23e-3 - 2e-3, 1e-12);
}

// A filter before the converter runs at every tick of 0.2 ms: a PapillArray at 100 Hz has its
// samples at the same times with and without it, and the values do not depend on the rate.
TEST(Sampling, AFilterFeelsTheTicksBetweenReadings) {
  const auto readings = [](const char* rate, const char* electronics) {
    const Scene scene = stage_scene(
        {{"duration", "300 ms"}, {"time_step", "0.2 ms"}, {"sensors.pad.rate", rate}, {"sensors.pad.electronics", electronics}});
    return run_trial(scene, 0, Recording::full).record.sensors.front();
  };
  const SensorRecord slow = readings("100 Hz", "[low_pass]"), fast = readings("1 kHz", "[low_pass]"),
                     ideal = readings("100 Hz", "ideal");
  ASSERT_EQ(slow.time.size(), 30U);
  EXPECT_EQ(slow.time, ideal.time);
  const std::vector<float>&few = slow.channels[0].values, &many = fast.channels[0].values;
  EXPECT_NE(few, ideal.channels[0].values);
  for (std::size_t k = 0; k < 30; ++k) {
    EXPECT_EQ(slow.time[k], fast.time[10 * k]);
    for (std::size_t v = 0; v < 27; ++v) EXPECT_EQ(few[27 * k + v], many[270 * k + v]) << k;
  }
}

TEST(Sampling, ATrialWithoutAWholeSampleIsRefused) {
  // Readings at 0, 1 and 2 ms.
  EXPECT_THAT(refusal_of<SceneValueError>([&] { record_of(scene_of("3 ms")); }), mentions({"4 ms"}));
}

TEST(Sampling, ASensorBetweenItsUnitsNeedsASimulationThatTellsOfElements) {
  const Scene scene = scene_of("30 ms");
  PadLayout with = make_sensor(scene.sensors.front(), scene.seed, 0)->layout(), without = with;
  with.element_truth = true;
  std::vector<std::unique_ptr<Sensor>> sensors;
  sensors.push_back(std::make_unique<Multiplexed>(with));
  const double readings = 1000.0;
  const auto sample_on = [&](const PadLayout* pad) {
    const StageSimulation simulation(scene, {&pad, 1}, {&readings, 1}, 0);
    const Sampler sampler(scene, sensors, simulation);
  };
  EXPECT_NO_THROW(sample_on(&with));
  EXPECT_THROW(sample_on(&without), std::logic_error);
}

constexpr double step = 2e-4;  // s

Parameters grip_defaults() { return defaults_of(std::ranges::find(grasp_catalogue(), "grip", &Entry::name)->parameters); }

class BareGripper : public HeldBox {
 public:
  explicit BareGripper(double phase, const Parameters& grip = grip_defaults()) : gripper_(grip, 0.08, phase) {}
  Gripper& gripper() override { return gripper_; }
  [[nodiscard]] const GraspTruth& truth() const override { return truth_; }
  [[nodiscard]] double ideal_force() const override { return 1.0; }
  [[nodiscard]] double lift_start() const override { return 1.0; }

 private:
  Gripper gripper_;
  GraspTruth truth_;
};

struct Handed {
  double frame_time, slip_time, read_time;
  int position;
};

// Closes by one count each time, or commands the position `wrong` if it is not a byte.
class Notes final : public Controller {
 public:
  explicit Notes(std::vector<Handed>& handed, int wrong = 0) : handed_(handed), wrong_(wrong) {}
  GripCommand update(const ControlInput& input) override {
    handed_.push_back({input.frame.time, input.slip.time, input.gripper.time, input.gripper.position});
    return {.position = wrong_ != 0 ? wrong_ : input.gripper.position + 1};
  }

 private:
  std::vector<Handed>& handed_;
  int wrong_;
};

// Reports slip for each frame, `latency` after it.
class Late final : public Detector {
 public:
  explicit Late(double latency) : latency_(latency) {}
  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_ = {.time = frame.time, .latency = latency_, .state = PadState::gross};
    return estimate_;
  }

 private:
  double latency_;  // s
  SlipEstimate estimate_;
};

// Runs ticks 0 to `ticks` - 1 with a frame every 10 ms; returns when the fingers first move.
double run(ControlLoop& loop, HeldBox& box, std::size_t ticks) {
  double moved = std::nan("");
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const double time = static_cast<double>(tick) * step;
    const SensorFrame frame{time, {}};
    const Tick now{0, time, tick % 50 == 0 ? &frame : nullptr};
    loop.update({&now, 1});
    box.gripper().update(time, 0.0);
    if (std::isnan(moved) && box.gripper().opening_speed(time) < 0.0) moved = time;
    loop.act({&now, 1});
  }
  return moved;
}

// Phase 3.1 ms, period 20 ms, write 10 ms after the read, latency 20 ms: reads at 3.1, 23.1 and
// 43.1 ms; the first command is written at 13.1 and acts from 33.1 ms on. No instant coincides with
// a tick: the next one (0.2 ms) executes it, and the drive moves from the exact instant.
TEST(ControlLoop, DelaysAreThoseOfTheScene) {
  BareGripper box(3.1e-3);
  const int start = box.gripper().position(0.0);
  std::vector<Handed> handed;
  ControlLoop loop(DelayedDetector(std::make_unique<Late>(0.015)), 0, std::make_unique<Notes>(handed), &box);
  const double moved = run(loop, box, 240);  // to 47.8 ms
  ASSERT_EQ(handed.size(), 3U);
  const double reads[] = {3.1e-3, 23.1e-3, 43.1e-3};
  const double frames[] = {0.0, 20e-3, 40e-3};  // the latest
  // Estimates are 15 ms late: the first read comes before any estimate, whose time is then -inf. The
  // estimate of 0 ms is there at 23.2 ms, and that of 20 ms at 43.2 ms.
  const double seen[] = {-std::numeric_limits<double>::infinity(), 0.0, 20e-3};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(handed[k].read_time, reads[k], 1e-12);
    EXPECT_NEAR(handed[k].frame_time, frames[k], 1e-12);
    if (k == 0) {
      EXPECT_EQ(handed[k].slip_time, seen[k]);
    } else {
      EXPECT_NEAR(handed[k].slip_time, seen[k], 1e-12);
    }
  }
  EXPECT_EQ(loop.seen(), PadState::gross);
  // Visible at the first tick with a speed after 33.1 ms.
  EXPECT_GT(moved, 33.1e-3);
  EXPECT_LE(moved, 33.1e-3 + step);
  EXPECT_EQ(loop.written().position, start + 1);
  EXPECT_EQ(loop.measured_position(), handed.back().position);
  // The second read still measures the start, so its command equals the first and tightens nothing.
  EXPECT_NEAR(loop.tightening().read_time, 3.1e-3, 1e-12);
  EXPECT_NEAR(loop.tightening().start_time, 33.1e-3, 1e-12);
}

// With no time between read and write, the command of a read is sent at the same instant.
TEST(ControlLoop, AReadComesBeforeTheWriteAtItsInstant) {
  Parameters grip = grip_defaults();
  grip.set("write_after", 0.0);
  BareGripper box(3.1e-3, grip);
  const int start = box.gripper().position(0.0);
  std::vector<Handed> handed;
  ControlLoop loop({}, 0, std::make_unique<Notes>(handed), &box);
  run(loop, box, 20);  // to 3.8 ms
  EXPECT_EQ(handed.size(), 1U);
  EXPECT_EQ(loop.written().position, start + 1);
}

// Commands, one at each update, the last one again and again.
class Sequence final : public Controller {
 public:
  explicit Sequence(std::vector<int> positions) : positions_(std::move(positions)) {}
  GripCommand update(const ControlInput&) override {
    return {.position = positions_[std::min(updates_++, positions_.size() - 1)]};
  }

 private:
  std::vector<int> positions_;
  std::size_t updates_ = 0;
};

// The fingers close by 10 counts of 0.374 mm, which take 0.19 s at 20 mm/s. A command of 0, followed
// by one of 5 before they have moved, opens them less, which tightens nothing.
TEST(ControlLoop, OpeningLessIsNotTightening) {
  BareGripper box(3.1e-3);
  const int start = box.gripper().position(0.0);
  std::vector<int> positions(20, start + 10);
  positions.insert(positions.end(), {start, start + 5});
  ControlLoop loop({}, 0, std::make_unique<Sequence>(positions), &box);
  run(loop, box, 2200);  // 22 reads, the last one at 423.1 ms
  ASSERT_EQ(loop.measured_position(), start + 10);
  ASSERT_EQ(loop.written().position, start + 5);
  EXPECT_NEAR(loop.tightening().read_time, 3.1e-3, 1e-12);
}

TEST(ControlLoop, ADetectorIsFedByItsOwnPadAlone) {
  ControlLoop loop(DelayedDetector(std::make_unique<Late>(0.0)), 1);
  const SensorFrame frame{0.0, {}};
  for (const std::size_t pad : {0U, 1U}) {
    const Tick tick{pad, 0.0, &frame};
    loop.update({&tick, 1});
    loop.act({&tick, 1});
    EXPECT_EQ(loop.seen(), pad == 1 ? PadState::gross : PadState::no_contact);
  }
}

TEST(ControlLoop, WithoutAControllerNothingMoves) {
  BareGripper box(3e-3);
  const int start = box.gripper().position(0.0);
  ControlLoop loop({}, 0, nullptr, &box);
  EXPECT_FALSE(loop.has_detector());
  EXPECT_TRUE(std::isnan(run(loop, box, 500)));
  EXPECT_EQ(loop.written().position, start);
  EXPECT_EQ(loop.measured_position(), start);
  EXPECT_EQ(loop.seen(), PadState::no_contact);
}

// The same gripper on an arm of 8 ms latency and 0.2 m/s2.
class GuidedGripper final : public BareGripper {
 public:
  using BareGripper::BareGripper;
  Guided* arm() override { return &arm_; }

 private:
  Guided arm_{defaults_of(guided_motion().about.parameters)};
};

// Commands 10 mm/s upwards at its second update, and nothing else for the arm.
class Raising final : public Controller {
 public:
  GripCommand update(const ControlInput& input) override {
    GripCommand command{.position = input.gripper.position};
    if (++updates_ == 2) command.arm = {.sideways = 0.0, .up = 10e-3};
    return command;
  }

 private:
  int updates_ = 0;
};

// Read at 23.1 ms, written at 33.1 ms, obeyed from 41.1 ms on; the third command, which has none
// for the arm, changes nothing.
TEST(ControlLoop, TheArmIsToldWithTheWrite) {
  GuidedGripper box(3.1e-3);
  ControlLoop loop({}, 0, std::make_unique<Raising>(), &box);
  run(loop, box, 400);
  EXPECT_EQ(loop.arm_command().up, 10e-3);
  EXPECT_EQ(loop.arm_command().sideways, 0.0);
  EXPECT_NEAR(box.arm()->lift_start(), 41.1e-3, 1e-12);
  EXPECT_NEAR(box.arm()->pad_at(1.0911).pose.position.z(), 10.25e-3, 1e-12);  // 50 ms and 0.25 mm of it on the ramp
}

TEST(ControlLoop, NoControllerCommandsAnArmThatIsPrescribed) {
  BareGripper box(0.0);
  ControlLoop loop({}, 0, std::make_unique<Raising>(), &box);
  EXPECT_THROW(run(loop, box, 400), std::logic_error);
}

TEST(ControlLoop, CommandThatIsNoByteEndsTheRun) {
  BareGripper box(0.0);
  std::vector<Handed> handed;
  ControlLoop loop({}, 0, std::make_unique<Notes>(handed, 256), &box);
  EXPECT_THROW(run(loop, box, 100), InputError);
}

// A box and a simulation whose truth is set by the test.
class ToldBox final : public BareGripper {
 public:
  ToldBox() : BareGripper(0.0) {}
  [[nodiscard]] const GraspTruth& truth() const override { return now; }
  GraspTruth now;
};

class Told final : public Simulation {
 public:
  [[nodiscard]] std::size_t ticks(std::size_t) const override { return 10; }
  [[nodiscard]] double time_step(std::size_t) const override { return 1e-3; }
  [[nodiscard]] std::size_t stride(std::size_t) const override { return 1; }
  [[nodiscard]] std::span<const std::size_t> stepped() const override { return {}; }
  [[nodiscard]] const ContactFrame& contact(std::size_t) const override { return now; }
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override { return bodies_; }
  [[nodiscard]] bool rotating() const override { return false; }
  void step() override {}
  ContactFrame now;

 private:
  std::vector<NamedBody> bodies_;
};

struct JudgeTest : ::testing::Test {
  void judge_tick(double time) {
    if (!judge) {
      sensors.push_back(make_sensor(scene.sensors.front(), scene.seed, 0));
      result.record = new_record(scene, sensors, bench, 0);
      judge.emplace(scene, bench, &box, result);
    }
    bench.now.time = box.now.time = time;
    const Tick tick{0, time, nullptr};
    judge->observe({&tick, 1}, loop);
  }

  Scene scene = scene_of("3 s");
  std::vector<std::unique_ptr<Sensor>> sensors;
  Told bench;
  ToldBox box;
  ControlLoop loop{DelayedDetector(std::make_unique<Late>(0.0))};
  TrialResult result;
  std::optional<Judge> judge;
};

// The lift begins at 1 s; a slip before that comes from closing fingers.
TEST_F(JudgeTest, TheFirstSlipOfTheLiftIsJudged) {
  for (const double time : {0.5, 1.2, 1.5}) {
    bench.now.events = {{time, 0, EventKind::slip}};
    judge_tick(time);
  }
  EXPECT_EQ(result.units[0][0].onset_time, 0.5);
  EXPECT_EQ(result.record.outcome.judged_slip_time, 1.2);
}

TEST_F(JudgeTest, ATurnIsKnownByItsLeastTilt) {
  scene.motion.name = guided_motion_name;
  for (const double tilt : {1.5, 0.3, 0.8}) {
    box.now.tilt = tilt;
    judge_tick(1.0);
  }
  const TurnOutcome& turn = result.record.outcome.grasp->turn.value();
  EXPECT_EQ(turn.tilt, 0.8);
  EXPECT_EQ(turn.least_tilt, 0.3);
}

// Answers frame k with the k-th of the given latencies, the last one for all later frames; states
// cycle through non_slip, incipient, gross.
class Scripted : public Detector {
 public:
  explicit Scripted(std::vector<double> latencies) : latencies_(std::move(latencies)) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_ = {frame.time, latencies_[std::min(frames_, latencies_.size() - 1)], static_cast<PadState>(1 + frames_ % 3)};
    ++frames_;
    return estimate_;
  }

 private:
  std::vector<double> latencies_;
  std::size_t frames_ = 0;
  SlipEstimate estimate_;
};

DelayedDetector detector_with(std::vector<double> latencies) {
  return DelayedDetector(std::make_unique<Scripted>(std::move(latencies)));
}

// The first tick that sees the frame of tick k is k + ceil(latency / step). One frame a tick.
TEST(DelayedDetector, SeesAnEstimateAtTheFirstTickAfterItsLatency) {
  struct Case {
    double latency;  // in steps
    std::size_t late;
  };
  for (const double step : {1e-3, 1e-4, 1.0 / 3000.0, 0.7e-3}) {
    // The third is a microsecond with steps of a millisecond.
    for (const Case c : {Case{0.0, 0}, {1e-3, 1}, {0.999, 1}, {1.0, 1}, {1.001, 2}, {2.0, 2}, {2.5, 3}, {15.0, 15}}) {
      DelayedDetector detector = detector_with({c.latency * step});
      for (std::size_t tick = 0; tick < 20'000; ++tick) {
        const double time = static_cast<double>(tick) * step;
        detector.update({time, {}});
        const SlipEstimate& seen = detector.seen_at(time);
        if (tick < c.late) {
          ASSERT_EQ(seen.state, PadState::no_contact);
          continue;
        }
        const std::size_t from = tick - c.late;
        ASSERT_EQ(seen.time, static_cast<double>(from) * step) << c.latency << " steps of " << step << " s, tick " << tick;
        ASSERT_EQ(seen.state, static_cast<PadState>(1 + from % 3));
      }
    }
  }
}

// Returns the number of its frame, of which it keeps a single copy: a pending estimate must hold
// its own.
class Numbering final : public Detector {
 public:
  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_.time = frame.time;
    estimate_.latency = 2.5e-3;
    estimate_.features = {static_cast<double>(frames_++)};
    return estimate_;
  }
  [[nodiscard]] const std::vector<Feature>& features() const override { return features_; }

 private:
  std::vector<Feature> features_{{"number", "frames"}};
  SlipEstimate estimate_;
  std::size_t frames_ = 0;
};

// 2.5 ms late, frames and ticks a millisecond apart: at tick k the number is k - 3.
TEST(DelayedDetector, FeaturesAreThoseOfTheEstimateThatIsSeen) {
  DelayedDetector detector(std::make_unique<Numbering>());
  ASSERT_EQ(detector.features().size(), 1U);
  EXPECT_EQ(detector.features().front().name, "number");
  for (std::size_t tick = 0; tick < 20; ++tick) {
    const double time = 1e-3 * static_cast<double>(tick);
    detector.update({time, {}});
    const std::vector<double>& seen = detector.seen_at(time).features;
    if (tick < 3) {
      EXPECT_TRUE(seen.empty());
    } else {
      EXPECT_EQ(seen, std::vector<double>{static_cast<double>(tick - 3)});
    }
  }
}

// The sensor samples every fourth tick: an estimate stays visible until the next one is available.
TEST(DelayedDetector, KeepsTheLatestEstimateBetweenSamples) {
  DelayedDetector detector = detector_with({2.5e-3});
  for (std::size_t tick = 0; tick < 40; ++tick) {
    const double time = 1e-3 * static_cast<double>(tick);
    if (tick % 4 == 0) detector.update({time, {}});
    const SlipEstimate& seen = detector.seen_at(time);
    if (tick < 3) {
      EXPECT_EQ(seen.state, PadState::no_contact);
    } else {
      EXPECT_EQ(seen.time, 1e-3 * static_cast<double>((tick - 3) / 4 * 4)) << tick;
    }
  }
}

// The frame of tick 0 takes 5 ticks, that of tick 1 one: from tick 2 on the later estimate is
// visible, and the earlier one never.
TEST(DelayedDetector, NeverGoesBackToAnOlderFrame) {
  DelayedDetector detector = detector_with({5e-3, 1e-3, 100.0});
  std::vector<double> seen;
  for (std::size_t tick = 0; tick < 10; ++tick) {
    const double time = 1e-3 * static_cast<double>(tick);
    if (tick < 2) detector.update({time, {}});
    const SlipEstimate& estimate = detector.seen_at(time);
    seen.push_back(estimate.state == PadState::no_contact ? -1.0 : estimate.time);
  }
  EXPECT_EQ(seen, (std::vector{-1.0, -1.0, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3}));
}

TEST(DelayedDetector, ALatencyThatCannotBeIsABug) {
  for (const double latency : {-1e-9, std::numeric_limits<double>::quiet_NaN()}) {
    DelayedDetector detector = detector_with({latency});
    EXPECT_THROW(detector.update({0.0, {}}), std::logic_error);
  }
  DelayedDetector never = detector_with({std::numeric_limits<double>::infinity()});
  never.update({0.0, {}});
  EXPECT_EQ(never.seen_at(1e9).state, PadState::no_contact);
}

TEST(DelayedDetector, AnOlderEstimateIsABug) {
  DelayedDetector detector = detector_with({0.0});
  detector.update({2e-3, {}});
  EXPECT_THROW(detector.update({1e-3, {}}), std::logic_error);
}

}  // namespace
}  // namespace slipbench::sampling_test
