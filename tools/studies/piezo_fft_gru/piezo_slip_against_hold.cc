// Slip against hold by the loudness of one frame, against the motors' level: the curve, and which frames are mistaken.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/studies/piezo_fft_gru/piezo_networks.h"

namespace slipbench::reproduce {
namespace {

constexpr double settling_time = 3.0 / (2.0 * std::numbers::pi * 3.0);  // s, three time constants of the amplifier's 3 Hz

using SkinRecordings = std::vector<SkinRecording>;

// What makes slip and hold of a frame, and its loudness.
struct FrameReading {
  std::string name, text;
  FrameSpectrum spectrum = FrameSpectrum::plain;
  bool by_position = false, one_label = false;

  [[nodiscard]] bool slips(const SkinFrame& frame) const { return by_position ? frame.slips_by_position : frame.slips; }
  [[nodiscard]] bool counts(const SkinFrame& frame) const { return frame.one_label || !one_label; }
};

// Slip against all hold, hold in contact alone, and hold in the air alone. Empty: there are no frames of one kind.
struct Separations {
  std::optional<Auc> pooled, contact, air;
};

// Which frames a question is about.
using FrameChoice = std::function<bool(const SkinRecording&, const SkinFrame&)>;

// Frames of a kind. Of a list of causes a frame has the first that fits.
struct FrameCause {
  std::string name, text;
  FrameChoice fits;
};

// The frames in contact that have a cause, against all frames in contact of the other class. By FrameSpectrum: the area, and what
// they add to what the area of all causes lacks of 1, as a share of it: an area is a mean over frames, so that the shares sum up
// to 1.
struct CauseFigures {
  std::size_t frames = 0;
  double share = 0.0;  // of the frames of all causes
  double rms = 0.0;    // counts, median, by the plain spectrum; NaN of none
  std::array<std::optional<Auc>, frame_spectra> area;
  std::array<double, frame_spectra> share_of_missing{};
};

constexpr double light_press = 4.0;   // N, below a quarter of the published 2 to 10
constexpr double slow_slide = 10e-3;  // m/s, below a fifth of the published 3.3 to 33 mm/s

// Loudness of the chosen frames, and the number of the recording of each.
struct Loudness {
  std::vector<double> power;
  std::vector<std::size_t> recording;
};

Loudness loudness_of(const SkinRecordings& recordings, const FrameReading& reading, const FrameChoice& chosen) {
  Loudness found;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    for (const SkinFrame& frame : recordings[r].frames) {
      if (!reading.counts(frame) || !chosen(recordings[r], frame)) continue;
      found.power.push_back(frame.power.at(static_cast<std::size_t>(reading.spectrum)));
      found.recording.push_back(r);
    }
  }
  return found;
}

std::optional<Auc> separation(const Loudness& slip, const Loudness& hold) {
  if (slip.power.empty() || hold.power.empty()) return std::nullopt;
  return auc(slip.power, slip.recording, hold.power, hold.recording);
}

// The paper's spectrum first, then the others by FrameSpectrum, then other labels.
const std::vector<FrameReading> frame_readings{
    {"paper", "as the paper: mean off, no taper named; true label"},
    {"detrended", "straight line of each frame off", FrameSpectrum::detrended},
    {"hann", "Hann's taper", FrameSpectrum::hann},
    {"one_label", "mean off; frames of one label only", FrameSpectrum::plain, false, true},
    {"hann_one_label", "Hann's taper; frames of one label only", FrameSpectrum::hann, false, true},
    {"position", "as the paper, label by the 100 Hz position", FrameSpectrum::plain, true},
    {"detrended_position", "straight line off, label by the 100 Hz position", FrameSpectrum::detrended, true},
    {"hann_position", "Hann's taper, label by the 100 Hz position", FrameSpectrum::hann, true},
};

Separations separations(const SkinRecordings& recordings, const FrameReading& reading) {
  const auto hold = [&](const SkinFrame& frame) { return !reading.slips(frame); };
  const Loudness slip =
      loudness_of(recordings, reading, [&](const auto&, const SkinFrame& frame) { return reading.slips(frame); });
  const auto against = [&](const FrameChoice& chosen) { return separation(slip, loudness_of(recordings, reading, chosen)); };
  return {against([&](const auto&, const SkinFrame& frame) { return hold(frame); }),
          against([&](const auto&, const SkinFrame& frame) { return hold(frame) && frame.contact; }),
          against([&](const auto&, const SkinFrame& frame) { return hold(frame) && !frame.contact; })};
}

const std::vector<FrameCause> hold_causes{
    {"stick_between_slips", "a part slipped within the frame, at its end all sticks",
     [](const auto&, const SkinFrame& frame) { return frame.slipped; }},
    {"press", "the tip is pressed on", [](const auto&, const SkinFrame& frame) { return frame.pressed; }},
    {"shear", "the bench moves, shear is built up before the slip",
     [](const auto&, const SkinFrame& frame) { return frame.slid; }},
    {"settling", "at rest for less than 159 ms, the amplifier settles",
     [](const auto&, const SkinFrame& frame) { return frame.still < settling_time; }},
    {"rest", "at rest for longer", [](const auto&, const SkinFrame&) { return true; }},
};

const std::vector<FrameCause> slip_causes{
    {"starts_or_stops", "the bench speeds up, brakes or stands (below 0.9 of its speed)",
     [](const auto&, const SkinFrame& frame) { return !frame.at_speed; }},
    {"slow_and_light", "slower than 10 mm/s and below 4 N",
     [](const SkinRecording& of, const SkinFrame&) { return of.speed < slow_slide && of.force < light_press; }},
    {"slow", "slower than 10 mm/s", [](const SkinRecording& of, const SkinFrame&) { return of.speed < slow_slide; }},
    {"light", "below 4 N", [](const SkinRecording& of, const SkinFrame&) { return of.force < light_press; }},
    {"other", "faster and heavier", [](const SkinRecording&, const SkinFrame&) { return true; }},
};

// Of each cause, in their order; `of_slip`: causes of slip, else of hold.
std::vector<CauseFigures> figures_of(const SkinRecordings& recordings, const std::vector<FrameCause>& causes, bool of_slip) {
  const auto is = [](bool slip, const SkinFrame& frame) { return frame.contact && frame.slips == slip; };
  const auto cause_of = [&](const SkinRecording& recording, const SkinFrame& frame) {
    return std::ranges::find_if(causes, [&](const FrameCause& cause) { return cause.fits(recording, frame); }) - causes.begin();
  };
  std::vector<CauseFigures> figures(causes.size());
  for (std::size_t k = 0; k < frame_spectra; ++k) {
    const FrameReading& reading = frame_readings[k];
    const Loudness other =
        loudness_of(recordings, reading, [&](const auto&, const SkinFrame& frame) { return is(!of_slip, frame); });
    const auto area = [&](const Loudness& own) { return of_slip ? separation(own, other) : separation(other, own); };
    const Loudness all =
        loudness_of(recordings, reading, [&](const auto&, const SkinFrame& frame) { return is(of_slip, frame); });
    const std::optional<Auc> whole = area(all);
    const double missing = whole ? 1.0 - whole->value : 0.0;
    for (std::size_t c = 0; c < causes.size(); ++c) {
      const Loudness own = loudness_of(recordings, reading, [&](const SkinRecording& recording, const SkinFrame& frame) {
        return is(of_slip, frame) && cause_of(recording, frame) == static_cast<std::ptrdiff_t>(c);
      });
      CauseFigures& cause = figures[c];
      cause.frames = own.power.size();
      cause.share = static_cast<double>(own.power.size()) / static_cast<double>(all.power.size());
      if (reading.spectrum == FrameSpectrum::plain) cause.rms = std::sqrt(quantile(own.power, 0.5));
      cause.area.at(k) = area(own);
      cause.share_of_missing.at(k) =
          cause.area.at(k) && missing > 0.0 ? cause.share * (1.0 - cause.area.at(k)->value) / missing : 0.0;
    }
  }
  return figures;
}

constexpr std::size_t default_bench_recordings = 120;  // of each level
constexpr double wanted_area = 0.95;                   // the bar on the area without motors

const std::vector<double> vibration_levels{0.0, 0.5, 1.0, 2.0, 4.0, 8.0};

// A bench that differs in one thing, without motors.
struct OtherBench {
  std::string name, text;
  std::function<void(Scene&)> change;
};
const std::vector<OtherBench> other_benches{
    {"deaf_direction", "slides along 135 deg, whose shear makes no charge",
     [](Scene& scene) { scene.motion.parameters.set("direction", 0.75 * std::numbers::pi); }},
    {"fast_press", "pressed on at 2 mm/s instead of 0.7",
     [](Scene& scene) {
       if (scene.motion.parameters.number("clearance") == 0.0) scene.motion.parameters.set("approach_speed", 2e-3);
     }},
};

// All recordings at each level of vibration_levels, then those of each of other_benches.
std::vector<SkinRecordings> run_benches(std::size_t recordings, const ReproduceOptions& options) {
  const auto cell = [&](const std::string& name, double level, const std::function<void(Scene&)>& change) {
    const auto changed = [level, change](Scene& scene) {
      scene.motion.parameters.set("vibration", level);
      if (change) change(scene);
    };
    return GridCell{name, piezo_bench_scene, {}, changed, recordings / 2};
  };
  std::vector<GridCell> cells;
  for (const double level : vibration_levels) cells.push_back(cell(fmt::format("motor level {}", level), level, {}));
  for (const OtherBench& bench : other_benches) cells.push_back(cell(bench.text, 0.0, bench.change));
  return run_grid<SkinRecording>(cells, options,
                                 [](const GridTrial& trial) { return skin_recording(trial.scene, trial.record()); });
}

std::string area_cell(const std::optional<Auc>& found) { return found ? fmt::format("{:.3f}", found->value) : "-"; }
std::string interval_cell(const std::optional<Auc>& found) {
  return found ? fmt::format("{:.3f} to {:.3f}", found->interval.low, found->interval.high) : "-";
}
Json area_json(const std::optional<Auc>& found) {
  if (!found) return nullptr;
  return {{"auc", found->value},
          {"interval_95", {found->interval.low, found->interval.high}},
          {"slip_frames", found->positives},
          {"hold_frames", found->negatives}};
}
Json areas_json(const Separations& areas) {
  return {{"pooled", area_json(areas.pooled)}, {"contact", area_json(areas.contact)}, {"air", area_json(areas.air)}};
}
std::vector<std::string> area_row(const std::string& name, const Separations& areas) {
  return {name,
          area_cell(areas.pooled),
          interval_cell(areas.pooled),
          area_cell(areas.contact),
          interval_cell(areas.contact),
          area_cell(areas.air),
          interval_cell(areas.air)};
}
ResultTable area_table(const std::string& title, const std::string& first, const std::string& note) {
  return {title, {first, "all hold", "95 %", "hold in contact alone", "95 %", "hold in the air alone", "95 %"}, {}, note};
}

ResultPoint point_of(const std::optional<Auc>& found) {
  return found ? ResultPoint{found->value, found->interval.low, found->interval.high} : ResultPoint{0.5, 0.5, 0.5};
}

ResultTable cause_table(const SkinRecordings& recordings, const std::vector<FrameCause>& causes, bool of_slip, Json& figures) {
  ResultTable table{
      of_slip ? "Slip that is taken for hold in contact, no motors" : "Hold in contact that is taken for slip, no motors",
      {"frames in which", "frames", "share", "rms, counts, median", "AUC", "of what is missing from 1", "line off: AUC",
       "of what is missing", "Hann: AUC", "of what is missing"},
      {},
      of_slip
          ? ""
          : "A frame has the first cause that fits. The area is a mean over the frames, so that the causes' parts of what it lacks of 1 add up. No slide of the published ranges is deaf: all go along X."};
  const std::vector<CauseFigures> found = figures_of(recordings, causes, of_slip);
  for (std::size_t c = 0; c < causes.size(); ++c) {
    const CauseFigures& cause = found[c];
    Json& entry = figures[causes[c].name];
    entry = {{"frames", cause.frames}, {"share", cause.share}};
    std::vector<std::string>& row = table.rows.emplace_back();
    row = {causes[c].text, std::to_string(cause.frames), fmt::format("{:.1f} %", 100.0 * cause.share),
           std::isnan(cause.rms) ? "-" : fmt::format("{:.1f}", cause.rms)};
    for (std::size_t k = 0; k < frame_spectra; ++k) {
      const std::optional<Auc>& area = cause.area.at(k);
      row.push_back(area_cell(area));
      row.push_back(fmt::format("{:.0f} %", 100.0 * cause.share_of_missing.at(k)));
      entry[frame_readings[k].name] = {{"auc", area ? Json(area->value) : Json(nullptr)},
                                       {"share_of_missing", cause.share_of_missing.at(k)}};
    }
  }
  return table;
}

// An area of the figures; null where there were no frames of one kind.
std::string area_text(const Json& area) { return area.is_null() ? "-" : fmt::format("{:.3f}", area.get<double>()); }

// The remarks take their numbers from the run at hand.
std::vector<std::string> remarks_on(const Json& figures) {
  const auto along = [&](const char* against) {
    std::vector<std::string> areas;
    for (const double level : vibration_levels) {
      const Json& found = figures.at("curve").at("paper").at(fmt::format("{}", level)).at(against);
      areas.push_back(found.is_null() ? "-" : area_text(found.at("auc")));
    }
    return fmt::format("{}", fmt::join(areas, ", "));
  };
  const Json& causes = figures.at("hold_causes");
  const auto missing = [&](const char* cause) {
    return 100.0 * causes.at(cause).at("paper").at("share_of_missing").get<double>();
  };
  const auto readings = [&](const char* cause) {
    std::vector<std::string> areas;
    for (std::size_t k = 0; k < frame_spectra; ++k) {
      areas.push_back(area_text(causes.at(cause).at(frame_readings[k].name).at("auc")));
    }
    return fmt::format("{}", fmt::join(areas, ", "));
  };
  return {
      fmt::format(
          "The motors run while the tip slides; in half of the recordings one that does not move the tip runs from a random instant on. From level {} to {} the area is {} against hold in contact alone and {} against hold in the air alone.",
          vibration_levels.front(), vibration_levels.back(), along("contact"), along("air")),
      fmt::format(
          "A steady press is a constant behind the amplifier; where it begins and ends the signal decays with {:.0f} ms, over 20 ms nearly a straight line, which leaks into all bins of a window without a taper. Without motors pressing on and settling are {:.0f} and {:.0f} % of what hold in contact lacks of 1; their areas as the paper, with the line off, with Hann's taper: {}; {}.",
          1e3 * settling_time / 3.0, missing("press"), missing("settling"), readings("press"), readings("settling")),
      fmt::format(
          "Instants of a slide at which all sticks lie within frames of its vibration: {:.0f} % of what is missing, areas {}. By the position label they are slip, and so is the shear before the first slip.",
          missing("stick_between_slips"), readings("stick_between_slips")),
  };
}

// The curve over the motors' level, as a table and as a chart: the paper's reading of a frame. The figures hold all readings.
ResultTable curve_table(const std::vector<SkinRecordings>& levels, ResultChart& chart, Json& figures) {
  ResultTable table = area_table(
      "Area under the curve against the motors' level", "motor level",
      fmt::format("The bar is {} at level 0. Intervals are by recording (Obuchowski): the frames of one depend on each other.",
                  wanted_area));
  for (std::size_t i = 0; i < vibration_levels.size(); ++i) {
    const std::string name = fmt::format("{}", vibration_levels[i]);
    for (const FrameReading& reading : frame_readings) {
      const Separations areas = separations(levels[i], reading);
      figures[reading.name][name] = areas_json(areas);
      if (reading.name != "paper") continue;
      table.rows.push_back(area_row(name, areas));
      chart.places.push_back(name);
      for (std::size_t k = 0; k < 3; ++k) {
        chart.curves[k].points.push_back(point_of(std::array{areas.pooled, areas.contact, areas.air}.at(k)));
      }
    }
  }
  return table;
}

ResultTable readings_table(const SkinRecordings& without_motors) {
  ResultTable table = area_table(
      "Other readings of the paper, no motors", "reading of a frame",
      "The curve is the first row: the paper's spectrum, of which it says that the mean is taken off and names no taper, with the true label. The paper's own reading is the row with its position label. The others are offered beside them. Frames of one label only leave out those within which contact or slip begins or ends.");
  for (const FrameReading& reading : frame_readings) {
    table.rows.push_back(area_row(reading.text, separations(without_motors, reading)));
  }
  return table;
}

// `first`: of the bench as it is.
ResultTable benches_table(std::vector<std::string> first, std::span<const SkinRecordings> benches, Json& figures) {
  ResultTable table = area_table("What the bench decides, no motors", "bench", "");
  first.front() = "as above";
  table.rows.push_back(std::move(first));
  for (std::size_t i = 0; i < benches.size(); ++i) {
    const OtherBench& bench = other_benches[i];
    for (std::size_t k = 0; k < frame_spectra; ++k) {
      const FrameReading& reading = frame_readings[k];
      const Separations areas = separations(benches[i], reading);
      figures[bench.name][reading.name] = areas_json(areas);
      table.rows.push_back(area_row(bench.text + (k == 0 ? "" : k == 1 ? "; line off" : "; Hann's taper"), areas));
    }
  }
  return table;
}

}  // namespace

Result piezo_slip_against_hold(const ReproduceOptions& options) {
  const std::size_t count = options.trials != 0 ? options.trials : default_bench_recordings;
  check_recordings(count, 4, "an interval needs two");
  const std::vector<SkinRecordings> runs = run_benches(count, options);
  const SkinRecordings& without_motors = runs.front();
  Result result;
  result.title = "Slip against hold by the loudness of one frame of the piezoelectric skin";
  result.source =
      "The frames of \"Spectro-Temporal Recurrent Neural Network for Robotic Slip Detection with Piezoelectric Tactile Sensor\", section IV-A: 20 ms every 10 ms at 10 kHz, 50 to 600 Hz. The paper prints no such curve.";
  result.charts.push_back({.title = "Slip against hold by one frame",
                           .across = "level of the motors' vibration",
                           .up = "area under the curve",
                           .places = {},
                           .curves = {{"all hold", {}}, {"in contact alone", {}}, {"in the air alone", {}}},
                           .bar = wanted_area,
                           .bar_name = "bar at level 0"});
  result.tables.push_back(curve_table(runs, result.charts.front(), result.figures["curve"]));
  result.tables.push_back(readings_table(without_motors));
  result.tables.push_back(cause_table(without_motors, hold_causes, false, result.figures["hold_causes"]));
  result.tables.push_back(cause_table(without_motors, slip_causes, true, result.figures["slip_causes"]));
  result.tables.push_back(benches_table(result.tables.front().rows.front(), std::span(runs).subspan(vibration_levels.size()),
                                        result.figures["bench"]));
  result.setup = {
      fmt::format("{} recordings a level from {}, half with a slip, seed {}: the same draws at every level.", count,
                  piezo_bench_scene, options.seed.value_or(1)),
      "Loudness: power within 50 to 600 Hz, both included, of the frame less its mean. A frame's label is that of its last sample; slip is that a part of the contact slips (rule micro), so that a frame of partial slip is one of slip.",
  };
  result.remarks = remarks_on(result.figures);
  return result;
}

}  // namespace slipbench::reproduce
