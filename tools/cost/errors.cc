#include "tools/cost/errors.h"

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sim/stage/stage_setup.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {
namespace {

constexpr std::array<MeasureInfo, num_measures> measures{{
    {Measure::onset, "onset", "slip onset", "%", 100.0,
     "by unit, difference of the times at which the unit begins to slip as a whole, divided by the time from the first load to the slip in the reference (at least 10 ms). If a unit slips in only one run, the difference is the time from its slip to the end of the trial. A unit is not counted if its first slip in one run ends before its first slip in the other run begins"},
    {Measure::micro_onset, "micro_onset", "first micro-slip", "%", 100.0,
     "as onset, for the time at which a first part of the unit begins to slip"},
    {Measure::slip_distance, "slip_distance", "slipped distance", "%", 100.0,
     "by slipping unit, difference of the slip distances at the last common time, divided by the largest slip distance of any unit in the reference (at least 1 um)"},
    {Measure::force, "force", "force", "%", 100.0,
     "by sensor, root mean square of the difference of the units' contact forces at all common times, divided by the root mean square of the forces in the reference. If the runs have different units, the forces of the pads are compared"},
    {Measure::creep, "creep", "creep", "um/s", 1e6,
     "by held body, difference of its drift speeds over its pad during the longest interval (at least 100 ms) in which the pad touches and no unit slips in the reference"},
    {Measure::label, "label", "labels", "%", 100.0,
     "by sensor, share of the units' states that differ at common times, among units that touch in either run"},
    {Measure::label_micro, "label_micro", "pad state", "%", 100.0,
     "by sensor, share of the pad's states by the rule micro that differ at common times, among those with contact in either run"},
    {Measure::outcome, "outcome", "outcome", "%", 100.0,
     "share of the results of the trial that differ: whether the pad touches; whether a part of a unit, a whole unit and the whole pad slip; the result of the detector; whether the box is dropped, the grip reacts and the box stands"},
    {Measure::detector, "detector", "detector", "%", 100.0,
     "share of the loop's samples at common times at which the detector's class differs"},
    {Measure::signal, "signal", "signal", "%", 100.0,
     "by channel of a sensor, root mean square of the difference of the readings at common times, divided by the standard deviation of the reference. Noise is drawn once per sample, so it is equal in both runs only at the same output rate"},
}};

constexpr double time_rounding = 1e-9;  // s, for times that are sums of decimal steps
constexpr double least_slip = 1e-6;     // m
// Slips that begin within this share of the loading time are one event, however short.
constexpr double same_event_share = 0.01;
constexpr double least_hold = 0.1;  // s
constexpr std::uint8_t detached_state = static_cast<std::uint8_t>(UnitState::detached);
constexpr std::uint8_t sticking_state = static_cast<std::uint8_t>(UnitState::stick);

using Rows = std::vector<std::pair<std::size_t, std::size_t>>;

// A sensor in both records.
struct Both {
  const SensorRecord& run;
  const SensorRecord& reference;

  [[nodiscard]] bool same_units() const { return run.labels.units() == reference.labels.units(); }
  [[nodiscard]] Rows rows() const { return common_rows(run.time, reference.time); }
};

std::vector<float> margin_of(const LabelRecord& labels, std::size_t unit) {
  std::vector<float> column;
  for (std::size_t i = unit; i < labels.margin.size(); i += labels.units()) column.push_back(labels.margin[i]);
  return column;
}

// End [s] of the unit's slip that began at `onset`: the slip is no longer one of the whole unit,
// or, with `in_part`, of any part of it. Infinite if it lasts to the end of the trial.
double slip_end(const LabelRecord& labels, std::size_t unit, double onset, bool in_part) {
  for (std::size_t e = 0; e < labels.event_time.size(); ++e) {
    if (labels.event_unit[e] != unit || !(labels.event_time[e] > onset)) continue;
    const auto kind = static_cast<EventKind>(labels.event_kind[e]);
    if (kind == EventKind::stick || kind == EventKind::detach || (kind == EventKind::part_sticks && !in_part))
      return labels.event_time[e];
  }
  return std::numeric_limits<double>::infinity();
}

// `onsets`: onset_time, or micro_onset_time (`in_part`). If one of two first slips ended before the
// other began, they are two events: one run narrowly missed what the other did.
std::optional<MeasureError> onset_error(const std::vector<Both>& sensors, std::vector<double> LabelRecord::*onsets, bool in_part,
                                        double end) {
  MeasureValues values;
  for (const Both& both : sensors) {
    if (!both.same_units()) continue;
    for (std::size_t unit = 0; unit < both.run.labels.units(); ++unit) {
      const double in_run = (both.run.labels.*onsets)[unit], in_reference = (both.reference.labels.*onsets)[unit];
      if (std::isnan(in_run) && std::isnan(in_reference)) continue;
      const SensorRecord& slipping = std::isnan(in_reference) ? both.run : both.reference;
      const double load = load_time(slipping.time, margin_of(slipping.labels, unit), (slipping.labels.*onsets)[unit]);
      const SensorRecord& first = in_run < in_reference ? both.run : both.reference;
      const double later = std::max(in_run, in_reference);
      if (std::abs(in_run - in_reference) > same_event_share * load &&
          slip_end(first.labels, unit, std::min(in_run, in_reference), in_part) <= later) {
        values.add_other_event();
      } else {
        values.add_onsets(in_run, in_reference, load, end);
      }
    }
  }
  return values.error();
}

std::optional<MeasureError> slip_distance_error(const std::vector<Both>& sensors) {
  MeasureValues values;
  double largest = least_slip;
  for (const Both& both : sensors) {
    const Rows rows = both.rows();
    if (!both.same_units() || rows.empty()) continue;
    const std::size_t units = both.run.labels.units();
    for (std::size_t unit = 0; unit < units; ++unit) {
      const double in_run = static_cast<double>(both.run.labels.slip_distance[rows.back().first * units + unit]);
      const double in_reference = static_cast<double>(both.reference.labels.slip_distance[rows.back().second * units + unit]);
      if (in_run == 0.0 && in_reference == 0.0) continue;
      values.add(std::abs(in_run - in_reference));
      largest = std::max(largest, in_reference);
    }
  }
  values.divide(largest);
  return values.error();
}

// Adds the root mean square of the difference, divided by that of the reference, or, with
// `about_mean`, by the reference's about its mean. `width`: values per row.
void add_difference(const Rows& rows, std::span<const float> run, std::span<const float> reference, std::size_t width,
                    bool about_mean, MeasureValues& values) {
  double squares = 0.0, total = 0.0;
  for (std::size_t i = 0; i < width; ++i) {
    double sum = 0.0;
    for (const auto& row : rows) sum += static_cast<double>(reference[row.second * width + i]);
    const double mean = about_mean ? sum / static_cast<double>(rows.size()) : 0.0;
    for (const auto& [row, reference_row] : rows) {
      const double actual = static_cast<double>(run[row * width + i]);
      const double expected = static_cast<double>(reference[reference_row * width + i]);
      squares += (actual - expected) * (actual - expected);
      total += (expected - mean) * (expected - mean);
    }
  }
  values.add_share(squares, total);
}

// Sum over the units [N], three values per sample.
std::vector<float> pad_force(const SensorRecord& sensor) {
  const std::size_t units = sensor.labels.units();
  std::vector<float> sums;
  for (std::size_t row = 0; row < sensor.time.size(); ++row) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t u = 0; u < units; ++u) {
      sum += Eigen::Map<const Eigen::Vector3f>(sensor.labels.force.data() + 3 * (row * units + u)).cast<double>();
    }
    for (const double component : sum) sums.push_back(static_cast<float>(component));
  }
  return sums;
}

std::optional<MeasureError> force_error(const std::vector<Both>& sensors) {
  MeasureValues values;
  for (const Both& both : sensors) {
    if (both.same_units()) {
      add_difference(both.rows(), both.run.labels.force, both.reference.labels.force, 3 * both.run.labels.units(), false, values);
    } else {
      add_difference(both.rows(), pad_force(both.run), pad_force(both.reference), 3, false, values);
    }
  }
  return values.error();
}

// `states`: states of the pad, or with `by_unit` of each of its units; 0 means no contact.
std::optional<MeasureError> state_error(const std::vector<Both>& sensors, std::vector<std::uint8_t> LabelRecord::*states,
                                        bool by_unit) {
  MeasureValues values;
  for (const Both& both : sensors) {
    if (by_unit && !both.same_units()) continue;
    const std::size_t width = by_unit ? both.run.labels.units() : 1;
    std::size_t differing = 0, total = 0;
    for (const auto& [row, reference_row] : both.rows()) {
      for (std::size_t i = 0; i < width; ++i) {
        const std::uint8_t actual = (both.run.labels.*states)[row * width + i];
        const std::uint8_t expected = (both.reference.labels.*states)[reference_row * width + i];
        total += actual != 0 || expected != 0 ? 1U : 0U;
        differing += actual != expected ? 1U : 0U;
      }
    }
    values.add_count(differing, total);
  }
  return values.error();
}

MeasureError outcome_error(const TrialRecord& run, const TrialRecord& reference) {
  std::size_t differing = 0, total = 0;
  const auto decide = [&](bool actual, bool expected) {
    ++total;
    differing += actual != expected ? 1U : 0U;
  };
  const auto happens = [&](double actual, double expected) { decide(!std::isnan(actual), !std::isnan(expected)); };
  const TrialOutcome &actual = run.outcome, &expected = reference.outcome;
  happens(actual.touch_time, expected.touch_time);
  happens(actual.first_micro_slip_time, expected.first_micro_slip_time);
  happens(actual.first_slip_time, expected.first_slip_time);
  happens(actual.gross_slip_time, expected.gross_slip_time);
  if (reference.control && !reference.control->detector.empty()) {
    ++total;
    differing += actual.detection != expected.detection ? 1U : 0U;
  }
  if (actual.grasp && expected.grasp) {
    decide(actual.grasp->dropped, expected.grasp->dropped);
    if (actual.grasp->lifted && expected.grasp->lifted) decide(*actual.grasp->lifted, *expected.grasp->lifted);
    if (reference.control) happens(actual.grasp->reaction_time, expected.grasp->reaction_time);
    if (actual.grasp->turn && expected.grasp->turn) decide(actual.grasp->turn->standing, expected.grasp->turn->standing);
  }
  const double share = static_cast<double>(differing) / static_cast<double>(total);
  return {share, share, differing > 0};
}

std::optional<MeasureError> detector_error(const TrialRecord& run, const TrialRecord& reference) {
  if (!run.control || !reference.control || reference.control->detector.empty()) return std::nullopt;
  MeasureValues values;
  const Rows rows = common_rows(run.control->time, reference.control->time);
  const auto differ = [&](const auto& row) {
    return run.control->detector_class[row.first] != reference.control->detector_class[row.second];
  };
  values.add_count(static_cast<std::size_t>(std::ranges::count_if(rows, differ)), rows.size());
  return values.error();
}

void add_channel(const Both& both, const SensorColumn& actual, const SensorColumn& expected, MeasureValues& values) {
  const Rows rows = common_rows(both.run.times_of(actual), both.reference.times_of(expected));
  if (rows.empty() || actual.shape != expected.shape) return;
  add_difference(rows, actual.values, expected.values, expected.row_size(), true, values);
}

std::optional<MeasureError> signal_error(const std::vector<Both>& sensors) {
  MeasureValues values;
  for (const Both& both : sensors) {
    for (const SensorColumn& expected : both.reference.channels) {
      const auto actual = std::ranges::find(both.run.channels, expected.name, &SensorColumn::name);
      if (actual != both.run.channels.end()) add_channel(both, *actual, expected, values);
    }
  }
  return values.error();
}

// A body and the pad that holds it, by their names in a record.
struct HeldPair {
  std::size_t sensor;  // that has the pad
  std::string pad, body;
};

std::vector<HeldPair> held_pairs(const Scene& scene, const TrialRecord& record) {
  const auto recorded = [&](const std::string& name) {
    return std::ranges::find(record.bodies, name, &BodyRecord::name) != record.bodies.end();
  };
  std::vector<HeldPair> pairs;
  if (!scene.dynamic()) return pairs;
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const SensorScene& sensor = scene.sensors[i];
    if (!sensor.follows.empty()) continue;
    const std::string pad = recorded(sensor.name) ? sensor.name : "pad";
    const std::vector<std::string> touched = scene.grasp ? std::vector<std::string>{"box"} : sensor.touches;
    for (const std::string& body : touched) {
      if (recorded(pad) && recorded(body)) pairs.push_back({i, pad, body});
    }
  }
  return pairs;
}

// Position of the body in the pad's frame [m] at one row of the bodies.
Eigen::Vector3d place_on_pad(const TrialRecord& record, const HeldPair& pair, std::size_t row) {
  const auto pose_of = [&](const std::string& name) {
    return std::ranges::find(record.bodies, name, &BodyRecord::name)->pose.data() + 7 * row;
  };
  const float* const pad = pose_of(pair.pad);
  const float* const body = pose_of(pair.body);
  const Eigen::Quaterniond turn = Eigen::Quaternionf(pad[3], pad[4], pad[5], pad[6]).cast<double>().normalized();
  const Eigen::Vector3d apart =
      Eigen::Map<const Eigen::Vector3f>(body).cast<double>() - Eigen::Map<const Eigen::Vector3f>(pad).cast<double>();
  return turn.conjugate() * apart;
}

// True if at time t, by the last sample up to it, the pad of sensor `holding` is in contact and no
// unit of any sensor slips.
bool holds_at(const TrialRecord& record, std::size_t holding, double time) {
  for (std::size_t s = 0; s < record.sensors.size(); ++s) {
    const SensorRecord& sensor = record.sensors[s];
    const auto next = std::ranges::upper_bound(sensor.time, time + time_rounding);
    if (next == sensor.time.begin()) return false;
    const std::size_t units = sensor.labels.units(), row = static_cast<std::size_t>(next - sensor.time.begin()) - 1;
    const auto states = std::span(sensor.labels.unit_state).subspan(row * units, units);
    const bool rests =
        std::ranges::all_of(states, [](std::uint8_t state) { return state == detached_state || state == sticking_state; });
    const bool touches = std::ranges::any_of(states, [](std::uint8_t state) { return state != detached_state; });
    if (!rests || (s == holding && !touches)) return false;
  }
  return true;
}

// First and last index of the longest interval of `rows` in which the reference holds the
// body; equal if there is none.
std::pair<std::size_t, std::size_t> longest_hold(const TrialRecord& reference, const Rows& rows, const HeldPair& pair) {
  std::pair<std::size_t, std::size_t> longest{0, 0};
  const auto length = [&](const auto& stretch) {
    return reference.body_time[rows[stretch.second].second] - reference.body_time[rows[stretch.first].second];
  };
  const std::size_t none = rows.size();
  std::size_t first = none;  // of the current interval
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!holds_at(reference, pair.sensor, reference.body_time[rows[i].second])) {
      first = none;
      continue;
    }
    if (first == none) first = i;
    if (const std::pair stretch{first, i}; length(stretch) > length(longest)) longest = stretch;
  }
  return longest;
}

std::optional<MeasureError> creep_error(const Scene& scene, const TrialRecord& run, const TrialRecord& reference) {
  MeasureValues values;
  const Rows rows = common_rows(run.body_time, reference.body_time);
  if (rows.empty()) return std::nullopt;
  for (const HeldPair& pair : held_pairs(scene, reference)) {
    const auto [first, last] = longest_hold(reference, rows, pair);
    const double time = reference.body_time[rows[last].second] - reference.body_time[rows[first].second];
    if (time < least_hold) continue;
    const Eigen::Vector3d drift = place_on_pad(run, pair, rows[last].first) - place_on_pad(run, pair, rows[first].first);
    const Eigen::Vector3d reference_drift =
        place_on_pad(reference, pair, rows[last].second) - place_on_pad(reference, pair, rows[first].second);
    values.add((drift - reference_drift).norm() / time);
  }
  return values.error();
}

std::vector<Both> paired(const TrialRecord& run, const TrialRecord& reference) {
  if (run.sensors.size() != reference.sensors.size()) throw std::invalid_argument("the two runs have different sensors");
  std::vector<Both> sensors;
  for (std::size_t i = 0; i < run.sensors.size(); ++i) {
    if (run.sensors[i].name != reference.sensors[i].name) {
      throw std::invalid_argument(
          fmt::format("sensor {} is '{}' in one run and '{}' in the other", i, run.sensors[i].name, reference.sensors[i].name));
    }
    sensors.push_back({run.sensors[i], reference.sensors[i]});
  }
  return sensors;
}

constexpr double shortest_stride = 1e-7;  // s: two closer crossings of a limit are not distinguished
constexpr std::size_t most_strides = 2'000'000;
constexpr double kept_depth = 1e-12;  // m
constexpr int looks_between = 256;    // samples of the motion between a unit's first onset and its last
constexpr double never = std::numeric_limits<double>::quiet_NaN();

// A function of time whose slope is at most `slope` per second.
struct Bounded {
  std::function<double(double)> value;
  double slope;
};

// Time at which the function, negative or 0 at `from`, first exceeds 0 on the way to `to`, which
// may be earlier; NaN: never. Each stride is at most as long as the bound on the slope allows, so
// no crossing is missed, except for a pair closer than shortest_stride. `strides`: remaining
// number, 0 if there were too few.
double first_above_zero(const Bounded& f, double from, double to, std::size_t& strides) {
  const double sense = to < from ? -1.0 : 1.0;
  double before = from;
  for (double value = f.value(from); strides > 0; --strides) {
    if (value > 0.0) break;
    if (before == to) return never;
    double next = before + sense * std::max(-value / f.slope, shortest_stride);
    if ((to - next) * sense < 0.0) next = to;
    value = f.value(next);
    if (value > 0.0) {
      double under = before, over = next;
      while (true) {
        const double middle = 0.5 * (under + over);
        if (middle == under || middle == over) return over;
        (f.value(middle) > 0.0 ? over : under) = middle;
      }
    }
    before = next;
  }
  return strides == 0 ? never : before;
}

// One element of a pad in prescribed motion over a plane.
class PrescribedElement {
 public:
  PrescribedElement(const Element& element, const Motion& motion, const Pose& world_in_surface, double mu, double speed)
      : element_(element), motion_(motion), world_in_surface_(world_in_surface), mu_(mu), speed_(speed) {}

  [[nodiscard]] Eigen::Vector3d tip(double t) const { return world_in_surface_ * (motion_.pad_at(t).pose * element_.tip); }
  [[nodiscard]] double depth(double t) const { return std::max(0.0, -tip(t).z()); }
  // Spring force minus `share` of the friction limit [N], for an element stuck at `anchor`.
  [[nodiscard]] double excess(double t, const Eigen::Vector2d& anchor, double share) const {
    const Eigen::Vector3d place = tip(t);
    const double press = std::max(0.0, -place.z());
    return element_.k_tangential * (place.head<2>() - anchor).norm() - share * mu_ * element_.k_normal * press;
  }

  // Searches from t = 0. `strides` as in first_above_zero().
  ClosedForm::Onset first_onset(double end, std::size_t& strides) const {
    const Bounded depth_of{[this](double t) { return -tip(t).z(); }, speed_};
    for (double t = 0.0;;) {
      const double touch = first_above_zero(depth_of, t, end, strides);
      if (std::isnan(touch)) return {};
      const Eigen::Vector2d anchor = tip(touch).head<2>();
      const double slope = (element_.k_tangential + mu_ * element_.k_normal) * speed_;
      const Bounded over{[&](double at) { return excess(at, anchor, 1.0); }, slope};
      const Bounded leaves{[this](double at) { return tip(at).z(); }, speed_};
      std::size_t strides_out = strides;
      const double out = first_above_zero(leaves, touch, end, strides_out);
      const double onset = first_above_zero(over, touch, std::isnan(out) ? end : out, strides);
      strides = std::min(strides, strides_out);
      if (!std::isnan(onset) && depth(onset) > 0.0) {
        // Back to the time at which half of the friction limit was used.
        const Bounded under_half{[&](double at) { return -excess(at, anchor, 0.5); }, slope};
        const double half = first_above_zero(under_half, onset, touch, strides);
        return {onset, std::max(least_load_time, std::isnan(half) ? onset - touch : 2.0 * (onset - half))};
      }
      if (std::isnan(out)) return {};
      t = out;
    }
  }

  // True if from `first` to `last` the tip keeps its depth and its direction of motion turns by
  // less than 90 degrees.
  [[nodiscard]] bool goes_on(double first, double last) const {
    const auto velocity = [&](double t) {
      const BodyState pad = motion_.pad_at(t);
      const Eigen::Vector3d arm = pad.pose.rotation * element_.tip;
      return Eigen::Vector3d(world_in_surface_.rotation * (pad.velocity + pad.angular_velocity.cross(arm)));
    };
    const Eigen::Vector2d at_first = velocity(first).head<2>();
    const double pressed = depth(first);
    for (int i = 0; i <= looks_between; ++i) {
      const double t = first + (last - first) * i / looks_between;
      if (!(velocity(t).head<2>().dot(at_first) > 0.0) || std::abs(depth(t) - pressed) > kept_depth) return false;
    }
    return true;
  }

 private:
  const Element& element_;
  const Motion& motion_;
  const Pose& world_in_surface_;
  double mu_, speed_;
};

// True if the pad's elements are pure springs whose axes always point at the plane.
bool has_closed_form(const PadLayout& pad, const Motion& motion, const Pose& world_in_surface, double duration) {
  return std::ranges::all_of(pad.elements, [&](const Element& element) {
    if (element.c_normal != 0.0 || element.c_tangential != 0.0) return false;
    for (int i = 0; i <= looks_between; ++i) {
      const Eigen::Matrix3d& turned = motion.pad_at(duration * i / looks_between).pose.rotation;
      if (!((world_in_surface.rotation * turned * element.axis).z() < 0.0)) return false;
    }
    return true;
  });
}

// True if `a` is the later of two onsets; NaN is the latest.
bool is_later(const ClosedForm::Onset& a, const ClosedForm::Onset& b) {
  return (std::isnan(a.time) && !std::isnan(b.time)) || a.time > b.time;
}

// Empty if the unit has no closed form.
std::optional<ClosedForm::Unit> solve_unit(const std::vector<PrescribedElement>& elements, double end) {
  std::size_t strides = most_strides;
  std::vector<ClosedForm::Onset> onsets;
  for (const PrescribedElement& element : elements) onsets.push_back(element.first_onset(end, strides));
  if (strides == 0) return std::nullopt;
  // Elements that never touch do not count for the slip of the whole unit; elements that touch
  // after the first onset count from their touch on.
  ClosedForm::Unit unit;
  unit.micro = *std::ranges::min_element(onsets, [](const auto& a, const auto& b) { return is_later(b, a); });
  if (elements.size() == 1 || std::isnan(unit.micro.time)) {
    unit.whole = unit.micro;
    return unit;
  }
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const bool touches = elements[i].depth(unit.micro.time) > 0.0;
    if (touches && (std::isnan(unit.whole.time) || is_later(onsets[i], unit.whole))) unit.whole = onsets[i];
    if (touches && std::isnan(onsets[i].time)) {
      unit.whole = {};
      break;
    }
  }
  const double last = std::isnan(unit.whole.time) ? end : unit.whole.time;
  const bool all_go_on =
      std::ranges::all_of(elements, [&](const PrescribedElement& element) { return element.goes_on(unit.micro.time, last); });
  return all_go_on ? std::optional(unit) : std::nullopt;
}

}  // namespace

std::span<const MeasureInfo, num_measures> measure_table() { return measures; }
const MeasureInfo& info_of(Measure measure) { return measures.at(static_cast<std::size_t>(measure)); }

std::vector<std::pair<std::size_t, std::size_t>> common_rows(std::span<const double> a, std::span<const double> b) {
  Rows rows;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (std::abs(a[i] - b[j]) <= time_rounding) {
      rows.emplace_back(i++, j++);
    } else {
      ++(a[i] < b[j] ? i : j);
    }
  }
  return rows;
}

double load_time(std::span<const double> times, std::span<const float> margin, double time) {
  std::size_t end = 0;  // number of samples before `time`
  while (end < times.size() && times[end] < time) ++end;
  if (end == 0) return least_load_time;
  const auto at_sample = [&](std::size_t i) { return static_cast<double>(margin[i]); };
  const std::size_t last = end - 1;
  const double half = 0.5 * (1.0 + at_sample(last));
  std::size_t k = last;
  while (k > 0 && at_sample(k) < half) --k;  // a detached unit's NaN ends the loop too
  double load = time - times[k];
  if (k < last && at_sample(k) >= half) {
    const double share = (at_sample(k) - half) / (at_sample(k) - at_sample(k + 1));
    load = time - times[last] + 2.0 * (times[last] - times[k] - share * (times[k + 1] - times[k]));
  }
  return std::max(least_load_time, load);
}

Errors compare(const Scene& scene, const TrialResult& run, const TrialResult& reference) {
  const std::vector<Both> sensors = paired(run.record, reference.record);
  Errors errors;
  at(errors, Measure::onset) = onset_error(sensors, &LabelRecord::onset_time, false, scene.duration);
  at(errors, Measure::micro_onset) = onset_error(sensors, &LabelRecord::micro_onset_time, true, scene.duration);
  at(errors, Measure::slip_distance) = slip_distance_error(sensors);
  at(errors, Measure::force) = force_error(sensors);
  at(errors, Measure::creep) = creep_error(scene, run.record, reference.record);
  at(errors, Measure::label) = state_error(sensors, &LabelRecord::unit_state, true);
  at(errors, Measure::label_micro) = state_error(sensors, &LabelRecord::state_micro, false);
  at(errors, Measure::outcome) = outcome_error(run.record, reference.record);
  at(errors, Measure::detector) = detector_error(run.record, reference.record);
  at(errors, Measure::signal) = signal_error(sensors);
  return errors;
}

void keep_worst(Errors& errors, const Errors& other) {
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!other[i]) continue;
    if (!errors[i]) {
      errors[i] = other[i];
      continue;
    }
    errors[i]->worst = std::max(errors[i]->worst, other[i]->worst);
    errors[i]->median = std::max(errors[i]->median, other[i]->median);
    errors[i]->different = errors[i]->different || other[i]->different;
  }
}

std::optional<ClosedForm> closed_form(const Scene& scene, std::uint64_t trial) {
  const double mu = scene.friction.static_coefficient;
  if (scene.dynamic() || scene.surface.name != "plane" || !scene.effects.empty() || !(mu > 0.0)) return std::nullopt;
  const StageSetup stage = set_up_stage(scene, trial);
  const Pose world_in_surface = stage.surface.pose.inverse();
  ClosedForm exact;
  for (const SensorScene& description : scene.sensors) {
    const std::unique_ptr<Sensor> sensor = make_sensor(description, scene.seed, trial);
    const PadLayout& pad = sensor->layout();
    const double speed = stage.motion->top_speed(reach_of(pad));
    if (!(speed > 0.0) || !has_closed_form(pad, *stage.motion, world_in_surface, scene.duration)) return std::nullopt;
    exact.units.emplace_back();
    for (const UnitRange& range : pad.units) {
      std::vector<PrescribedElement> elements;
      for (std::size_t i = range.first; i < range.first + range.count; ++i) {
        elements.emplace_back(pad.elements[i], *stage.motion, world_in_surface, mu, speed);
      }
      const std::optional<ClosedForm::Unit> unit = solve_unit(elements, scene.duration);
      if (!unit) return std::nullopt;
      exact.units.back().push_back(*unit);
    }
  }
  return exact;
}

Errors compare(const Scene& scene, const TrialResult& run, const ClosedForm& exact) {
  MeasureValues micro, whole;
  for (std::size_t s = 0; s < exact.units.size(); ++s) {
    const LabelRecord& labels = run.record.sensors.at(s).labels;
    for (std::size_t u = 0; u < exact.units[s].size(); ++u) {
      const ClosedForm::Unit& unit = exact.units[s][u];
      micro.add_onsets(labels.micro_onset_time.at(u), unit.micro.time, unit.micro.load_time, scene.duration);
      whole.add_onsets(labels.onset_time.at(u), unit.whole.time, unit.whole.load_time, scene.duration);
    }
  }
  Errors errors;
  at(errors, Measure::onset) = whole.error();
  at(errors, Measure::micro_onset) = micro.error();
  return errors;
}

}  // namespace slipbench
