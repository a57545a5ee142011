#include "sensors/nib_pad/nib_pad.h"

#include <array>
#include <cassert>
#include <utility>

#include "sensors/electronics/pad_sensor.h"
#include "sim/api/sensor.h"
#include "sim/core/error.h"
#include "sim/core/random.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {
namespace nib_pad {
namespace {

constexpr Range some_length = positive_up_to(0.1);

// Counts at 13 bit; assumed, as no figure is published for this device.
constexpr double si_noise = 1.5, cluster_noise = 1.2;
constexpr double offset = 20.0;
constexpr double drift = 0.02;  // counts/s
constexpr double gain = 0.05;   // of one electrode

// Position of a taxel relative to the middle one: -1, 0 or 1 to the east and to the north.
struct Place {
  int east, north;
};
Place place_of(std::size_t taxel) { return {static_cast<int>(taxel % 3) - 1, 1 - static_cast<int>(taxel / 3)}; }

// True if a turn about the pad's middle (`turn` = 1: counter-clockwise, -1: clockwise) drags a
// taxel towards its electrode on `side`. The turn's velocity there is (-north, east).
bool is_ahead(std::size_t taxel, Side side, int turn) {
  const Place place = place_of(taxel);
  switch (side) {
    case Side::west: return turn * place.north > 0;
    case Side::north: return turn * place.east > 0;
    case Side::east: return turn * place.north < 0;
    case Side::south: return turn * place.east < 0;
  }
  return false;
}

bool connects(std::size_t v, std::size_t taxel, Side side) {
  if (v < si_size) return v == sides * taxel + static_cast<std::size_t>(side);
  if (v < fr_first) return side == (v == fl_first ? Side::north : Side::south);
  return is_ahead(taxel, side, v == fr_first ? 1 : -1);
}

}  // namespace

Entry about() {
  return {
      .name = "nib_pad",
      .summary = "Capacitive nib pad: 6x6 silicone nibs, 9 taxels of four electrodes, clusters for fast shear and torsion.",
      .law =
          "C = C0 g0/(g0 - u - r t), per nib and electrode;  u = min(f_n/k_post, g0 - gf);  t = q/L towards the electrode,\n"
          "|t| <= (g0 - u - gf)/R: at this limit the fabric's rim touches the mask and cannot tilt further\n"
          "f_n: normal force of the nib; q: deflection of its tip; r: electrode_place; R: fabric_radius; gf: mask_gap\n"
          "si = C of a taxel's four nibs on one side; fl, fr = C of a cluster; fl: N and S of all taxels; fr: the tangential electrodes\n"
          "of the eight outer taxels, counter-clockwise about +Z first\n"
          "counts = round(rest + gain sum(C - C0)), limited by the converter to 0 to full scale\n"
          "a sample: fl N, fl S, fr +, fr -, then W, N, E, S of one taxel, each 1/8 of the sampling time after the one before\n"
          "Nine samples make an image of si; si is averaged over the last images.",
      .source =
          "\"Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation\", IEEE RA-L 2020: geometry, electrodes, scan, bits. Stiffness and capacitance follow from the geometry (README)",
      .parameters = {
          number_spec("rate", Quantity::frequency, "300 Hz", positive, "Sampling rate; an image of si takes nine samples.",
                      "the paper: 300 Hz for fl and fr, 33.3 Hz for si"),
          choice_spec(
              "scan", "multiplexed", {"multiplexed", "simultaneous"},
              "multiplexed: the eight readings of a sample follow one another; simultaneous: all readings of a sample and of an image of si are taken at one instant.",
              "multiplexed: the paper's figure 5; simultaneous: to study the effect of the skew"),
          integer_spec("average", "5", {1.0, 100.0},
                       "Number of images over which si is averaged (fewer at the start); 1: no averaging.",
                       "the paper: moving average of 5"),
          number_spec(
              "k_normal", Quantity::stiffness, "0.83 N/mm", positive, "Normal stiffness of a nib.",
              "post, nib and rounded tip in series, with 1.15 MPa of Shore A 30. The hardness is assumed: the paper does not name the type of TAP's RTV"),
          number_spec(
              "k_tangential", Quantity::stiffness, "0.2 N/mm", positive, "Tangential stiffness of a nib's tip without load.",
              "assumed: 0.1 to 0.4 are possible. The paper's 3.5 N of shear needs more than the post alone (0.03) and the fabric's strips (0.1) carry"),
          number_spec("height_sd", Quantity::length, "0.03 mm", {0.0, 1e-3},
                      "Standard deviation of the nibs' heights, normally distributed, drawn once for the device.",
                      "assumed: the mould is printed in layers of 0.028 mm"),
          number_spec("post", Quantity::stiffness, "10.4 N/mm", positive,
                      "Stiffness of the post below the fabric, which determines the gap under load.",
                      "the paper's 1 mm x 0.254 mm, bonded on both sides: E (1 + 2 S^2) A/h, S = 0.98, 1.15 MPa"),
          number_spec("lever", Quantity::length, "3.65 mm", some_length, "Distance from the hinge below the fabric to the tip.",
                      "the paper: nib of 3.4 mm on a gap of 0.254 mm"),
          number_spec("fabric_radius", Quantity::length, "1.4 mm", some_length, "Radius of the fabric that tilts with its nib.",
                      "the paper: nibs of 2.8 mm. Assumed: the fabric is stiff only below the nib"),
          number_spec("electrode_place", Quantity::length, "1.1 mm", some_length,
                      "Distance from the nib's axis to the middle of an electrode.",
                      "assumed: between the post and the nib's rim"),
          number_spec("gap", Quantity::length, "0.254 mm", some_length, "Gap from the fabric to the electrodes without load.",
                      "the paper: thickness of the mask that shapes the posts"),
          number_spec("mask_gap", Quantity::length, "0.03 mm", some_length,
                      "Gap that the solder mask and the silicone coat leave when the fabric lies on them.", "assumed"),
          number_spec("capacitance", Quantity::none, "0.045", positive, "C0 of one electrode of one nib, in pF.",
                      "assumed: 1.3 mm2 over 0.254 mm of air"),
          choice_spec(
              "capacitor", "gap", {"gap", "linear"},
              "gap: capacitance is proportional to 1/gap; linear: the tangent to this curve without load, for comparison.",
              "gap: a plate capacitor"),
          number_spec(
              "gain", Quantity::none, "850", positive, "Counts per pF of si, at 13 bit.",
              "assumed: 6960 counts at 8.2 pF, most of it in the wiring. A taxel with the fabric of all four nibs flat on the mask then reads just below full scale"),
          number_spec("cluster_gain", Quantity::none, "300", positive, "Counts per pF of fl and fr, at 13 bit.",
                      "assumed: at the paper's strongest linear grip, 8 N, fl then stays just below full scale at any pull"),
          integer_spec("bits", "13", {4.0, 16.0}, "Resolution of the converter.", "the paper"),
          number_spec("rest", Quantity::none, "85 %", {0.0, 1.0}, "Reading of an untouched pad, as a share of full scale.",
                      "the maker's tuning guide (Infineon, PSoC 4 CapSense): calibrated to 85 %, 6962 of 8191"),
          choice_spec("device", "fixed", {"fixed", "redrawn"},
                      "fixed: all trials of a dataset use one device; redrawn: each trial draws its own heights and gains.",
                      "fixed: the paper has two pads and calibrates one"),
          number_spec("label_distance", Quantity::length, "2 mm", positive,
                      "Displacement of the object over a nib (lean of the nib plus slip) above which the paper's rule says slip.",
                      "the paper, section IV-B: its criterion is a pull displacement of about 2 mm"),
      }};
}

SensorView view() {
  std::vector<std::vector<std::size_t>> nibs_of(taxels);
  for (std::size_t nib = 0; nib < nibs; ++nib) nibs_of[taxel_of(nib)].push_back(nib);
  // Differences: north minus south electrodes, one sense of rotation minus the other (the paper,
  // section II).
  return {.unit = "nib",
          .units = "nibs",
          .letter = "N",
          .from_behind = true,
          .orientation = "so that east is right and north is up",
          .channels = {{.channel = "fl",
                        .name = "FL: clusters N and S",
                        .note = "all nine north electrodes and all nine south electrodes together, 300 Hz",
                        .difference = "FL",
                        .spectrum = SpectrumView{"FL, north minus south", 0.5, 0.1, 20.0},
                        .unit = "counts"},
                       {.channel = "fr",
                        .name = "FR: clusters + and −",
                        .note = "tangential electrodes of the eight outer taxels, counter-clockwise and clockwise, 300 Hz",
                        .difference = "FR",
                        .spectrum = SpectrumView{"FR, counter-clockwise minus clockwise", 0.5, 0.1, 20.0},
                        .unit = "counts"},
                       {.channel = "si",
                        .name = "SI: electrodes of one taxel",
                        .note = "one image is read within nine samples",
                        .unit = "counts"}},
          .picture = PadPicture{.channel = "si",
                                .cells = std::move(nibs_of),
                                .width = 1.88,
                                .note = "Four electrodes behind each taxel: increase of SI over its first image."}};
}

SignalModel signal_model(double rate, double count) {
  SignalModel model;
  model.rate = rate;
  model.sources = value_count;
  for (std::size_t v = 0; v < value_count; ++v) {
    model.source.push_back(v);
    model.noise_sd.push_back(count * (v < si_size ? si_noise : cluster_noise));
    model.offset_sd.push_back(count * offset);
    model.drift_sd.push_back(count * drift);
    // A cluster is the sum of 9 or 12 such electrodes, whose gains are drawn independently.
    model.gain_sd.push_back(v < fl_first ? gain : gain / std::sqrt(v < fr_first ? 9.0 : 12.0));
  }
  return model;
}

std::vector<Entry> electronics_parts() {
  return electronics_of(
      "nib pad",
      {{"gain", "assumed: 5 % of what is above rest, from electrode to electrode, as gaps and areas are made"},
       {"offset",
        "assumed: 20 counts of 13 bit, about a third of a step of the 7-bit current source that calibrates the reading at rest"},
       {"drift", "assumed: 0.02 counts/s of 13 bit, 3 ppm/s of the reading at rest, by temperature"},
       {"noise",
        "assumed: 1.5 counts of 13 bit for si, 1.2 for clusters. The maker calls less than 10 counts quiet (Infineon's tuning guide); another capacitive fingertip has 0.8 to 1.3 counts (FabricSlide)",
        {{"corner", "inf", "a converter's noise is white: each reading integrates anew"}}}});
}

std::size_t taxel_of(std::size_t nib) { return 3 * (nib / rows / 2) + nib % rows / 2; }

std::vector<Electrode> electrodes_of(std::size_t v) {
  std::vector<Electrode> electrodes;
  for (std::size_t nib = 0; nib < nibs; ++nib) {
    for (const Side side : {Side::west, Side::north, Side::east, Side::south}) {
      if (connects(v, taxel_of(nib), side)) electrodes.push_back({nib, side});
    }
  }
  return electrodes;
}

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
    throw SceneValueError("sensors." + sensor_name + ".mask_gap", readable_quantity(mask_gap, Quantity::length) +
                                                                      " must be less than the gap of " +
                                                                      readable_quantity(gap, Quantity::length));
  }
  // When its rim touches the mask, the tilted fabric is r/R (g0 - gf) lower over an electrode at r.
  // It must not touch the electrode there.
  const double place = parameters.number("electrode_place"), radius = parameters.number("fabric_radius");
  if (const double farthest = radius * gap / (gap - mask_gap); place >= farthest) {
    throw SceneValueError("sensors." + sensor_name + ".electrode_place",
                          readable_quantity(place, Quantity::length) +
                              " would let the tilted fabric touch the electrode; allowed: less than " +
                              readable_quantity(farthest, Quantity::length));
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
  // Mean ages: of the readings of an image, which ends at the frame's time, and of a cluster's two.
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
    // Before its first reading a value is that of an untouched pad.
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
    return pad_state(touching, displaced);
  }

 private:
  // memory_ carries from one reading to the next: the counters, the signals read in this sample,
  // the values its frame shows, and the last `average_` readings of each value of si.
  enum Counter : std::size_t { next_scan, next_taxel, images, counters };
  [[nodiscard]] std::span<double> signals() { return std::span(memory_).subspan(counters, value_count); }
  [[nodiscard]] std::span<double> values() { return std::span(memory_).subspan(counters + value_count, value_count); }
  [[nodiscard]] std::span<double> readings(std::size_t v) {
    return std::span(memory_).subspan(counters + 2 * value_count + v * average_, average_);
  }
  [[nodiscard]] std::size_t taxel() const { return static_cast<std::size_t>(memory_[next_taxel]); }

  // Counts of this converter per count of a 13-bit one.
  [[nodiscard]] double per_count() const { return (top_ + 1.0) / 8192.0; }

  // Stores the nibs' share of value v, in counts above the reading without load.
  void read(const ContactFrame& truth, std::size_t v) {
    double change = 0.0;
    for (const Electrode& electrode : electrodes_[v]) {
      const auto nib = static_cast<Eigen::Index>(electrode.nib);
      const double force = truth.force(2, nib), qx = truth.displacement(0, nib), qy = truth.displacement(1, nib);
      // Most nibs are unloaded and change nothing.
      if (force != 0.0 || qx != 0.0 || qy != 0.0) change += capacitor_.change(force, qx, qy, electrode.side);
    }
    signals()[v] = gain_[v] * change;
  }

  // Returns the converter's counts for a signal, rounded and clipped to 0 to full scale.
  double converted(float signal) {
    const double counts = std::round(rest_ + signal);
    const double held = std::clamp(counts, 0.0, top_);
    beyond_ |= held != counts;
    return held;
  }

  // Ends a sample: applies the electronics, converts to counts, averages si.
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
  double rest_;  // counts, of an untouched pad
  NibCapacitor capacitor_;
  Electronics electronics_;
  std::vector<double> memory_;
  std::array<std::vector<Electrode>, value_count> electrodes_;
  std::array<double, value_count> gain_{};  // counts/pF
  std::array<float, value_count> reported_{};
  bool beyond_ = false;  // a value of this sample is beyond the converter's range
  std::uint64_t saturated_ = 0;
};

}  // namespace

}  // namespace nib_pad

SensorKind nib_pad_sensor() {
  using namespace nib_pad;
  return {.about = about(), .electronics = electronics_parts(), .create = created<NibPad>, .view = view()};
}

}  // namespace slipbench
