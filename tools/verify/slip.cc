#include "tools/verify/slip.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "sim/api/contact_frame.h"
#include "tools/dataset/record/encoder.h"

namespace slipbench::verify {
namespace {

class SlipCheck {
 public:
  SlipCheck(bool counts_creep, const SensorRecord& sensor, std::size_t trial, Verification& verification)
      : counts_creep_(counts_creep),
        labels_(sensor.labels),
        units_(sensor.labels.units()),
        time_(sensor.time),
        group_(label_group(sensor.name) + "/"),
        trial_(trial),
        verification_(verification) {}

  void run() {
    verification_.count(Check::slip, labels_.unit_state.size());
    std::vector<bool> eventful(units_);
    std::size_t next = 0;  // first event that may lie after the last sample
    for (std::size_t row = 0; row < time_.size(); ++row) {
      // An event at the instant of a sample may count before or after it.
      eventful.assign(units_, false);
      while (next < labels_.event_time.size() && row > 0 && labels_.event_time[next] < time_[row - 1] - same_instant) ++next;
      for (std::size_t e = next; e < labels_.event_time.size() && labels_.event_time[e] <= time_[row] + same_instant; ++e)
        eventful[labels_.event_unit[e]] = true;
      bool rests = true;  // the whole pad, since the last sample
      for (std::size_t unit = 0; unit < units_; ++unit) {
        const bool unit_rests = !eventful[unit] && !slips(row, unit) && (row == 0 || !slips(row - 1, unit));
        check_unit(row, unit, unit_rests);
        rests = rests && unit_rests;
      }
      check_pad(row, rests);
    }
  }

 private:
  [[nodiscard]] UnitState state(std::size_t row, std::size_t unit) const {
    return static_cast<UnitState>(labels_.unit_state[row * units_ + unit]);
  }
  [[nodiscard]] bool slips(std::size_t row, std::size_t unit) const {
    const UnitState now = state(row, unit);
    return now == UnitState::slip || now == UnitState::partial;
  }

  void check_unit(std::size_t row, std::size_t unit, bool rests) {
    const std::size_t i = row * units_ + unit;
    const float vx = labels_.slip_velocity[2 * i], vy = labels_.slip_velocity[2 * i + 1];
    if (!slips(row, unit) && (vx != 0.0F || vy != 0.0F)) {
      fail(row, "slip_velocity",
           fmt::format("unit {}: is ({}, {}) m/s, but the unit {}", unit, vx, vy,
                       state(row, unit) == UnitState::stick ? "sticks" : "is detached"));
    }
    const float distance = labels_.slip_distance[i], before = row == 0 ? 0.0F : labels_.slip_distance[i - units_];
    if (distance < before) {
      fail(row, "slip_distance", fmt::format("unit {}: falls from {} m to {} m", unit, before, distance));
    } else if (distance > before && rests && !counts_creep_) {
      fail(row, "slip_distance", fmt::format("unit {}: grows from {} m to {} m while no part slips", unit, before, distance));
    }
  }

  void check_pad(std::size_t row, bool rests) {
    const float angle = labels_.slip_angle[row], before = row == 0 ? 0.0F : labels_.slip_angle[row - 1];
    if (rests && angle != before) {
      fail(row, "slip_angle", fmt::format("changes from {} rad to {} rad while no unit slips", before, angle));
    }
    std::size_t touching = 0, slipping = 0, whole = 0;
    for (std::size_t unit = 0; unit < units_; ++unit) {
      touching += state(row, unit) != UnitState::detached ? 1 : 0;
      slipping += slips(row, unit) ? 1 : 0;
      whole += state(row, unit) == UnitState::slip ? 1 : 0;
    }
    const bool centred = !std::isnan(labels_.slip_centre[2 * row]) || !std::isnan(labels_.slip_centre[2 * row + 1]);
    if (slipping == 0 && centred) fail(row, "slip_centre", "is not NaN, but no unit slips");
    const float stuck = labels_.stuck_fraction[row];
    const auto wrong = [&](const char* expected) {
      fail(row, "stuck_fraction",
           fmt::format("is {}; expected {}: {} of {} touching units slip, {} of them as a whole", stuck, expected, slipping,
                       touching, whole));
    };
    if (touching == 0) return;  // NaN, which check_values() demands
    if (slipping == 0 && stuck != 1.0F) wrong("1");
    if (whole == touching && stuck != 0.0F) wrong("0");
    if (slipping > 0 && whole < touching && !(stuck > 0.0F && stuck < 1.0F)) wrong("between 0 and 1");
  }

  void fail(std::size_t row, const char* array, const std::string& what) {
    verification_.fail(Check::slip, {trial_, group_ + array, row}, what);
  }

  bool counts_creep_;
  const LabelRecord& labels_;
  std::size_t units_;
  const std::vector<double>& time_;
  std::string group_;
  std::size_t trial_;
  Verification& verification_;
};

}  // namespace

void check_slip(std::string_view fidelity, const SensorRecord& sensor, std::size_t trial, Verification& verification) {
  const bool counts_creep = fidelity == "mujoco_contact";
  if (counts_creep)
    verification.leave_out(Check::slip,
                           "constant slip_distance: with fidelity mujoco_contact it includes the creep of stuck units");
  SlipCheck(counts_creep, sensor, trial, verification).run();
}

}  // namespace slipbench::verify
