#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tools/program/report/report_parts.h"

namespace slipbench::report {
namespace {

TEST(PlainValue, TurnsTextWithAUnitIntoSi) {
  EXPECT_EQ(plain_value("motion.speed", "4 mm/s"), Json::parse(R"({"value": 0.004, "unit": "m/s"})"));
  EXPECT_EQ(plain_value("any.path", "2 s").at("unit"), "s");
}

TEST(PlainValue, TakesTheUnitOfABareNumberFromItsKey) {
  EXPECT_EQ(plain_value("motion.speed", 0.004), Json::parse(R"({"value": 0.004, "unit": "m/s"})"));
  EXPECT_EQ(plain_value("motion.compression", "0.001"), Json::parse(R"({"value": 0.001, "unit": "m"})"));
  EXPECT_EQ(plain_value("motion.tilt.0", 0.02).at("unit"), "rad");  // an index is no key
  EXPECT_EQ(plain_value("friction.static", 0.5).at("unit"), "");
  // Whatever the entries declare, wherever they stand.
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
  // The largest magnitude is that at 8 Hz: the sine's amplitude over two, times the sum of Hamming's window, 0.54 * 150, but for what the line takes
  // (a few percent). `step` is 1/32767 of it.
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

}  // namespace

}  // namespace slipbench::report
