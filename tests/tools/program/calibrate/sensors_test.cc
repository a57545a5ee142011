// Each of the five sensors, by one parameter of its own.
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tools/base/record/test_records.h"
#include "tools/program/calibrate/calibrate.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench::calibrate::sensors_test {
namespace {

struct Case {
  const char* type;
  const char* fit;
  const char* compressions;
};

// A foam has to be pressed far for more than noise.
class EachSensor : public slipbench::testing::FolderTest, public ::testing::WithParamInterface<Case> {};

// With the sensor's typical electronics, and a seed for the truth that is another device than that of the fit.
TEST_P(EachSensor, IsFitted) {
  const std::string scene = path("scene.yaml");
  std::ofstream(scene) << fmt::format(R"(slipbench: 1
duration: 1.6 s
time_step: auto
seed: 3
surface: {{material: acrylic}}
motion: {{kind: stage, compression: 0.6 mm, start: 0.9 s, speed: 3 mm/s}}
sensors:
  pad: {{type: {}, electronics: typical}}
sweep:
  motion.compression: [{}]
)",
                                      GetParam().type, GetParam().compressions);
  Options options;
  options.scene_path = scene;
  options.keys = parse_fit_keys(GetParam().fit);
  options.synthetic_truth = true;
  options.starts = 1;
  const Json result = calibrate(options, program_catalogues()).json;
  const Json& parameter = result.at("parameters").at(0);
  EXPECT_TRUE(parameter.at("determined").get<bool>());
  // The bar of stiffness: 3 %.
  EXPECT_NEAR(parameter.at("error").get<double>() / parameter.at("truth").get<double>(), 0.0, 0.03);
}

INSTANTIATE_TEST_SUITE_P(
    Sensors, EachSensor,
    ::testing::Values(Case{"papillarray", "sensors.pad.k_normal: {min: 3 N/mm, max: 12 N/mm}", "0.4 mm, 0.7 mm"},
                      Case{"nib_pad", "sensors.pad.post: {min: 5 N/mm, max: 20 N/mm}", "0.4 mm, 0.7 mm"},
                      Case{"piezo_skin", "sensors.pad.k_normal: {min: 10 N/mm, max: 40 N/mm}", "0.4 mm, 0.7 mm"},
                      Case{"myrmex", "sensors.pad.thickness: {min: 3 mm, max: 8 mm}", "1.5 mm, 2.5 mm"},
                      Case{"biotac_sp", "sensors.pad.gap: {min: 0.3 mm, max: 0.8 mm}", "0.4 mm, 0.7 mm"}),
    [](const auto& info) { return std::string(info.param.type); });

}  // namespace
}  // namespace slipbench::calibrate::sensors_test
