#include "tools/page/svg.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/expect.h"
#include "tests/tools/page/web_files.h"

namespace slipbench::page {
namespace {

using Values = std::vector<double>;

TEST(LinearAxis, HoldsItsValuesInWholeSteps) {
  const Axis axis = linear_axis(Values{0.91, 0.99}, 0.05, 286.0, 14.0);
  EXPECT_THAT(axis.ticks, ElementsAre(DoubleNear(0.9, 1e-12), DoubleNear(0.95, 1e-12), DoubleNear(1.0, 1e-12)));
  EXPECT_NEAR(axis.at(0.9), 286.0, 1e-9);
  EXPECT_NEAR(axis.at(0.95), 150.0, 1e-9);
  EXPECT_THAT(linear_axis(Values{2.0}, 0.5, 0.0, 1.0).ticks, ElementsAre(2.0, 2.5));  // at least one step
}

TEST(DecadeAxis, BeginsBelowItsValues) {
  const Axis axis = decade_axis(Values{20.0, 300.0}, 0.0, 200.0);
  EXPECT_THAT(axis.ticks, ElementsAre(10.0, 100.0, 1000.0));
  EXPECT_NEAR(axis.at(100.0), 100.0, 1e-9);
  EXPECT_NEAR(axis.at(20.0), 100.0 * std::log10(2.0), 1e-9);
  // A power of ten ends an axis but does not begin it: its bar would have no length.
  EXPECT_THAT(decade_axis(Values{10.0}, 0.0, 1.0).ticks, ElementsAre(1.0, 10.0));
}

// Multiples of 1 are not all doubles beyond 2^53 = 9.007e15: a constant of 1.7e18, the nanoseconds
// of a clock, shares its axis with zero.
TEST(LinearAxis, EndsAtAConstantBeyondWholeNumbers) {
  const Axis axis = round_axis(Values{1.7e18, 1.7e18}, 4.0, 0.0, 100.0);
  EXPECT_THAT(axis.ticks, ElementsAre(0.0, 1.7e18));
  EXPECT_NEAR(axis.at(1.7e18), 100.0, 1e-9);
}

// Checks that an axis of two values keeps its promises: few ticks, in ascending order, within ends that
// contain both values, which have a place between the ends.
void expect_axis(const Axis& axis, double least, double most) {
  ASSERT_LE(axis.ticks.size(), 1001u);
  ASSERT_GE(axis.ticks.size(), 2u);
  for (std::size_t k = 1; k < axis.ticks.size(); ++k) EXPECT_LT(axis.ticks[k - 1], axis.ticks[k]);
  EXPECT_LE(axis.low, axis.ticks.front());
  EXPECT_GE(axis.high, axis.ticks.back());
  EXPECT_LE(axis.low, least);
  EXPECT_GE(axis.high, most);
  constexpr double rounding = 1e-6;  // px
  for (const double value : {least, most}) {
    const double place = axis.at(value);
    EXPECT_TRUE(place >= -rounding && place <= 100.0 + rounding) << place;
  }
}

TEST(Axis, IsFiniteForAnyTwoDoubles) {
  Values values{0.0, 0.1, 1.0, 1e6, 9e15, 9007199254740993.0, 1.7e18, 1e-300, 1e300, 1.7e308};
  for (const double extreme : {std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::min(),
                               std::numeric_limits<double>::max(), std::numeric_limits<double>::epsilon()}) {
    values.push_back(extreme);
  }
  std::mt19937_64 random(1);
  while (values.size() < 100) {  // any bits: all exponents are equally frequent
    const double value = std::bit_cast<double>(random());
    if (std::isfinite(value)) values.push_back(value);
  }
  for (std::size_t k = values.size(); k-- > 0;) {
    for (const double near : {-values[k], std::nextafter(values[k], 0.0), values[k] * (1.0 + 1e-8)}) {
      if (std::isfinite(near)) values.push_back(near);
    }
  }
  for (const double a : values) {
    for (const double b : values) {
      const auto [least, most] = std::minmax(a, b);
      SCOPED_TRACE(::testing::Message() << least << " to " << most);
      expect_axis(round_axis(Values{least, most}, 4.0, 0.0, 100.0), least, most);
      expect_axis(linear_axis(Values{least, most}, 0.5, 0.0, 100.0), least, most);
      if (least > 0.0) expect_axis(decade_axis(Values{least, most}, 0.0, 100.0), least, most);
      if (HasFailure()) return;
    }
  }
}

TEST(Svg, WritesMarksAndEscapesTexts) {
  Svg svg(100.0, 50.5);
  svg.line("mesh", 1.0, 2.04, 3.06, 4.0);
  svg.polyline("s0", std::vector<std::array<double, 2>>{{1.0, 2.0}, {3.25, 4.0}});
  svg.dot("s1", 5.0, 6.0, 3.5);
  svg.bar("s2", 7.0, 8.0, 9.0, 10.0);
  svg.text("name", 1.0, 2.0, "a < b");
  svg.text_upwards("middle", 1.0, 2.0, "up");
  EXPECT_EQ(svg.element("a \"b\""),
            "<svg class=\"drawing\" width=\"100\" height=\"50.5\" role=\"img\" aria-label=\"a &quot;b&quot;\">\n"
            "<line class=\"mesh\" x1=\"1\" y1=\"2\" x2=\"3.1\" y2=\"4\"/>\n"
            "<polyline class=\"s0\" points=\"1,2 3.3,4\"/>\n"
            "<circle class=\"s1\" cx=\"5\" cy=\"6\" r=\"3.5\"/>\n"
            "<rect class=\"bar s2\" x=\"7\" y=\"8\" width=\"9\" height=\"10\"/>\n"
            "<text class=\"name\" x=\"1\" y=\"2\">a &lt; b</text>\n"
            "<text class=\"middle\" transform=\"translate(1,2) rotate(-90)\">up</text>\n</svg>\n");
}

TEST(Svg, FilesHaveTheirColoursInThem) {
  const std::string file = Svg(10.0, 20.0).file("<title>");
  EXPECT_THAT(file, AllOf(HasSubstr("<title>&lt;title&gt;</title>"), HasSubstr("viewBox=\"0 0 10 20\""), HasSubstr("--s7:"),
                          HasSubstr("prefers-color-scheme: dark"), Not(HasSubstr("url("))));
}

TEST(Svg, ASeriesHasItsColour) {
  const auto styles = testing::web_files("tools/page/web", ".css");
  for (std::size_t k = 0; k < series_count; ++k) {
    const std::string name = "s" + std::to_string(k);
    EXPECT_THAT(styles.at("drawing.css"), HasSubstr("." + name + " { color: var(--" + name + "); }"));
  }
}

}  // namespace
}  // namespace slipbench::page
