#include <array>
#include <charconv>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/program/export/papillarray_csv.h"

namespace slipbench {
namespace {

constexpr std::size_t centre = 4;

// The vendor's software calls a pillar in contact from this reported force on [N].
constexpr float contact_force = 0.5F;

// True tangential force from which a pillar counts as loaded [N]: the device's resolution.
constexpr double loaded_force = 0.05;

enum class VendorState : int { untouched = -2, contact_lost = -1, contact = 1, loaded = 2, slipped = 3 };

void append_header(fmt::memory_buffer& text, std::size_t sensors) {
  auto out = std::back_inserter(text);
  fmt::format_to(out, "T_us");
  for (std::size_t s = 0; s < sensors; ++s) {
    for (std::size_t p = 0; p < pillars; ++p) {
      for (const char* column : {"DX", "DY", "DZ", "FX", "FY", "FZ"}) fmt::format_to(out, ",S{}_P{}_{}", s, p, column);
    }
    for (const char* column : {"FX", "FY", "FZ", "TX", "TY", "TZ"}) fmt::format_to(out, ",S{}_GG_{}", s, column);
    fmt::format_to(out, ",S{0}_isSDActive,S{0}_isRefLoad", s);
    for (std::size_t p = 0; p < pillars; ++p) fmt::format_to(out, ",S{0}_P{1}_isInContact,S{0}_P{1}_slipState", s, p);
    fmt::format_to(out, ",S{}_FrictionEst", s);
  }
  text.push_back('\n');
}

// Force of all pillars, and their torque about the deformed tip of the centre pillar [N, N mm].
std::array<double, 6> global_load(const PapillarraySamples& samples, std::size_t row) {
  const auto deformed_tip = [&](std::size_t pillar) {
    std::array<double, 3> tip = samples.tip(pillar);
    const std::array<float, 3> displacement = samples.displacement(row, pillar);
    for (std::size_t axis = 0; axis < 3; ++axis) tip[axis] += displacement[axis];
    return tip;
  };
  const std::array<double, 3> reference = deformed_tip(centre);
  std::array<double, 6> load{};
  for (std::size_t p = 0; p < pillars; ++p) {
    const std::array<float, 3> force = samples.force(row, p);
    std::array<double, 3> arm = deformed_tip(p);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      arm[axis] = 1e3 * (arm[axis] - reference[axis]);
      load[axis] += force[axis];
    }
    load[3] += arm[1] * force[2] - arm[2] * force[1];
    load[4] += arm[2] * force[0] - arm[0] * force[2];
    load[5] += arm[0] * force[1] - arm[1] * force[0];
  }
  return load;
}

VendorState vendor_state(const PapillarraySamples& samples, std::size_t row, std::size_t pillar, bool touched_before) {
  if (!samples.touching(row, pillar)) return touched_before ? VendorState::contact_lost : VendorState::untouched;
  if (samples.slipping(row, pillar)) return VendorState::slipped;
  return samples.tangential_force(row, pillar) >= loaded_force ? VendorState::loaded : VendorState::contact;
}

void append_sensor(fmt::memory_buffer& text, const PapillarraySamples& samples, std::size_t row,
                   std::array<bool, pillars>& touched_before) {
  auto out = std::back_inserter(text);
  for (std::size_t p = 0; p < pillars; ++p) {
    for (const float metres : samples.displacement(row, p)) fmt::format_to(out, ",{}", millimetres(metres));
    for (const float newtons : samples.force(row, p)) fmt::format_to(out, ",{}", newtons);
  }
  for (const double value : global_load(samples, row)) fmt::format_to(out, ",{}", static_cast<float>(value));
  const bool reference_loaded = samples.touching(row, centre) && samples.tangential_force(row, centre) >= loaded_force;
  fmt::format_to(out, ",1,{}", reference_loaded ? 1 : 0);
  for (std::size_t p = 0; p < pillars; ++p) {
    fmt::format_to(out, ",{},{}", samples.force(row, p)[2] >= contact_force ? 1 : 0,
                   static_cast<int>(vendor_state(samples, row, p, touched_before[p])));
    touched_before[p] = touched_before[p] || samples.touching(row, p);
  }
  fmt::format_to(out, ",-1");  // the device's own friction estimate is not simulated: none
}

}  // namespace

std::string millimetres(float metres) {
  const double exact = 1e3 * static_cast<double>(metres);
  // Those of the nearest float32 in mm; as float32 lies more densely in m than in mm here and there, they may belong to a neighbour.
  std::string text = fmt::format("{}", static_cast<float>(exact));
  double back = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), back);
  return static_cast<float>(back / 1e3) == metres ? text : fmt::format("{:.9g}", exact);
}

bool begins_as_vendor_csv(std::string_view text) { return text.starts_with("T_us,S0_P0_DX,"); }

std::string vendor_csv(const std::vector<PapillarraySamples>& sensors) {
  if (sensors.size() > 2) throw InputError(fmt::format("the vendor's log holds up to 2 sensors, found {}", sensors.size()));
  std::vector<std::array<bool, pillars>> touched(sensors.size());
  fmt::memory_buffer text;
  append_header(text, sensors.size());
  for (std::size_t row = 0; row < sensors[0].size(); ++row) {
    fmt::format_to(std::back_inserter(text), "{}", std::llround(1e6 * sensors[0].time(row)));
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      if (sensors[s].size() != sensors[0].size() || sensors[s].time(row) != sensors[0].time(row)) {
        throw InputError("the vendor's log has one time for all sensors; those of this trial are sampled at different times");
      }
      append_sensor(text, sensors[s], row, touched[s]);
    }
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

}  // namespace slipbench
