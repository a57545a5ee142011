// A simulated trial through `export` and `import`: the numbers are the same to the bit.
#include <gtest/gtest.h>

#include "tests/tools/program/import/sources.h"
#include "tools/base/dataset/reader.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/export/export.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench::round_trip_test {
namespace {

// Pressed, slid and turned; 60 ms of sliding at 16 mm/s let all nine pillars go.
struct RoundTrip : slipbench::testing::ImportTest {
  void SetUp() override {
    SweepOptions options;
    options.scene_path = SLIPBENCH_SOURCE_DIR "/scenes/papillarray/stage.yaml";
    options.overrides = {{"duration", "1.3 s"}, {"motion.start", "1 s"}, {"motion.speed", "16 mm/s"}};
    options.output = path("made.h5");
    options.limit = 1;
    run_sweep(options, program_catalogues(), {});
  }
  // Exports with the flags of the strict rule and imports again.
  void around(ExportFormat format, const std::string& import_format) {
    ExportOptions options;
    options.format = format;
    export_dataset(path("made.h5"), path("csv"), options);
    run({path("csv")}, import_format);
  }
  [[nodiscard]] SensorRecord pad(const std::string& name) const { return DatasetReader(path(name)).read_sensor(0, "pad"); }

  void expect_same() const {
    const SensorRecord made = pad("made.h5"), back = pad("out.h5");
    EXPECT_EQ(back.type, made.type);
    EXPECT_EQ(back.rate, made.rate);
    EXPECT_EQ(back.time, made.time);
    EXPECT_EQ(back.channel_names, made.channel_names);
    ASSERT_EQ(back.channels.size(), made.channels.size());
    for (std::size_t c = 0; c < made.channels.size(); ++c) {
      EXPECT_EQ(back.channels[c].name, made.channels[c].name);
      EXPECT_EQ(back.channels[c].unit, made.channels[c].unit);
      EXPECT_EQ(back.channels[c].shape, made.channels[c].shape);
      EXPECT_EQ(back.channels[c].values, made.channels[c].values) << made.channels[c].name;
    }
    // The strict rule's flags give the strict rule's states.
    EXPECT_EQ(back.labels.state_paper, made.labels.state);
    EXPECT_EQ(std::ranges::count(made.labels.state, 0) > 0, true);
    EXPECT_EQ(std::ranges::count(made.labels.state, 3) > 0, true);
  }
};

TEST_F(RoundTrip, OfTheVendorsLog) {
  around(ExportFormat::vendor_csv, "papillarray-csv");
  expect_same();
}

TEST_F(RoundTrip, OfTheTrainingFiles) {
  around(ExportFormat::training_csv, "training-csv");
  expect_same();
}

}  // namespace
}  // namespace slipbench::round_trip_test
