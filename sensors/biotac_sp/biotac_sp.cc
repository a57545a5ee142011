#include "sensors/biotac_sp/biotac_sp.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>

#include "sensors/biotac_sp/skin.h"
#include "sensors/electronics/band_pass.h"
#include "sensors/electronics/electronics.h"
#include "sim/api/sensor.h"
#include "sim/core/error.h"
#include "sim/core/math.h"

namespace slipbench {
namespace biotac_sp {
Entry about() {
  const std::string recordings = "111 public recordings (yayaneath/BioTacSP-DoS)";
  constexpr Range some_length = positive_up_to(0.1);
  constexpr Range some_rate{1.0, 10e3};  // Hz; the converter of the device makes 4,400 readings per second
  return {
      .name = "biotac_sp",
      .summary = "BioTac SP fingertip: 24 electrodes under fluid and a curved skin, static pressure, vibration.",
      .law =
          "w_e = sum_i d_i (G_ei + S q_i.grad G_ei) - B mean d,  G = (1 - a) exp(-r^2/(2 l^2)) + a exp(-r/L)\n"
          "Z_e = Zrest_e exp(w_e/g) + Zc;  E_e = round(4095/(1 + Z_e/10 kOhm)), 0 to 4095: pressing lowers the counts\n"
          "d_i, q_i: depth of element i, and its drag along the surface; r: distance of element i from the skin over electrode e; mean: by area\n"
          "Each of G's two terms is scaled so that sum_i G_ei = 1 at the most sensitive electrode.\n"
          "p = K sum_i min(d_i, core_gap) A_i;  pdc = round(pdc_rest + p/36.5 Pa);  pac = round(2048 + band-pass(p)/0.37 Pa),\n"
          "of first order at 10 and 1040 Hz, exact for a pressure that is linear between readings\n"
          "skin: elements of stiffness k_normal A_i/A on half an ellipsoid, each along its own normal\n"
          "scan: each of cycle_rate cycles a second has two readings of pac and two slots of a round of 28: E1 to E24, PDC, TAC, TDC and\n"
          "one more. Values are held between readings and logged at `rate`.",
      .source =
          "BioTac SP product manual, sections 5 (divider, conversions, filters) and 9. Timing, levels and kernel: measured on and fitted to " +
          recordings + ". The rest is assumed, see each parameter",
      .parameters = {
          number_spec("rate", Quantity::frequency, "100 Hz", some_rate, "Sampling rate: rows of the log per second.",
                      "log of " + recordings),
          number_spec(
              "cycle_rate", Quantity::frequency, "1 kHz", some_rate,
              "Cycles per second, a whole multiple of `rate`. A cycle has two readings of pac and two slots of the round.",
              "Shadow hand's driver; this gives 20 slots per row, which agrees with " + recordings +
                  ": 5/7 of the electrodes change from row to row"),
          choice_spec("scan", "device", {"device", "ideal"},
                      "device: electrodes and pdc are read in turn and held; ideal: all are read for each row.",
                      "device: measured; ideal: to study the effect of the scan"),
          integer_spec(
              "elements", "300", {200.0, 4000.0},
              "Friction points of the skin: Fibonacci points, weighted by the area that each represents.",
              "a compromise of time and error (README): dents of 1 mm and more are within 1 % of a mesh four times finer; edges are not"),
          vector_spec(3, "radii", Quantity::length, "[13.85 mm, 10.1 mm, 9.85 mm]", some_length,
                      "Half axes of the ellipsoid whose lower half is the skin: along the finger, outwards, across.",
                      "bsadr/biotac, a finite element model of the SP: 13.85 x 10.1 x 9.74 to 9.99 mm"),
          number_spec(
              "k_normal", Quantity::stiffness, "37 N/mm", positive, "Stiffness of all elements together.",
              "assumed: 0.047 N/mm3 of 786 mm2; a plane then dents the skin by core_gap at 2 N, where the manual's pressure begins to saturate"),
          number_spec("shear", Quantity::none, "0.5", positive_up_to(2.0), "Tangential stiffness over the normal one.",
                      "assumed: 0.25 to 1 made no difference"),
          number_spec("near", Quantity::length, "3.5 mm", some_length, "l, width of the area that an electrode feels.",
                      "fitted: 3 to 4 mm; 1.5 and 5 mm do not fit"),
          number_spec("far", Quantity::length, "9 mm", some_length, "L, reach of the tail.", "fitted; 12 is worse"),
          number_spec("far_share", Quantity::none, "0.5", fraction, "a, share of the tail.", "fitted; 0 and 0.6 are worse"),
          number_spec(
              "swell", Quantity::none, "0.35", non_negative, "B, lift of the skin elsewhere by the displaced fluid.",
              "fitted to slides: 0.3 to 0.5; with 0 and 1 the correlations of far electrodes are wrong. Recordings of grasps fit 0.7 to 1"),
          number_spec("stretch", Quantity::none, "0.3", non_negative, "S, sensitivity to the drag of a dent along the surface.",
                      "assumed: 0 to 0.7 fit equally well; it must stay small"),
          number_spec("gap", Quantity::length, "0.52 mm", some_length,
                      "g, indentation that multiplies an electrode's impedance by e.", "fitted: 0.5 to 0.6 mm"),
          number_spec("common", Quantity::none, "0.1", non_negative, "Zc, impedance in series with all electrodes, in kOhm.",
                      "fitted: 0.1; one session of the recordings has 0.7 of unknown cause"),
          number_spec("core_gap", Quantity::length, "1 mm", some_length, "Depth at which the skin touches the core.",
                      "assumed: core to skin is 2.0 to 2.6 mm (bsadr/biotac); the skin itself is about half of that"),
          number_spec("fluid_stiffness", Quantity::none, "0.56", positive,
                      "K, pressure per displaced volume of fluid, in kPa/mm3.",
                      "assumed: at 2 N and core_gap the pressure is the force over the area of contact, 23.5 kPa for 42 mm3"),
          number_spec("pdc_rest", Quantity::none, "2600", {0.0, 4095.0}, "Counts of pdc of an untouched finger.",
                      "legacy BioTac at rest: 2580 to 2695"),
          choice_spec(
              "device", "fixed", {"fixed", "redrawn"},
              "fixed: all trials of a dataset use one device; redrawn: each draws its own sensitivities (electronics: gain).",
              "fixed: one finger made all the recordings"),
          integer_spec("device_number", "0", {0.0, 1e6},
                       "Number of the device; each number has different sensitivities. Only with device: fixed.",
                       "set for each scene"),
          number_spec("label_step", Quantity::length, "10 um", positive,
                      "Change of the bench's position between two rows above which the paper's rule says slip.",
                      "assumed: 1 mm/s at 100 Hz; the paper labels by the commanded motion of the robot"),
      }};
}

Entry about_19() {
  Entry entry = about();
  entry.name = "biotac_19";
  entry.summary = "BioTac fingertip of the older kind: 19 electrodes under fluid and a curved skin, static pressure, vibration.";
  const auto replace = [&](const std::string& text, const std::string& by) {
    const std::size_t at = entry.law.find(text);
    if (at == std::string::npos) throw std::logic_error("biotac_sp: its law has no '" + text + "'");
    entry.law.replace(at, text.size(), by);
  };
  replace("a round of 28: E1 to E24, PDC, TAC, TDC and\none more.", "a round of 22: E1 to E19, PDC, TAC and\nTDC.");
  entry.source =
      "positions of the electrodes: TAMS-Group/tams_biotac; order of readings: log of dexrob/BioTac_slide_20_50. Laws and kernel are those of the BioTac SP, assumed to be the same";
  const auto set = [&](const std::string& name, const std::string& text, const std::string& source) {
    const auto spec = std::ranges::find(entry.parameters, name, &ParameterSpec::name);
    if (spec == entry.parameters.end()) throw std::logic_error("biotac_sp: no parameter " + name);
    spec->default_text = text;
    spec->source = source;
  };
  set("rate", "100 Hz", "log of dexrob/BioTac_slide_20_50");
  set("cycle_rate", "1.1 kHz", "the same log: each row of 10 ms has 22 readings of pac and each electrode once");
  set("radii", own_radii_19,
      "outwards and across: skin of 7 mm radius above the electrodes (TAMS-Group/tams_biotac); along: fitted to that skin, a cylinder with a round end; error at most 1.4 mm above every electrode");
  set("k_normal", "27.8 N/mm", "assumed: the SP's 0.047 N/mm3 of 591 mm2 of skin");
  set("fluid_stiffness", "0.47",
      "assumed equal to the SP: at core_gap the pressure is the force over the area of contact, 2 pi 16 mm 1 mm");
  set("device", "fixed", "set for each scene");
  for (const char* name : {"near", "far", "far_share", "swell", "gap", "common"}) {
    const auto spec = std::ranges::find(entry.parameters, name, &ParameterSpec::name);
    if (spec == entry.parameters.end()) throw std::logic_error(std::string("biotac_sp: no parameter ") + name);
    spec->source = "assumed equal to the SP: " + spec->source;
  }
  return entry;
}

std::vector<Entry> electronics_parts_19() {
  const std::string as_sp = "assumed equal to the SP";
  return electronics_of(
      "BioTac of 19 electrodes",
      {{"gain", "10 % on each electrode's `gap`, " + as_sp, {}},
       {"offset", "on the logarithm of each electrode's impedance at rest, sd 0.02, " + as_sp, {}},
       {"drift", "1.5 counts/s, electrodes, " + as_sp, {}},
       {"skewed_noise", "electrodes: 1.25 counts, 20 public slides (dexrob/BioTac_slide_20_50); shape " + as_sp, {}},
       {"noise",
        "pac alone, 4.8 counts: a recording at rest has 4.5 to 5.1",
        {{"corner", "inf", "that recording is nearly white from 2 to 1100 Hz, with no line of the mains"}}}});
}

std::vector<Entry> electronics_parts() {
  const std::string recordings = "44 public recordings of a touch (yayaneath/BioTacSP-DoS)";
  return electronics_of(
      "BioTac SP",
      {{"gain",
        "10 % on each electrode's `gap`, which is in the exponent: assumed; this is how much the levels of electrodes differ",
        {}},
       {"offset",
        "on the logarithm of each electrode's impedance at rest, sd 0.02: assumed. A scale of 10 to 30 gives the hundreds of counts between fingers and sessions of public grasps (3dperceptionlab, bts3v2)",
        {}},
       {"drift", "1.5 counts/s, electrodes: " + recordings + ", median of the slope 1.7"},
       {"skewed_noise",
        "electrodes: 3.1 counts times the electrode's own noise over the mean of all, drawn at each reading: " + recordings},
       {"noise",
        "pac alone, 4.8 counts: a legacy BioTac at rest has 4.5 to 5.1. pdc has less than a count, no more than its rounding",
        {{"corner", "inf", "the legacy recording is nearly white from 2 to 1100 Hz, with no line of the mains"}}}});
}

namespace {

constexpr std::size_t slots_a_cycle = 2;                   // and as many readings of pac
constexpr double pdc_step = 0.0365e3, pac_step = 0.37;     // Pa a count: SP manual, section 5
constexpr double lowest_pac = 10.0, highest_pac = 1040.0;  // Hz: the same
constexpr double pac_middle = 2048.0;                      // counts, without vibration

// Constants of a finger that a scene cannot change.
struct Device {
  std::span<const Eigen::Vector3d> places;  // of the electrodes, m, in the device's own axes
  std::span<const double> rest;             // counts
  std::span<const double> relative_noise;   // of each electrode, relative to the mean of all
  double noise;                             // standard deviation of a reading of the mean electrode, counts
  std::size_t slots;                        // in a round: the electrodes, then pdc, then the slots that are not modelled
};

constexpr std::size_t slots_sp = 28;  // TAC, TDC and one more
constexpr std::size_t slots_19 = 22;  // TAC and TDC

const Device& sp() {
  static const Device device{electrode_places(), rest_readings(), relative_noise(), 3.1, slots_sp};
  return device;
}

const Device& nineteen() {
  static const std::vector<double> rest(electrodes_19, 3300.0), alike(electrodes_19, 1.0);
  static const Device device{electrode_places_19(), rest, alike, 1.25, slots_19};
  return device;
}

std::size_t cycles_a_sample(const Parameters& parameters, const std::string& sensor_name) {
  constexpr double rounding = 1e-9;  // relative, of a quotient of decimal numbers
  const double rate = parameters.number("rate"), ratio = parameters.number("cycle_rate") / rate, whole = std::round(ratio);
  if (whole < 1.0 || std::abs(ratio - whole) > rounding * whole) {
    throw SceneValueError("sensors." + sensor_name + ".cycle_rate",
                          format_quantity(parameters.number("cycle_rate"), Quantity::frequency) +
                              " is not a whole multiple of the rate " + format_quantity(rate, Quantity::frequency) +
                              "; allowed: the rate times a whole number");
  }
  return static_cast<std::size_t>(whole);
}

// Mean age [s] of the readings in slots [first, end) at the end of a sample. A round has `slots`
// slots.
double mean_age(std::size_t first, std::size_t end, std::size_t slots, std::size_t cycles_a_sample, double cycle_rate) {
  const std::size_t cycles = slots / slots_a_cycle;
  double sum = 0.0;
  for (std::size_t sample = 1; sample <= cycles; ++sample) {
    for (std::size_t slot = first; slot < end; ++slot) {
      sum += static_cast<double>((sample * cycles_a_sample - 1 + cycles - slot / slots_a_cycle) % cycles);
    }
  }
  return sum / static_cast<double>(cycles * (end - first)) / cycle_rate;
}

std::vector<Channel> make_channels(const Parameters& parameters, const Device& device, std::size_t cycles_a_sample) {
  const std::size_t electrodes = device.places.size(), readings = slots_a_cycle * cycles_a_sample;
  std::vector<std::string> names, pac_names;
  for (std::size_t e = 0; e < electrodes; ++e) names.push_back("E" + std::to_string(e + 1));
  for (std::size_t k = 0; k < readings; ++k) pac_names.push_back("PAC_" + std::to_string(k));
  std::vector<Channel> channels{{"electrodes", "counts", {electrodes}, std::move(names)},
                                {"pdc", "counts", {}, {"PDC"}},
                                {"pac", "counts", {readings}, std::move(pac_names)}};
  const double cycle_rate = parameters.number("cycle_rate");
  if (parameters.choice("scan") == "device") {
    channels[0].age = mean_age(0, electrodes, device.slots, cycles_a_sample, cycle_rate);
    channels[1].age = mean_age(electrodes, electrodes + 1, device.slots, cycles_a_sample, cycle_rate);
  }
  channels[2].age = 0.5 * static_cast<double>(readings - 1) / (slots_a_cycle * cycle_rate);
  return channels;
}

Skin skin_of(const Parameters& parameters, const Device& device, const std::string& sensor) {
  const std::vector<double>& radii = parameters.vector("radii");
  return make_skin({.elements = static_cast<std::size_t>(parameters.integer("elements")),
                    .radii = {radii[0], radii[1], radii[2]},
                    .k_normal = parameters.number("k_normal"),
                    .shear = parameters.number("shear")},
                   sensor, device.places);
}

// The electrodes' sensitivities, then the logarithms of their impedances at rest: 1 and 0 unless
// `gain` and `offset` change them.
SignalModel spread_model(double rate, std::size_t electrodes) {
  SignalModel model;
  model.rate = rate;
  model.sources = 2 * electrodes;
  for (std::size_t v = 0; v < model.sources; ++v) {
    model.source.push_back(v);
    model.gain_sd.push_back(v < electrodes ? 0.1 : 0.0);
    model.offset_sd.push_back(v < electrodes ? 0.0 : 0.02);
  }
  return model;
}

// Disturbances of the electrodes, in counts. `rate`: rounds a second [Hz].
SignalModel electrode_model(double rate, const Device& device) {
  SignalModel model;
  model.rate = rate;
  model.sources = device.places.size();
  for (std::size_t e = 0; e < model.sources; ++e) {
    model.source.push_back(e);
    model.noise_sd.push_back(device.noise * device.relative_noise[e]);
    model.drift_sd.push_back(1.5);
  }
  return model;
}

// Disturbances of pac, in counts.
SignalModel vibration_model(double rate) {
  SignalModel model;
  model.rate = rate;
  model.sources = 1;
  model.source = {0};
  model.noise_sd = {4.8};
  return model;
}

// Returns the parts in `all` that are in `named` (`are` true), or that are not in `named`.
std::vector<Named> parts(const std::vector<Named>& all, std::initializer_list<std::string_view> named, bool are) {
  std::vector<Named> kept;
  for (const Named& part : all) {
    const bool is_named = std::ranges::find(named, part.name) != named.end();
    if (is_named == are) kept.push_back(part);
  }
  return kept;
}

template <std::size_t electrodes, std::size_t slots>
class BioTac final : public Sensor {
 public:
  BioTac(const Parameters& parameters, const Device& device, const std::vector<Named>& electronics, const ElectronicsKey& key)
      : rate_(parameters.number("rate")),
        cycles_(cycles_a_sample(parameters, key.sensor_name)),
        device_scan_(parameters.choice("scan") == "device"),
        common_(parameters.number("common")),
        fluid_stiffness_(parameters.number("fluid_stiffness") * 1e12),
        core_gap_(parameters.number("core_gap")),
        pdc_rest_(parameters.number("pdc_rest")),
        label_step_(parameters.number("label_step")),
        skin_(skin_of(parameters, device, "sensors." + key.sensor_name)),
        area_(Eigen::Map<const Eigen::ArrayXd>(skin_.area.data(), static_cast<Eigen::Index>(skin_.area.size()))),
        channels_(make_channels(parameters, device, cycles_)),
        dents_(skin_,
               {.near = parameters.number("near"),
                .far = parameters.number("far"),
                .far_share = parameters.number("far_share"),
                .swell = parameters.number("swell"),
                .stretch = parameters.number("stretch")},
               "sensors." + key.sensor_name),
        memory_(begin_of_values + pac + slots_a_cycle * cycles_),
        vibration_(lowest_pac, highest_pac, slots_a_cycle * parameters.number("cycle_rate"),
                   std::span(memory_).template first<BandPass::memory_size>()),
        electrode_electronics_(parts(electronics, {"gain", "offset", "noise"}, false),
                               electrode_model(device_scan_ ? parameters.number("cycle_rate") / cycles : rate_, device), key),
        vibration_electronics_(parts(electronics, {"noise"}, true),
                               vibration_model(slots_a_cycle * parameters.number("cycle_rate")), key),
        reported_(pac + slots_a_cycle * cycles_) {
    std::array<float, 2 * electrodes> spread{};
    std::fill_n(spread.begin(), electrodes, 1.0F);
    Electronics(parts(electronics, {"gain", "offset"}, true), spread_model(rate_, electrodes), key).apply(spread, 0.0);
    for (std::size_t e = 0; e < electrodes; ++e) {
      scale_[e] = 1.0 / (parameters.number("gap") * static_cast<double>(spread[e]));
      rest_[e] = impedance_of(device.rest[e]) * math::exp(static_cast<double>(spread[electrodes + e]));
    }
    std::ranges::fill(values().subspan(pac), pac_middle);
    touching_.reserve(skin_.area.size());
    frame_.values = reported_;
  }

  BioTac(const BioTac&) = delete;  // the frame and the filter point into the object
  BioTac& operator=(const BioTac&) = delete;

  [[nodiscard]] const PadLayout& layout() const override { return skin_.layout; }
  [[nodiscard]] double rate() const override { return rate_; }
  [[nodiscard]] std::size_t scans() const override { return cycles_; }
  [[nodiscard]] const std::vector<Channel>& channels() const override { return channels_; }

  const SensorFrame& measure(const ContactFrame& truth) override {
    const auto cycle = static_cast<std::size_t>(memory_[next_cycle]);
    const bool last = cycle + 1 == cycles_;
    const double pressure = fluid_stiffness_ * displaced_volume(truth);
    const bool first_of_all = memory_[begun] == 0.0;
    hear(pressure, truth.time, pac + slots_a_cycle * cycle);
    const auto slot = static_cast<std::size_t>(memory_[next_slot]);
    if (device_scan_ ? slot == 0 : last) draw_disturbances(truth.time);
    // The device already ran before the trial: readings from earlier rounds are taken from the
    // trial's first contact.
    if (first_of_all || (!device_scan_ && last)) {
      read(0, slots, truth, pressure);
    } else if (device_scan_) {
      read(slot, slot + slots_a_cycle, truth, pressure);
    }
    memory_[next_slot] = static_cast<double>((slot + slots_a_cycle) % slots);
    memory_[next_cycle] = last ? 0.0 : static_cast<double>(cycle + 1);
    if (last) {
      read_position(truth);
      if (beyond_) ++saturated_;
      beyond_ = false;
    }
    // A slow sample has many values of pac: report those of this cycle, and all of them in the last
    // cycle, because memory may have been loaded in between.
    report(0, pac);
    report(pac + slots_a_cycle * (last ? 0 : cycle), pac + slots_a_cycle * (cycle + 1));
    frame_.time = truth.time;
    return frame_;
  }

  [[nodiscard]] std::vector<std::span<double>> memory() override {
    std::vector<std::span<double>> memories = electrode_electronics_.memory();
    for (const std::span<double> memory : vibration_electronics_.memory()) memories.push_back(memory);
    memories.emplace_back(memory_);
    return memories;
  }

  [[nodiscard]] std::uint64_t saturated() const override { return saturated_; }

  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool rotating) const override {
    if (truth.state == PadState::no_contact) return PadState::no_contact;
    return rotating || memory_[moving] != 0.0 ? PadState::gross : PadState::non_slip;
  }

 private:
  static constexpr std::size_t cycles = slots / slots_a_cycle;  // per round
  static constexpr std::size_t pdc = electrodes;                // its slot, and its index among the values
  static constexpr std::size_t pac = electrodes + 1;            // index of its first value

  // Layout of memory_ behind the band-pass: counters, last position, disturbances of the electrodes
  // in this round, held values.
  enum Place : std::size_t {
    next_cycle = BandPass::memory_size,
    next_slot,
    begun,
    pressure_before,
    known,
    moving,
    stage_x,
    stage_y,
    begin_of_disturbances,
    begin_of_values = begin_of_disturbances + electrodes
  };
  [[nodiscard]] std::span<double> disturbances() { return std::span(memory_).subspan(begin_of_disturbances, electrodes); }
  [[nodiscard]] std::span<double> values() { return std::span(memory_).subspan(begin_of_values); }

  // Fluid volume displaced by the dented skin [m3]. Stores the touching elements in touching_.
  [[nodiscard]] double displaced_volume(const ContactFrame& truth) {
    double volume = 0.0;
    touching_.clear();
    for (Eigen::Index i = 0; i < area_.size(); ++i) {
      const double depth = truth.element_depth[i];
      if (!(depth > 0.0)) continue;
      touching_.push_back(i);
      volume += std::min(depth, core_gap_) * area_[i];
    }
    return volume;
  }

  // Returns the converter's counts for a signal, rounded and clipped to its range.
  double converted(double signal) {
    const double counts = std::round(signal), held = std::clamp(counts, 0.0, last_code);
    beyond_ |= held != counts;
    return held;
  }

  // Reads the slots [first, end).
  void read(std::size_t first, std::size_t end, const ContactFrame& truth, double pressure) {
    for (std::size_t slot = first; slot < end; ++slot) {
      if (slot < electrodes) values()[slot] = electrode(slot, truth);
      if (slot == pdc) values()[pdc] = converted(pdc_rest_ + pressure / pdc_step);
    }
  }

  double electrode(std::size_t e, const ContactFrame& truth) {
    const double impedance = rest_[e] * math::exp(dents_.dent(e, truth, touching_) * scale_[e]) + common_;
    return converted(counts_of(impedance) + disturbances()[e]);
  }

  // Reads pac in a cycle that ends with `pressure`, linear in time from the cycle before. Writes
  // the values from index `first` on.
  void hear(double pressure, double time, std::size_t first) {
    const double before = memory_[begun] != 0.0 ? memory_[pressure_before] : pressure;
    for (std::size_t k = 0; k < slots_a_cycle; ++k) {
      const double share = static_cast<double>(k + 1) / slots_a_cycle;
      std::array<float, 1> heard{static_cast<float>(vibration_.next(before + share * (pressure - before)) / pac_step)};
      vibration_electronics_.apply(heard, time);
      values()[first + k] = converted(pac_middle + static_cast<double>(heard[0]));
    }
    memory_[begun] = 1.0;
    memory_[pressure_before] = pressure;
  }

  // Draws for a whole round at once, because each electrode is read once per round.
  void draw_disturbances(double time) {
    std::array<float, electrodes> drawn{};
    electrode_electronics_.apply(drawn, time);
    std::ranges::copy(drawn, disturbances().begin());
  }

  // Copies the values [first, end) into the frame.
  void report(std::size_t first, std::size_t end) {
    for (std::size_t v = first; v < end; ++v) reported_[v] = static_cast<float>(values()[v]);
  }

  // Reads the bench's position, once a sample, and records if it has changed.
  void read_position(const ContactFrame& truth) {
    const double x = truth.stage_position.x(), y = truth.stage_position.y();
    const bool moved = memory_[known] != 0.0 && math::hypot(x - memory_[stage_x], y - memory_[stage_y]) > label_step_;
    memory_[moving] = moved ? 1.0 : 0.0;
    memory_[known] = 1.0;
    memory_[stage_x] = x;
    memory_[stage_y] = y;
  }

  double rate_;
  std::size_t cycles_;  // a sample
  bool device_scan_;
  double common_;           // kOhm
  double fluid_stiffness_;  // Pa/m3
  double core_gap_;         // m
  double pdc_rest_;         // counts
  double label_step_;       // m
  Skin skin_;
  Eigen::ArrayXd area_;  // [N] m2
  std::vector<Channel> channels_;
  Dents dents_;
  std::vector<Eigen::Index> touching_;  // elements, in this reading
  std::vector<double> memory_;
  BandPass vibration_;
  Electronics electrode_electronics_, vibration_electronics_;
  std::array<double, electrodes> scale_{}, rest_{};  // 1/m, kOhm
  std::vector<float> reported_;
  SensorFrame frame_;
  bool beyond_ = false;  // a reading of this sample lies beyond the converter's range
  std::uint64_t saturated_ = 0;
};

template <std::size_t electrodes, std::size_t slots, const Device& (*device_of)()>
std::unique_ptr<Sensor> make(const Parameters& parameters, const std::vector<Named>& electronics, std::uint64_t seed,
                             std::uint64_t trial, const std::string& sensor_name) {
  const bool fixed = parameters.choice("device") == "fixed";
  const auto number = static_cast<std::uint64_t>(parameters.integer("device_number"));
  if (!fixed && number != 0) {
    throw SceneValueError("sensors." + sensor_name + ".device_number",
                          std::to_string(number) + " applies only to a fixed device; use 0, or device: fixed");
  }
  const std::uint64_t device = fixed ? number : trial;
  return std::make_unique<BioTac<electrodes, slots>>(parameters, device_of(), electronics,
                                                     ElectronicsKey{seed, trial, device, sensor_name});
}

}  // namespace

}  // namespace biotac_sp

SensorKind biotac_sp_sensor() {
  using namespace biotac_sp;
  return {.about = about(),
          .electronics = electronics_parts(),
          .create = make<electrodes, slots_sp, sp>,
          .view = {.unit = "electrode",
                   .units = "electrodes",
                   .letter = "E",
                   .first = 1,
                   .channels = {{.channel = "electrodes", .name = "electrodes", .unit = "counts", .image = true},
                                {.channel = "pdc", .name = "pdc", .unit = "counts"},
                                {.channel = "pac", .name = "pac", .unit = "counts"}}}};
}

SensorKind biotac_19_sensor() {
  using namespace biotac_sp;
  return {.about = about_19(),
          .electronics = electronics_parts_19(),
          .create = make<electrodes_19, slots_19, nineteen>,
          .view = {.unit = "electrode", .units = "electrodes", .letter = "E", .first = 1}};
}

}  // namespace slipbench
