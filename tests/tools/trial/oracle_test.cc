// Access to the truth: the oracle has it, no detector does.
#include "tools/registry/program_catalogues.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "detectors/network/engine.h"
#include "sim/stage/stage_simulation.h"
#include "tests/detectors/network/networks.h"
#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/dataset/record/encoder.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/trial_run.h"

namespace slipbench {
namespace {

// The published press-and-slide at 4 mm/s, sampled every tick, with noise, by the pad that the
// detector reads; for a detector of vibrations the piezoelectric skin's scene. A nib pad is tared
// before it touches, at 0.165 s, and its detector needs fewer flags than the beginning of the slide
// raises.
Scene scene_with(const std::string& detector) {
  const bool hears = detector.find("type: band_energy") != std::string::npos;
  SceneFile file = shipped(hears ? "piezo_skin/slide.yaml" : "papillarray/stage.yaml");
  const bool nibs = detector.find("type: nib_") != std::string::npos;
  if (nibs) {
    file.apply({"sensors", "{pad: {type: nib_pad, scan: simultaneous}}"});
    file.apply({"time_step", "auto"});
    file.apply({"motion.compression", "0.3 mm"});
  }
  if (detector.find("type: marker_") != std::string::npos) {  // pads of springs; under a sphere those at the rim slip first
    file.apply({"sensors", "{pad: {type: gel_markers, rate: 1 kHz, noise: 0.1}}"});
    file.apply({"surface", "{material: acrylic, shape: sphere, radius: 20 mm}"});
  }
  file.apply({"sensors.pad.electronics", "typical"});
  if (hears) file.apply({"duration", "2 s"});
  file.apply({"detector", detector});
  if (detector.find("type: plugin") != std::string::npos)
    file.apply({"detector.library", SLIPBENCH_TEST_PLUGINS "/ratio_gate.so"});
  if (detector.find("type: network") != std::string::npos) file.apply({"detector.model", network::shipped("gru21.onnx")});
  if (nibs) file.apply({"detector.tare", "0.1 s"});
  for (const char* name : {"type: deviation", "type: sum_change", "type: shear_ratio"}) {  // of forces, 4 N and less
    if (detector.find(name) != std::string::npos) file.apply({"detector.threshold", "0.01"});
  }
  if (detector.find("nib_linear_slip") != std::string::npos) file.apply({"detector.counter_max", "3"});
  return parsed(file);
}

// All except networks if no engine is available.
std::vector<Entry> usable_detectors() {
  std::vector<Entry> entries = detector_entries();
  if (!network::engine_available()) std::erase_if(entries, [](const Entry& entry) { return entry.name == "network"; });
  return entries;
}

TrialRecord run(const std::string& detector) { return run_trial(scene_with(detector), 0, Recording::full).record; }

// A bench with wrong labels; the forces and displacements of its sensors are right.
class Liar final : public Simulation {
 public:
  explicit Liar(Simulation& honest) : honest_(honest) {}

  [[nodiscard]] std::size_t ticks(std::size_t pad) const override { return honest_.ticks(pad); }
  [[nodiscard]] double time_step(std::size_t pad) const override { return honest_.time_step(pad); }
  [[nodiscard]] std::size_t stride(std::size_t pad) const override { return honest_.stride(pad); }
  [[nodiscard]] std::span<const std::size_t> stepped() const override { return honest_.stepped(); }
  [[nodiscard]] const ContactFrame& contact(std::size_t) const override { return lie_; }
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override { return honest_.bodies(); }
  [[nodiscard]] bool rotating() const override { return honest_.rotating(); }

  void step() override {
    honest_.step();
    lie_ = honest_.contact(0);
    const auto other = [](PadState state) { return static_cast<PadState>((static_cast<int>(state) + 1) % 4); };
    lie_.state = other(lie_.state);
    lie_.state_micro = other(lie_.state_micro);
    lie_.stuck_fraction = 1.0 - lie_.stuck_fraction;
    std::ranges::reverse(lie_.unit_state);
    for (UnitState& state : lie_.unit_state) state = static_cast<UnitState>((static_cast<int>(state) + 1) % 4);
    lie_.slip_velocity = (-1.0 - lie_.slip_velocity).eval();
    lie_.slip_distance = (1.0 + lie_.slip_distance.reverse()).eval();
    lie_.margin = (1.0 - lie_.margin.reverse()).eval();
    lie_.slip_direction += 1.0;
    lie_.slip_centre += 1.0;
    lie_.slip_angle += 1.0;
    lie_.events.clear();
  }

 private:
  Simulation& honest_;
  ContactFrame lie_;
};

// The truth behind the labels does not affect a detector's loop: the classes equal the trial's, and
// the estimates are bit-identical to those of an honest bench. The oracle follows the labels in
// both.
TEST(Truth, IsSeenByTheOracleAlone) {
  for (const Entry& entry : usable_detectors()) {
    const Scene scene = scene_with("{type: " + entry.name + "}");
    const std::vector<std::uint8_t> classes = run_trial(scene, 0, Recording::full).record.control->detector_class;
    EXPECT_THAT(classes, Contains(AnyOf(2, 3))) << entry.name << " sees nothing: this would test nothing";

    const auto device = make_sensor(scene.sensors[0], scene.seed, 0);
    const auto misled_device = make_sensor(scene.sensors[0], scene.seed, 0);
    const PadLayout* const pads[] = {&device->layout()};
    const double rates[] = {device->rate()};
    StageSimulation simulation(scene, pads, rates, 0);
    Liar liar(simulation);
    const SensorSource pad{"pad", scene.sensors[0].type, device->rate(), device->channels()};
    const FrameSource source{pad.name, pad.type, pad.rate, pad.channels, 0, scene.duration, scene.seed, {pad}};
    DelayedDetector honest(make_detector(*scene.detector, source, simulation));
    DelayedDetector misled(make_detector(*scene.detector, source, liar));
    std::size_t differ = 0;
    for (std::size_t tick = 0; tick < simulation.ticks(0); ++tick) {
      liar.step();
      const double time = simulation.contact(0).time;
      honest.update(device->measure(simulation.contact(0)));
      misled.update(misled_device->measure(liar.contact(0)));
      const SlipEstimate one = honest.seen_at(time);
      const SlipEstimate other = misled.seen_at(time);
      ASSERT_EQ(static_cast<std::uint8_t>(one.state), classes[tick]) << entry.name << " at " << time << " s";
      const bool same = one.state == other.state && one.time == other.time && one.latency == other.latency &&
                        std::memcmp(&one.stuck_fraction, &other.stuck_fraction, sizeof(double)) == 0;
      if (!same) ++differ;
    }
    EXPECT_EQ(differ, entry.name == oracle_type ? simulation.ticks(0) : 0) << entry.name;
  }
}

TEST(Oracle, SaysTheTrueClassAtEverySample) {
  const TrialRecord record = run("{type: truth}");
  EXPECT_EQ(record.control->detector, "truth");
  EXPECT_EQ(record.control->detector_class, record.sensors[0].labels.state);
  // The first tick at or after the onset.
  EXPECT_GE(record.outcome.detection_delay, 0.0);
  EXPECT_LT(record.outcome.detection_delay, 1e-3);
  EXPECT_TRUE(std::isnan(record.outcome.false_alarm_time));
}

// The elements of a piezoelectric skin's patch stick and slip alternately, hardly ever all at once:
// its one unit slips if a part does.
TEST(Oracle, SaysOfASingleUnitWhetherAPartOfItSlips) {
  // It slides from about 1.55 s on.
  const Scene scene = parsed(shipped("piezo_skin/slide.yaml", {{"detector", "{type: truth}"}, {"duration", "1.7 s"}}));
  const TrialRecord record = run_trial(scene, 0, Recording::full).record;
  const LabelRecord& labels = record.sensors[0].labels;
  EXPECT_EQ(labels.state, labels.state_micro);
  EXPECT_EQ(record.control->detector_class, labels.state);
  EXPECT_EQ(accuracy(record.control->confusion), 1.0);
  EXPECT_GT(labels.state_count[3], 500U);  // a third of the 0.15 s, at 10 kHz
  EXPECT_EQ(record.outcome.first_slip_time, record.outcome.first_micro_slip_time);
  EXPECT_LT(record.outcome.detection_delay, 1e-4);
  EXPECT_TRUE(std::isnan(record.outcome.false_alarm_time));
}

TEST(Oracle, IsLateByItsLatency) {
  std::vector<std::uint8_t> late = run("{type: truth}").sensors[0].labels.state;
  late.insert(late.begin(), 20, 0);
  late.resize(late.size() - 20);
  EXPECT_EQ(run("{type: truth, latency: 20 ms}").control->detector_class, late);
}

// In n samples in contact the oracle is wrong n p times, with the standard deviation sqrt(n p (1 -
// p)): six of these happen once in 5e8.
TEST(FlippedOracle, IsWrongAsOftenAsTheSceneSays) {
  const Confusion confusion = run("{type: truth, flip: 0.2}").control->confusion;
  double n = 0.0, wrong = 0.0;
  for (std::size_t truth = 1; truth < 4; ++truth) {
    EXPECT_EQ(confusion[truth][0], 0U);
    for (std::size_t seen = 1; seen < 4; ++seen) {
      n += static_cast<double>(confusion[truth][seen]);
      if (truth != seen) wrong += static_cast<double>(confusion[truth][seen]);
    }
  }
  EXPECT_GT(n, 3000.0);
  EXPECT_NEAR(wrong, 0.2 * n, 6.0 * std::sqrt(n * 0.2 * 0.8));
}

TEST(FlippedDetector, WithProbabilityZeroIsThePlainOneToTheByte) {
  for (const Entry& entry : usable_detectors()) {
    const std::string type = "{type: " + entry.name;
    EXPECT_EQ(trial_digest(run(type + ", flip: 0}")), trial_digest(run(type + "}"))) << entry.name;
    EXPECT_NE(trial_digest(run(type + ", flip: 0.5}")), trial_digest(run(type + "}"))) << entry.name;
  }
}

}  // namespace
}  // namespace slipbench
