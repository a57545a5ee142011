#include "tools/bench/drawing.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/bench/sample.h"

namespace slipbench::bench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// 1,000 instructions in 4 s are 0.00025 million a second: an axis from 1e-4 to 1e-3, log10(2.5) = 0.398 of its 238 pixels. 8 times real time:
// from 1 to 10, log10(8) = 0.903 of 233.
TEST(BenchDrawing, BarsAsLongAsTheirLogarithms) {
  const std::string svg = drawing(sample_results());
  EXPECT_THAT(svg, HasSubstr("<rect class=\"count\" x=\"150\" y=\"51\" width=\"94.7\""));
  EXPECT_THAT(svg, HasSubstr("<rect class=\"time\" x=\"460\" y=\"51\" width=\"210.4\""));
  EXPECT_THAT(svg, HasSubstr(">0.00025</text>"));
  EXPECT_THAT(svg, HasSubstr(">8</text>"));
  EXPECT_THAT(svg, HasSubstr(">papillarray/stage</text>"));
}

TEST(BenchDrawing, TextIsEscapedAndBuildAndMachineAreThere) {
  const std::string svg = drawing(sample_results());
  EXPECT_THAT(svg, HasSubstr("GNU 12.2.0, x86_64 with AVX2"));
  EXPECT_THAT(svg, HasSubstr("A &lt;fast&gt; one &amp; two, 0123456789ab"));
  EXPECT_THAT(svg, Not(HasSubstr("<fast>")));
}

TEST(BenchDrawing, ABarOfAPowerOfTenHasALength) {
  Results results = sample_results();
  results.scenes[0].cpu_time = 0.4;  // 10 times real time
  EXPECT_THAT(drawing(results), HasSubstr("<rect class=\"time\" x=\"460\" y=\"51\" width=\"233.0\""));
}

}  // namespace
}  // namespace slipbench::bench
