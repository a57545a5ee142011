#include "tools/page/svg.h"

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
