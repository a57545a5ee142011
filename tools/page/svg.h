// Draws SVG, mark by mark.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slipbench::page {

// Values along a line of a drawing, from `begin` to `end` [px].
struct Axis {
  double low = 0.0, high = 1.0;    // values at the ends
  double begin = 0.0, end = 0.0;   // px
  bool logarithmic = false;        // both ends above 0
  std::vector<double> ticks = {};  // from `low` to `high`

  // Position of `value` [px].
  [[nodiscard]] double at(double value) const;
};

// The shortest axis of whole multiples of `step` that contains all `values`; at least one step. If it
// would have more than 1000 ticks, or multiples that doubles cannot tell apart, it ends at the
// smallest and the largest value and has ticks there alone.
Axis linear_axis(std::span<const double> values, double step, double begin, double end);
// The shortest axis of whole decades that begins below all `values` (all > 0) and ends at or above
// them; at least one decade.
Axis decade_axis(std::span<const double> values, double begin, double end);

// Smallest 1, 2 or 5 times a power of ten that divides `range` into at most `times` parts.
double round_step(double range, double times);
// The shortest axis with steps of round_step() that contains all `values`.
Axis round_axis(std::span<const double> values, double times, double begin, double end);

// Number of series colours in web/theme.css.
inline constexpr std::size_t series_count = 8;

// A drawing of a given size [px]. Coordinates are from its upper left corner, rounded to 0.1 px.
// `kind`: classes of web/drawing.css: a series "s0" to "s7", "mesh", "limit", the levels "level0"
// (bad) to "level3" (good) of a bar; for a text "name" and "small", and the anchors "middle" and
// "end".
class Svg {
 public:
  Svg(double width, double height);

  void line(std::string_view kind, double x1, double y1, double x2, double y2);
  void polyline(std::string_view kind, std::span<const std::array<double, 2>> points);
  void dot(std::string_view kind, double x, double y, double radius);
  void bar(std::string_view kind, double x, double y, double width, double height);
  void text(std::string_view kind, double x, double y, std::string_view text);
  void text_upwards(std::string_view kind, double x, double y, std::string_view text);

  // The drawing as an element for compose_page(). `title`: description for screen readers.
  [[nodiscard]] std::string element(std::string_view title) const;
  // The drawing as a separate file with its colours, for light and dark pages.
  [[nodiscard]] std::string file(std::string_view title) const;

 private:
  double width_, height_;
  std::string marks_;
};

// Position of a chart's axes in its drawing [px].
struct Frame {
  double width, height, left, right, top, foot;
};

// An empty chart with its axes. A name may be empty.
Svg chart(const Frame& frame, const std::string& title, const Axis& across, const std::string& across_name, const Axis& up,
          const std::string& up_name = "");

}  // namespace slipbench::page
