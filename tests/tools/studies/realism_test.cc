// The bench beside what is published of real recordings.

#include <cmath>

#include "tests/expect.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce::realism_test {
namespace {

// Bars of the published protocol: the memory that learnt from the recordings is right in 87, 90 and 78 % of the frames here,
// and the forces of pillars 1 to 8 are .034 N rms from theirs at most.
TEST(Realism, HexapodIsAsNearToTheRecordingsAsItWasMade) {
  ReproduceOptions options;
  options.only = {"hexapod"};
  const Json figures = realism_table(options).figures;
  EXPECT_GE(figures.at(0).at("ours"), 87.0);
  EXPECT_GE(figures.at(1).at("ours"), 90.0);
  EXPECT_GE(figures.at(2).at("ours"), 78.0);
  double square = 0.0;
  for (std::size_t pillar = 1; pillar <= 8; ++pillar) {
    const Json& force = figures.at(2 + pillar);
    square += std::pow(force.at("ours").get<double>() - force.at("real").get<double>(), 2) / 8.0;
  }
  EXPECT_LE(std::sqrt(square), 0.034);
}

}  // namespace
}  // namespace slipbench::reproduce::realism_test
