#include "tools/verify/verification.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "sim/api/contact_frame.h"
#include "sim/core/math.h"
#include "tools/dataset/record/encoder.h"

namespace slipbench::verify {
namespace {

struct About {
  const char* name;
  const char* items;  // counted items
};
constexpr std::array<About, 8> about{{{"digests", "trials"},
                                      {"order", "trials"},
                                      {"times", "samples"},
                                      {"values", "values"},
                                      {"events", "samples of units"},
                                      {"cone", "samples of units"},
                                      {"slip", "samples of units"},
                                      {"contact", "samples of units"}}};

constexpr double of_a_sample = 1e-6;

void check_rising(const std::vector<double>& times, std::optional<double> rate, const Where& where, Verification& verification) {
  verification.count(Check::times, times.size());
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double step = times[i] - times[i - 1];
    const Where here{where.trial, where.array, i};
    if (!(step > 0.0)) {
      verification.fail(Check::times, here, fmt::format("{} s after {} s", times[i], times[i - 1]));
    } else if (rate && !(std::abs(step * *rate - 1.0) <= of_a_sample)) {
      verification.fail(Check::times, here,
                        fmt::format("{} s after the previous sample, but {} s by rate_hz", step, 1.0 / *rate));
    }
  }
}

// Checks the values of a column: finite, except that row i may be NaN if `nan(i)`, and must be NaN
// then if `always`.
template <class T, class Nan>
void check_finite(const std::vector<T>& values, std::size_t rows, const Where& where, Verification& verification, const Nan& nan,
                  bool always = false) {
  verification.count(Check::values, values.size());
  bool finite = true;  // without a branch, since nearly all values are finite
  for (const T value : values) finite = finite & (std::abs(value) <= std::numeric_limits<T>::max());
  if (finite && !always) return;
  const std::size_t width = rows == 0 ? 1 : std::max<std::size_t>(1, values.size() / rows);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]) && !(always && nan(i))) continue;
    if (std::isnan(values[i]) && nan(i)) continue;
    verification.fail(Check::values, {where.trial, where.array, i / width},
                      fmt::format("value {} of the row is {}", i % width, static_cast<double>(values[i])));
  }
}

constexpr auto never = [](std::size_t) { return false; };

// State of a unit after an event of each kind.
constexpr std::array<UnitState, 6> state_after{UnitState::stick,    UnitState::slip,    UnitState::stick,
                                               UnitState::detached, UnitState::partial, UnitState::partial};

// True if an event of `kind` can happen to a unit in `state`.
bool can_follow(UnitState state, EventKind kind) {
  switch (kind) {
    case EventKind::touch: return state == UnitState::detached;
    case EventKind::micro: return state == UnitState::stick;
    case EventKind::slip: return state == UnitState::partial;  // after micro, at the latest at the same time
    case EventKind::stick: return state == UnitState::slip || state == UnitState::partial;
    case EventKind::part_sticks: return state == UnitState::slip;
    case EventKind::detach: return state != UnitState::detached;
  }
  return false;
}

// For each unit the first time of an event whose kind `counts`.
template <class Counts>
std::vector<double> first_times(const LabelRecord& labels, const Counts& counts) {
  std::vector<double> first(labels.units(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t e = 0; e < labels.event_time.size(); ++e) {
    if (counts(static_cast<EventKind>(labels.event_kind[e])))
      first[labels.event_unit[e]] = std::fmin(first[labels.event_unit[e]], labels.event_time[e]);
  }
  return first;
}

class EventCheck {
 public:
  EventCheck(const SensorRecord& sensor, std::size_t trial, Verification& verification)
      : labels_(sensor.labels),
        time_(sensor.time),
        group_(label_group(sensor.name) + "/"),
        trial_(trial),
        verification_(verification) {}

  bool run() {
    if (!events_are_sound()) return false;
    check_onsets("onset_time_s", labels_.onset_time,
                 first_times(labels_, [](EventKind kind) { return kind == EventKind::slip; }));
    check_onsets("micro_onset_time_s", labels_.micro_onset_time,
                 first_times(labels_, [](EventKind kind) { return kind == EventKind::slip || kind == EventKind::micro; }));
    for (std::size_t unit = 0; unit < labels_.units(); ++unit) check_unit(unit);
    check_pad();
    return true;
  }

 private:
  void fail(const char* array, std::optional<std::size_t> sample, const std::string& what) {
    verification_.fail(Check::events, {trial_, group_ + array, sample}, what);
  }

  bool events_are_sound() {
    bool sound = true;
    const auto refuse = [&](const char* array, std::size_t event, const std::string& what) {
      fail(array, event, what);
      sound = false;
    };
    for (std::size_t e = 0; e < labels_.event_time.size(); ++e) {
      if (labels_.event_kind[e] >= state_after.size())
        refuse("events/kind", e, fmt::format("{} is not a kind of event", labels_.event_kind[e]));
      if (labels_.event_unit[e] >= labels_.units())
        refuse("events/unit", e, fmt::format("{} is not a unit", labels_.event_unit[e]));
      if (!std::isfinite(labels_.event_time[e])) refuse("events/t", e, fmt::format("{} is not a time", labels_.event_time[e]));
      if (e > 0 && labels_.event_time[e] < labels_.event_time[e - 1])
        refuse("events/t", e, fmt::format("{} s after {} s", labels_.event_time[e], labels_.event_time[e - 1]));
    }
    return sound;
  }

  void check_onsets(const char* name, const std::vector<double>& written, const std::vector<double>& first) {
    for (std::size_t unit = 0; unit < first.size(); ++unit) {
      if (written[unit] == first[unit] || (std::isnan(written[unit]) && std::isnan(first[unit]))) continue;
      fail("events/t", std::nullopt,
           fmt::format("unit {}: {} is {} s, but its first such event is at {} s", unit, name, written[unit], first[unit]));
    }
  }

  // Each event of a unit must be possible after the unit's previous one.
  void check_sequence(const std::vector<std::size_t>& events) {
    UnitState state = UnitState::detached;
    for (const std::size_t e : events) {
      const auto kind = static_cast<EventKind>(labels_.event_kind[e]);
      if (!can_follow(state, kind)) {
        fail("events/kind", e,
             fmt::format("unit {}: {} is not possible in the state {}", labels_.event_unit[e], labels_.event_kind[e],
                         static_cast<int>(state)));
      }
      state = state_after[labels_.event_kind[e]];
    }
  }

  // The state of each sample must be that after the last event before it.
  void check_unit(std::size_t unit) {
    std::vector<std::size_t> events;
    for (std::size_t e = 0; e < labels_.event_time.size(); ++e) {
      if (labels_.event_unit[e] == unit) events.push_back(e);
    }
    check_sequence(events);
    std::size_t before = 0, until = 0;  // events certainly before the sample, and those possibly before it
    for (std::size_t row = 0; row < time_.size(); ++row) {
      while (before < events.size() && labels_.event_time[events[before]] <= time_[row] - same_instant) ++before;
      while (until < events.size() && labels_.event_time[events[until]] <= time_[row] + same_instant) ++until;
      const auto state = labels_.unit_state[row * labels_.units() + unit];
      bool fits = false;
      for (std::size_t k = before; k <= until && !fits; ++k) {
        const UnitState left = k == 0 ? UnitState::detached : state_after[labels_.event_kind[events[k - 1]]];
        fits = state == static_cast<std::uint8_t>(left);
      }
      if (!fits)
        fail("unit_state", row, fmt::format("unit {}: is {} at {} s, which contradicts its events", unit, state, time_[row]));
    }
    verification_.count(Check::events, time_.size());
  }

  void check_pad() {
    const std::size_t units = labels_.units();
    for (std::size_t row = 0; row < time_.size(); ++row) {
      const std::span<const std::uint8_t> states(labels_.unit_state.data() + row * units, units);
      const auto at_least = [&](UnitState state) {
        return static_cast<std::size_t>(
            std::ranges::count_if(states, [state](std::uint8_t value) { return value >= static_cast<std::uint8_t>(state); }));
      };
      const std::size_t touching = at_least(UnitState::stick), micro = at_least(UnitState::slip);
      const auto whole = static_cast<std::size_t>(std::ranges::count(states, static_cast<std::uint8_t>(UnitState::slip)));
      // For a pad of a single unit the rules strict and micro are the same.
      const auto expected = static_cast<std::uint8_t>(pad_state(touching, micro));
      if (units > 1 && labels_.state[row] != static_cast<std::uint8_t>(pad_state(touching, whole)))
        fail("state", row,
             fmt::format("is {}, but {} by unit_state", labels_.state[row], static_cast<int>(pad_state(touching, whole))));
      if (units == 1 && labels_.state[row] != labels_.state_micro[row])
        fail("state", row,
             fmt::format("is {}, but the state_micro of the single unit is {}", labels_.state[row], labels_.state_micro[row]));
      if (units > 1 && labels_.state_micro[row] != expected)
        fail("state_micro", row, fmt::format("is {}, but {} by unit_state", labels_.state_micro[row], expected));
    }
  }

  const LabelRecord& labels_;
  const std::vector<double>& time_;
  std::string group_;
  std::size_t trial_;
  Verification& verification_;
};

// The slip's translation is the mean velocity of the units that slip, as a whole or in part
// (sim/contact/unit_rules.h). If it is negligible against the fastest unit, as at the rim of a dome
// that is pressed straight and spreads to all sides, it has no direction. Velocities are float32.
constexpr double no_motion = 1e-6, rounding_of_velocity = 2e-7;

void check_slip_direction(const LabelRecord& labels, const Where& where, Verification& verification) {
  const std::size_t units = labels.units();
  verification.count(Check::values, labels.slip_direction.size());
  for (std::size_t row = 0; row < labels.slip_direction.size(); ++row) {
    double x = 0.0, y = 0.0, slipping = 0.0, fastest = 0.0;
    for (std::size_t i = row * units; i < (row + 1) * units; ++i) {
      if (labels.unit_state[i] < static_cast<std::uint8_t>(UnitState::slip)) continue;
      const double vx = static_cast<double>(labels.slip_velocity[2 * i]),
                   vy = static_cast<double>(labels.slip_velocity[2 * i + 1]);
      x += vx;
      y += vy;
      slipping += 1.0;
      fastest = std::max(fastest, math::hypot(vx, vy));
    }
    const double speed = slipping > 0.0 ? math::hypot(x, y) / slipping : 0.0;
    const double direction = static_cast<double>(labels.slip_direction[row]);
    const auto fail = [&](const std::string& what) { verification.fail(Check::values, {where.trial, where.array, row}, what); };
    if (std::isfinite(direction)) {
      if (!(speed > (no_motion - rounding_of_velocity) * fastest))
        fail(fmt::format("is {} rad, but the slipping units have a mean velocity of {} m/s", direction, speed));
    } else if (!std::isnan(direction) || speed > (no_motion + rounding_of_velocity) * fastest) {
      fail(fmt::format("is {}, but the slipping units have a mean velocity of {} m/s", direction, speed));
    }
  }
}

// Checks that each entry is a state of a pad.
void check_codes(const std::vector<std::uint8_t>& states, const Where& where, Verification& verification) {
  verification.count(Check::values, states.size());
  for (std::size_t row = 0; row < states.size(); ++row) {
    if (states[row] > static_cast<std::uint8_t>(PadState::gross))
      verification.fail(Check::values, {where.trial, where.array, row}, fmt::format("{} is not a state of a pad", states[row]));
  }
}

// A pose's quaternion is a rotation, rounded to float32.
void check_rotations(const BodyRecord& body, const Where& where, Verification& verification) {
  constexpr double rounded = 1e-6;  // four components of at most 1, each with an error of 6e-8
  for (std::size_t row = 0; row < body.pose.size() / 7; ++row) {
    double squares = 0.0;
    for (std::size_t k = 3; k < 7; ++k)
      squares += static_cast<double>(body.pose[7 * row + k]) * static_cast<double>(body.pose[7 * row + k]);
    if (std::isfinite(squares) && std::abs(squares - 1.0) > rounded)
      verification.fail(Check::values, {where.trial, where.array, row},
                        fmt::format("the quaternion has the length {}, not 1", std::sqrt(squares)));
  }
}

void check_label_values(const SensorRecord& sensor, std::size_t trial, Verification& verification) {
  const LabelRecord& labels = sensor.labels;
  const std::size_t units = labels.units(), rows = sensor.time.size();
  const auto at = [&](const char* name) { return Where{trial, label_group(sensor.name) + "/" + name}; };
  const auto touches = [&](std::size_t row) { return labels.state[row] != static_cast<std::uint8_t>(PadState::no_contact); };
  check_finite(labels.slip_velocity, rows, at("slip_velocity"), verification, never);
  check_finite(labels.slip_distance, rows, at("slip_distance"), verification, never);
  check_finite(labels.force, rows, at("force"), verification, never);
  check_finite(labels.slip_angle, rows, at("slip_angle"), verification, never);
  check_finite(
      labels.margin, rows, at("margin"), verification,
      [&](std::size_t i) { return labels.unit_state[i] == static_cast<std::uint8_t>(UnitState::detached); }, true);
  check_finite(
      labels.stuck_fraction, rows, at("stuck_fraction"), verification, [&](std::size_t row) { return !touches(row); }, true);
  check_slip_direction(labels, at("slip_direction"), verification);
  // NaN here also means that the slip does not rotate.
  check_finite(labels.slip_centre, rows, at("slip_centre"), verification, [](std::size_t) { return true; });
  for (const auto& [name, values] : {std::pair{"unit_positions", &labels.unit_positions},
                                     {"unit_heights", &labels.unit_heights},
                                     {"k_normal", &labels.k_normal},
                                     {"k_tangential", &labels.k_tangential},
                                     {"mu_static", &labels.mu_static},
                                     {"mu_kinetic", &labels.mu_kinetic}})
    check_finite(*values, units, at(name), verification, never);
  for (std::size_t i = 0; i < labels.unit_state.size(); ++i) {
    if (labels.unit_state[i] > static_cast<std::uint8_t>(UnitState::partial))
      verification.fail(Check::values, {trial, at("unit_state").array, i / units},
                        fmt::format("{} is not a state of a unit", labels.unit_state[i]));
  }
  check_codes(labels.state_paper, at("state_paper"), verification);
  const auto attribute = [&](const char* name, std::size_t unit, double value, bool holds) {
    if (!holds) verification.fail(Check::values, at(name), fmt::format("unit {}: is {}", unit, value));
  };
  for (std::size_t unit = 0; unit < units; ++unit) {
    attribute("k_normal", unit, labels.k_normal[unit], labels.k_normal[unit] > 0.0);
    attribute("k_tangential", unit, labels.k_tangential[unit], labels.k_tangential[unit] > 0.0);
    attribute("mu_kinetic", unit, labels.mu_kinetic[unit], labels.mu_kinetic[unit] >= 0.0);
    attribute("mu_static", unit, labels.mu_static[unit], labels.mu_static[unit] >= labels.mu_kinetic[unit]);
  }
}

}  // namespace

void Verification::leave_out(Check check, const std::string& why) {
  std::vector<std::string>& said = entry_of(check).left_out;
  if (std::ranges::find(said, why) == said.end()) said.push_back(why);
}

void Verification::fail(Check check, const Where& where, const std::string& what) {
  Entry& entry = entry_of(check);
  if (entry.failed++ >= listed) return;
  entry.failures.push_back({{"check", about[static_cast<std::size_t>(check)].name},
                            {"trial", or_null(where.trial)},
                            {"array", where.array.empty() ? Json(nullptr) : Json(where.array)},
                            {"sample", or_null(where.sample)},
                            {"what", what}});
}

void Verification::add(const Json& later) {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry& entry = entries_[i];
    const Json& check = later["checks"][i];
    entry.checked += check["checked"].get<std::size_t>();
    entry.failed += check["failed"].get<std::size_t>();
    for (const Json& why : check["left_out"]) leave_out(static_cast<Check>(i), why.get<std::string>());
    for (const Json& failure : later["failures"]) {
      if (failure["check"] == about[i].name && entry.failures.size() < listed) entry.failures.push_back(failure);
    }
  }
}

bool Verification::holds() const {
  return std::ranges::all_of(entries_, [](const Entry& entry) { return entry.failed == 0; });
}

Json Verification::json() const {
  Json checks = Json::array(), failures = Json::array();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    checks.push_back({{"check", about[i].name},
                      {"checked", entry.checked},
                      {"of", about[i].items},
                      {"failed", entry.failed},
                      {"left_out", entry.left_out}});
    for (const Json& failure : entry.failures) failures.push_back(failure);
  }
  return {{"holds", holds()}, {"checks", std::move(checks)}, {"failures", std::move(failures)}};
}

void check_times(const TrialRecord& record, Verification& verification) {
  for (const SensorRecord& sensor : record.sensors) {
    // Imported recordings keep their recorded steps.
    const auto rate = sensor.labels.truth ? std::optional(sensor.rate) : std::nullopt;
    if (rate && !(*rate > 0.0 && std::isfinite(*rate)))
      verification.fail(Check::times, {record.trial, sensor_group(sensor.name)}, fmt::format("rate_hz is {}", *rate));
    check_rising(sensor.time, rate, {record.trial, sensor_group(sensor.name) + "/t"}, verification);
    for (const SensorColumn& channel : sensor.channels) {
      if (channel.time)
        check_rising(*channel.time, std::nullopt, {record.trial, sensor_group(sensor.name) + "/" + own_time_path(channel.name)},
                     verification);
    }
  }
  if (!record.bodies.empty())
    check_rising(record.body_time, std::nullopt, {record.trial, body_group(record.bodies.front().name) + "/t"}, verification);
}

void check_values(const TrialRecord& record, Verification& verification) {
  for (const SensorRecord& sensor : record.sensors) {
    // A recording imported with `missing: nan` has NaN for values that its source lacks.
    const auto missing = [recorded = !sensor.labels.truth](std::size_t) { return recorded; };
    for (const SensorColumn& channel : sensor.channels) {
      const std::size_t rows = channel.time ? channel.time->size() : sensor.time.size();
      check_finite(channel.values, rows, {record.trial, sensor_group(sensor.name) + "/" + channel.name}, verification, missing);
    }
    if (sensor.labels.truth) check_label_values(sensor, record.trial, verification);
  }
  for (const BodyRecord& body : record.bodies) {
    check_finite(body.pose, record.body_time.size(), {record.trial, body_group(body.name) + "/pose"}, verification, never);
    check_rotations(body, {record.trial, body_group(body.name) + "/pose"}, verification);
    check_finite(body.velocity, record.body_time.size(), {record.trial, body_group(body.name) + "/velocity"}, verification,
                 never);
  }
  if (record.control) {
    const std::size_t rows = record.control->time.size();
    check_finite(record.control->grip.grip_force, rows, {record.trial, "control/grip_force"}, verification, never);
    check_finite(record.control->grip.arm, rows, {record.trial, "control/arm_speed"}, verification, never);
    check_codes(record.control->detector_class, {record.trial, "control/detector_class"}, verification);
  }
}

bool check_events(const SensorRecord& sensor, std::size_t trial, Verification& verification) {
  return EventCheck(sensor, trial, verification).run();
}

void check_outcome(const TrialRecord& record, Verification& verification) {
  double touch = std::numeric_limits<double>::quiet_NaN(), micro = touch, distance = 0.0;
  for (const SensorRecord& sensor : record.sensors) {
    if (!sensor.follows.empty()) continue;
    const LabelRecord& labels = sensor.labels;
    for (const double time : first_times(labels, [](EventKind kind) { return kind == EventKind::touch; }))
      touch = std::fmin(touch, time);
    for (const double time : labels.micro_onset_time) micro = std::fmin(micro, time);
    for (const float slipped : labels.slip_distance) distance = std::max(distance, static_cast<double>(slipped));
  }
  const auto fail = [&](const char* key, double written, double found) {
    verification.fail(Check::events, {record.trial, fmt::format("outcome/{}", key)},
                      fmt::format("is {}, but {} by the labels", written, found));
  };
  const auto differ = [](double a, double b) { return a != b && !(std::isnan(a) && std::isnan(b)); };
  const TrialOutcome& outcome = record.outcome;
  if (differ(outcome.touch_time, touch)) fail("touch_time_s", outcome.touch_time, touch);
  if (differ(outcome.first_micro_slip_time, micro)) fail("first_micro_slip_time_s", outcome.first_micro_slip_time, micro);
  // Labels are float32.
  if (distance > outcome.max_slip_distance * (1.0 + 0x1p-23) + 0x1p-149)
    fail("max_slip_distance_m", outcome.max_slip_distance, distance);
}

}  // namespace slipbench::verify
