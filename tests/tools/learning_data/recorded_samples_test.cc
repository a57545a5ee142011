#include "tools/learning_data/samples.h"

#include "tests/expect.h"

namespace slipbench::recorded_samples_test {
namespace {

// Ten samples at 10 Hz; `slow` is read with every fifth of them, 0.05 s earlier.
SensorRecord record() {
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.rate = 10.0;
  for (int k = 0; k < 10; ++k) sensor.time.push_back(0.1 * k);
  sensor.channels = {{"fast", "N", {1}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, {}},
                     {"slow", "N", {2}, {40, 41, 90, 91}, std::vector<double>{0.35, 0.85}}};
  return sensor;
}

TEST(RecordedSamples, ASlowerChannelKeepsItsLatestRow) {
  const SensorRecord sensor = record();
  RecordedSamples samples(sensor);
  EXPECT_EQ(samples.channels()[1].every, 5U);
  EXPECT_NEAR(samples.channels()[1].age, 0.05, 1e-12);
  for (int k = 0; k < 10; ++k) {
    const float slow = k < 9 ? 40.0F : 90.0F;
    EXPECT_THAT(samples.take().values, ElementsAre(static_cast<float>(k), slow, slow + 1.0F));
  }
  EXPECT_TRUE(samples.ended());
}

// Simulated magnetic skins have their field in uT (sensors/magnetic_skin); nobody knows such a unit of "fast".
TEST(RecordedSamples, KnowsTheUnitOfSimulatedSensorsOfTheType) {
  SensorRecord sensor = record();
  sensor.type = "magnetic_skin";
  sensor.channels[0].name = "field";
  EXPECT_EQ(RecordedSamples(sensor).channels()[0].usual_unit, "uT");
  EXPECT_EQ(RecordedSamples(record()).channels()[0].usual_unit, "");
}

TEST(RecordedSamples, RefusesAChannelThatIsNotWhole) {
  SensorRecord sensor = record();
  sensor.channels[1].values.pop_back();
  EXPECT_THAT(refusal_of([&] { RecordedSamples samples(sensor); }), mentions({"sensor pad", "slow", "3 values", "2"}));
}

}  // namespace
}  // namespace slipbench::recorded_samples_test
