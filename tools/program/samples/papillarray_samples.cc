#include "tools/program/samples/papillarray_samples.h"

#include <cmath>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

const std::vector<float>& channel_of(const SensorRecord& record, const std::string& name) {
  for (const SensorColumn& channel : record.channels) {
    if (channel.name == name && channel.shape == std::vector<std::size_t>{pillars, 3}) return channel.values;
  }
  throw InputError(fmt::format("sensor {}: has no channel '{}' of {} pillars", record.name, name, pillars));
}

}  // namespace

PapillarraySamples::PapillarraySamples(const SensorRecord& record, SlipRule rule, double label_speed)
    : record_(&record), rule_(rule), label_speed_(label_speed) {
  if (record.type != "papillarray") {
    throw InputError(fmt::format("sensor {}: is a {}, this format holds a papillarray", record.name, record.type));
  }
  if (record.labels.units() != pillars) {
    throw InputError(fmt::format("sensor {}: labels of {} units, expected {}", record.name, record.labels.units(), pillars));
  }
  force_ = &channel_of(record, "force");
  displacement_ = &channel_of(record, "displacement");
  if (rule != SlipRule::has_slipped) return;
  has_slipped_.resize(size() * pillars);
  for (std::size_t row = 0; row < size(); ++row) {
    for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
      const std::size_t place = row * pillars + pillar;
      const bool before = row > 0 && has_slipped_[place - pillars] != 0;
      has_slipped_[place] = (before && touching(row, pillar)) || fast(row, pillar) ? 1 : 0;
    }
  }
}

bool PapillarraySamples::fast(std::size_t row, std::size_t pillar) const {
  const float* velocity = record_->labels.slip_velocity.data() + (row * pillars + pillar) * 2;
  return touching(row, pillar) && std::hypot(velocity[0], velocity[1]) > label_speed_;
}

bool PapillarraySamples::slipping(std::size_t row, std::size_t pillar) const {
  const UnitState state = this->state(row, pillar);
  switch (rule_) {
    case SlipRule::strict: return state == UnitState::slip;
    case SlipRule::micro: return state == UnitState::slip || state == UnitState::partial;
    case SlipRule::paper: return fast(row, pillar);
    case SlipRule::has_slipped: return has_slipped_[row * pillars + pillar] != 0;
  }
  return false;
}

PadState PapillarraySamples::pad_state(std::size_t row, bool turning) const {
  bool in_contact = false;
  std::size_t judged = 0;
  std::size_t slipped = 0;
  for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
    if (!touching(row, pillar)) continue;
    in_contact = true;
    if (turning && pillar == middle_pillar) continue;
    ++judged;
    if (slipping(row, pillar)) ++slipped;
  }
  if (!in_contact) return PadState::no_contact;
  if (slipped == 0) return PadState::non_slip;
  return slipped == judged ? PadState::gross : PadState::incipient;
}

double PapillarraySamples::tangential_force(std::size_t row, std::size_t pillar) const {
  const auto [x, y, z] = triple(record_->labels.force, row, pillar);
  return std::hypot(x, y);
}

std::array<double, 3> PapillarraySamples::tip(std::size_t pillar) const {
  const LabelRecord& labels = record_->labels;
  return {labels.unit_positions[2 * pillar], labels.unit_positions[2 * pillar + 1], labels.unit_heights[pillar]};
}

std::vector<std::string> papillarrays_of(const DatasetReader& reader, std::size_t trial) {
  reader.check_recorded(trial);
  std::vector<std::string> names;
  for (const std::string& name : reader.sensors(trial)) {
    if (reader.sensor_type(trial, name) == "papillarray") names.push_back(name);
  }
  if (names.empty()) throw InputError(fmt::format("trial {}: has no papillarray, which is what this format holds", trial));
  return names;
}

}  // namespace slipbench
