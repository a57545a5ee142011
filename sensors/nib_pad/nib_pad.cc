#include "sensors/nib_pad/nib_pad.h"

#include <array>
#include <cassert>
#include <utility>

#include "sensors/electronics/pad_sensor.h"
#include "sim/core/error.h"
#include "sim/core/random.h"
#include "sim/core/sensor.h"

namespace slipbench {
namespace nib_pad {
namespace {

constexpr std::size_t cluster_scans = 4;  // of a sample, before those of its taxel
constexpr std::size_t sample_scans = cluster_scans + sides;

PadLayout make_layout(const Parameters& parameters, RandomStream stream) {
  PadLayout layout;
  for (std::size_t nib = 0; nib < nibs; ++nib) {
    const double taller = parameters.number("height_sd") * stream.normal();
    const std::size_t column = nib % rows, row = nib / rows;
    layout.units.push_back({nib, 1});
    layout.elements.push_back(
        {.tip = {(static_cast<double>(column) - 2.5) * pitch, (2.5 - static_cast<double>(row)) * pitch, -taller},
         .k_normal = parameters.number("k_normal"),
         .k_tangential = parameters.number("k_tangential")});
  }
  return layout;
}

NibCapacitor make_capacitor(const Parameters& parameters, const std::string& sensor_name) {
  const double gap = parameters.number("gap"), mask_gap = parameters.number("mask_gap");
  if (mask_gap >= gap) {
    throw SceneValueError("sensors." + sensor_name + ".mask_gap",
                          format_quantity(mask_gap, Quantity::length) + " leaves no room below a gap of " +
                              format_quantity(gap, Quantity::length) + "; allowed: less than that");
  }
  // Tilted until its rim rests on the mask, the fabric is r/R (g0 - gf) lower over an electrode at r: it must not come to lie on it.
  const double place = parameters.number("electrode_place"), radius = parameters.number("fabric_radius");
  if (const double farthest = radius * gap / (gap - mask_gap); place >= farthest) {
    throw SceneValueError("sensors." + sensor_name + ".electrode_place",
                          format_quantity(place, Quantity::length) +
                              " lets the tilted fabric touch the electrode; allowed: less than " +
                              format_quantity(farthest, Quantity::length));
  }
  return {.rest = parameters.number("capacitance"),
          .gap = gap,
          .mask_gap = mask_gap,
          .post = parameters.number("post"),
          .lever = parameters.number("lever"),
          .fabric_radius = radius,
          .place = place,
          .linear = parameters.choice("capacitor") == "linear"};
}

std::vector<Channel> make_channels(double rate, bool multiplexed) {
  std::vector<std::string> si;
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    for (const char* side : {"W", "N", "E", "S"}) si.push_back("T" + std::to_string(taxel) + "_" + side);
  }
  std::vector<Channel> channels{{"si", "counts", {taxels, sides}, std::move(si)},
                                {"fl", "counts", {2}, {"FL_N", "FL_S"}},
                                {"fr", "counts", {2}, {"FR_+", "FR_-"}}};
  channels[0].every = taxels;
  if (!multiplexed) return channels;
  const double scan = 1.0 / (rate * static_cast<double>(sample_scans));  // s, from one reading to the next
  // Means over the readings of an image, which ends with the frame's time, and over the two of a cluster.
  channels[0].age = 0.5 * static_cast<double>(taxels - 1) / rate + 0.5 * static_cast<double>(sides - 1) * scan;
  channels[1].age = (static_cast<double>(sample_scans - 1) - 0.5) * scan;
  channels[2].age = (static_cast<double>(sample_scans - 3) - 0.5) * scan;
  return channels;
}

class NibPad final : public PadSensor {
 public:
  NibPad(const Parameters& parameters, const std::vector<Named>& electronics, const ElectronicsKey& key)
      : PadSensor(parameters.number("rate"),
                  make_layout(parameters, RandomStream(key.seed, key.device, "nib_pad." + key.sensor_name + ".height")),
                  make_channels(parameters.number("rate"), parameters.choice("scan") == "multiplexed")),
        multiplexed_(parameters.choice("scan") == "multiplexed"),
        average_(static_cast<std::size_t>(parameters.integer("average"))),
        label_distance_(parameters.number("label_distance")),
        top_(std::ldexp(1.0, static_cast<int>(parameters.integer("bits"))) - 1.0),
        rest_(parameters.number("rest") * top_),
        capacitor_(make_capacitor(parameters, key.sensor_name)),
        electronics_(electronics, signal_model(rate_, per_count()), key),
        memory_(counters + 2 * value_count + average_ * si_size) {
    for (std::size_t v = 0; v < value_count; ++v) {
      electrodes_[v] = electrodes_of(v);
      gain_[v] = per_count() * parameters.number(v < si_size ? "gain" : "cluster_gain");
    }
    // Until its first reading a value is that of a pad that nothing touches.
    for (double& value : values()) value = std::round(rest_);
    frame_.values = reported_;
  }

  [[nodiscard]] std::size_t scans() const override { return multiplexed_ ? sample_scans : 1; }

  const SensorFrame& measure(const ContactFrame& truth) override {
    assert(truth.force.cols() == Eigen::Index{nibs} && truth.displacement.cols() == Eigen::Index{nibs});
    if (multiplexed_) {
      const auto scan = static_cast<std::size_t>(memory_[next_scan]);
      read(truth, scan < cluster_scans ? fl_first + scan : sides * taxel() + scan - cluster_scans);
      memory_[next_scan] = static_cast<double>((scan + 1) % sample_scans);
    } else {
      for (std::size_t v = 0; v < value_count; ++v) read(truth, v);
    }
    if (memory_[next_scan] == 0.0) complete(truth.time);
    std::ranges::transform(values(), reported_.begin(), [](double value) { return static_cast<float>(value); });
    frame_.time = truth.time;
    return frame_;
  }

  [[nodiscard]] std::vector<std::span<double>> memory() override {
    std::vector<std::span<double>> memories = electronics_.memory();
    memories.emplace_back(memory_);
    return memories;
  }

  [[nodiscard]] std::uint64_t saturated() const override { return saturated_ + electronics_.saturated(); }

  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool /*rotating*/) const override {
    std::size_t touching = 0, displaced = 0;
    for (std::size_t nib = 0; nib < nibs; ++nib) {
      if (truth.unit_state[nib] == UnitState::detached) continue;
      ++touching;
      const auto column = static_cast<Eigen::Index>(nib);
      const double way = truth.slip_distance[column] + truth.displacement.col(column).head<2>().matrix().norm();
      if (way >= label_distance_) ++displaced;
    }
    if (touching == 0) return PadState::no_contact;
    if (displaced == 0) return PadState::non_slip;
    return displaced == touching ? PadState::gross : PadState::incipient;
  }

 private:
  // What is carried from one reading to the next, all in memory_: the counters, what this sample has read, what its frame shows, and of
  // each value of si the last `average_` readings.
  enum Counter : std::size_t { next_scan, next_taxel, images, counters };
  [[nodiscard]] std::span<double> signals() { return std::span(memory_).subspan(counters, value_count); }
  [[nodiscard]] std::span<double> values() { return std::span(memory_).subspan(counters + value_count, value_count); }
  [[nodiscard]] std::span<double> readings(std::size_t v) {
    return std::span(memory_).subspan(counters + 2 * value_count + v * average_, average_);
  }
  [[nodiscard]] std::size_t taxel() const { return static_cast<std::size_t>(memory_[next_taxel]); }

  // Counts of this converter to one of 13 bit.
  [[nodiscard]] double per_count() const { return (top_ + 1.0) / 8192.0; }

  // Of value v, in counts above rest, as far as it comes from the nibs.
  void read(const ContactFrame& truth, std::size_t v) {
    double change = 0.0;
    for (const Electrode& electrode : electrodes_[v]) {
      const auto nib = static_cast<Eigen::Index>(electrode.nib);
      change += capacitor_.change(truth.force(2, nib), truth.displacement(0, nib), truth.displacement(1, nib), electrode.side);
    }
    signals()[v] = gain_[v] * change;
  }

  // What the converter makes of a signal: whole counts between 0 and full scale, which it reports for all that is beyond.
  double converted(float signal) {
    const double counts = std::round(rest_ + signal);
    const double held = std::clamp(counts, 0.0, top_);
    beyond_ |= held != counts;
    return held;
  }

  // All readings of a sample are done: its electronics, its counts, the mean of si.
  void complete(double time) {
    std::array<float, value_count> disturbed{};
    std::ranges::transform(signals(), disturbed.begin(), [](double signal) { return static_cast<float>(signal); });
    electronics_.apply(disturbed, time);
    beyond_ = false;
    for (std::size_t v = fl_first; v < value_count; ++v) values()[v] = converted(disturbed[v]);

    const bool last = taxel() + 1 == taxels;
    const auto image = static_cast<std::size_t>(memory_[images]);
    const std::size_t first = multiplexed_ ? sides * taxel() : 0;
    const std::size_t end = multiplexed_ ? first + sides : last ? si_size : 0;
    for (std::size_t v = first; v < end; ++v) {
      const std::span<double> kept = readings(v);
      kept[image % average_] = converted(disturbed[v]);
      const std::span<double> read_so_far = kept.first(std::min(image + 1, average_));
      double sum = 0.0;
      for (const double reading : read_so_far) sum += reading;
      values()[v] = sum / static_cast<double>(read_so_far.size());
    }
    if (beyond_) ++saturated_;
    memory_[next_taxel] = last ? 0.0 : static_cast<double>(taxel() + 1);
    if (last) memory_[images] += 1.0;
  }

  bool multiplexed_;
  std::size_t average_;
  double label_distance_;
  double top_;   // counts, full scale
  double rest_;  // counts, of a pad that nothing touches
  NibCapacitor capacitor_;
  Electronics electronics_;
  std::vector<double> memory_;
  std::array<std::vector<Electrode>, value_count> electrodes_;
  std::array<double, value_count> gain_{};  // counts/pF
  std::array<float, value_count> reported_{};
  bool beyond_ = false;  // a value of this sample lies beyond the converter's range
  std::uint64_t saturated_ = 0;
};

}  // namespace
}  // namespace nib_pad

SensorKind nib_pad_sensor() {
  using namespace nib_pad;
  return {.about = about(), .electronics = electronics_parts(), .create = created<NibPad>, .view = view()};
}

}  // namespace slipbench
