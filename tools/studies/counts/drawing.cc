#include "tools/studies/counts/drawing.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace slipbench::counts {
namespace {

// In pixels.
constexpr int width = 760;
constexpr int top = 46;
constexpr int row = 24;
constexpr int bar_height = 14;
constexpr int names_end = 140;
constexpr int label_room = 52;
struct Span {
  int begin;
  int end;
};
constexpr Span counts_span{150, 440};
constexpr Span times_span{460, 745};

constexpr std::string_view style = R"(<style>
.page{fill:#fff}.text{fill:#1f2328;font:12px sans-serif}.small{fill:#59636e;font:10px sans-serif}.line{stroke:#d1d9e0}
.count{fill:#0969da}.time{fill:#1a7f37}
@media (prefers-color-scheme:dark){.page{fill:#0d1117}.text{fill:#f0f6fc}.small{fill:#9198a1}.line{stroke:#3d444d}
.count{fill:#4493f8}.time{fill:#3fb950}}
</style>
)";

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      default: out += c;
    }
  }
  return out;
}

// Three significant digits (two below 1), without an exponent: "3.04", "183", "4,610".
std::string short_number(double value) {
  if (value < 1.0) return fmt::format("{:.2g}", value);
  if (value < 999.5) return fmt::format("{:.3g}", value);
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  const std::string digits = fmt::format("{:.0f}", std::round(value / step) * step);
  std::string out;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) out += ',';
    out += digits[i];
  }
  return out;
}

// Bars of one kind of value beside each other's scene, on an axis of whole decades.
class Panel {
 public:
  Panel(std::vector<double> values, Span span, std::string title, std::string kind)
      : values_(std::move(values)), span_(span), title_(std::move(title)), kind_(std::move(kind)) {
    const auto [least, most] = std::ranges::minmax(values_);
    low_ = std::floor(std::log10(least));
    if (low_ == std::log10(least)) low_ -= 1.0;  // else the shortest bar has no length
    high_ = std::max(low_ + 1.0, std::ceil(std::log10(most)));
  }

  [[nodiscard]] std::string text() const {
    const int bottom = top + row * static_cast<int>(values_.size());
    std::string out = fmt::format("<text class=\"text\" x=\"{}\" y=\"20\">{}</text>\n", span_.begin, escaped(title_));
    for (double decade = low_; decade <= high_; decade += 1.0) {
      const double x = position(decade);
      out += fmt::format(
          "<path class=\"line\" d=\"M{:.1f} {}V{}\"/><text class=\"small\" x=\"{:.1f}\" y=\"38\" text-anchor=\"middle\">{}</text>\n",
          x, top - 4, bottom, x, short_number(std::pow(10.0, decade)));
    }
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const int y = top + row * static_cast<int>(i) + (row - bar_height) / 2;
      const double end = position(std::log10(values_[i]));
      out += fmt::format(
          "<rect class=\"{}\" x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\"/><text class=\"text\" x=\"{:.1f}\" y=\"{}\">{}</text>\n",
          kind_, span_.begin, y, end - span_.begin, bar_height, end + 5.0, y + 11, short_number(values_[i]));
    }
    return out;
  }

 private:
  [[nodiscard]] double position(double decade) const {
    return span_.begin + (span_.end - label_room - span_.begin) * (decade - low_) / (high_ - low_);
  }

  std::vector<double> values_;
  Span span_;
  std::string title_;
  std::string kind_;
  double low_;  // decades
  double high_;
};

std::string joined(const Facts& facts, std::initializer_list<std::string_view> names) {
  std::string out;
  for (const std::string_view name : names) {
    const auto found = std::ranges::find(facts, name, &Facts::value_type::first);
    if (found != facts.end()) out += (out.empty() ? "" : ", ") + found->second;
  }
  return out;
}

}  // namespace

std::string drawing(const Results& results) {
  std::vector<double> counts;
  std::vector<double> times;
  for (const SceneCount& scene : results.scenes) {
    counts.push_back(scene.instructions_per_second() * 1e-6);
    times.push_back(scene.times_real_time());
  }
  const int bottom = top + row * static_cast<int>(results.scenes.size());
  const int height = bottom + 44;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\">\n"
      "<title>What the reference scenes cost</title>\n{2}<rect class=\"page\" width=\"{0}\" height=\"{1}\" rx=\"6\"/>\n",
      width, height, style);
  for (std::size_t i = 0; i < results.scenes.size(); ++i) {
    out += fmt::format("<text class=\"text\" x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", names_end,
                       top + row * static_cast<int>(i) + 16, escaped(scene_name(results.scenes[i].scene)));
  }
  out += Panel(std::move(counts), counts_span, "million instructions per simulated second", "count").text();
  out += Panel(std::move(times), times_span, "times real time, one core", "time").text();
  out += fmt::format("<text class=\"small\" x=\"14\" y=\"{}\">{}</text>\n", bottom + 18,
                     escaped(joined(results.build, {"compiler", "flags", "sources", "instruction set"})));
  out += fmt::format("<text class=\"small\" x=\"14\" y=\"{}\">{}</text>\n</svg>\n", bottom + 33,
                     escaped(joined(results.context, {"processor", "system", "commit"})));
  return out;
}

}  // namespace slipbench::counts
