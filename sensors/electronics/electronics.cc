#include "sensors/electronics/electronics.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sensors/electronics/part_kind.h"
#include "sim/core/error.h"
#include "sim/core/random.h"

namespace slipbench {
namespace {

const std::vector<PartKind>& part_kinds() {
  static const std::vector<PartKind> kinds = [] {
    std::vector<PartKind> all{low_pass_part(), scan_part()};
    for (PartKind& part : drawn_once_parts()) all.push_back(std::move(part));
    for (const auto part : {noise_part, white_noise_part, skewed_noise_part, quantisation_part, valid_range_part})
      all.push_back(part());
    return all;
  }();
  return kinds;
}

const PartKind& kind_of(const std::string& name) {
  const auto found = std::ranges::find(part_kinds(), name, [](const PartKind& kind) { return kind.entry.name; });
  if (found == part_kinds().end()) throw std::logic_error("electronics have no part '" + name + "'");
  return *found;
}

}  // namespace

ParameterSpec scale_parameter() {
  return number_spec("scale", Quantity::none, "1", non_negative, "Factor on the device's own figure.", "1: as measured");
}

Electronics::Electronics(const std::vector<Named>& parts, const SignalModel& model, const ElectronicsKey& key) {
  const std::string path = "sensors." + key.sensor_name + ".electronics";
  for (auto part = parts.begin(); part != parts.end(); ++part) {
    const PartKind& kind = kind_of(part->name);
    if (std::any_of(parts.begin(), part, [&](const Named& earlier) { return earlier.name == part->name; })) {
      throw SceneValueError(path, "part '" + part->name + "' is listed twice; name it once and use its scale");
    }
    if (kind.check != nullptr) kind.check(part->parameters, model, path + "." + part->name);
    const std::uint64_t drawn_for = kind.drawn_per == DrawnPer::device ? key.device : key.trial;
    stages_.push_back(kind.make(part->parameters, model,
                                RandomStream(key.seed, drawn_for, "electronics." + key.sensor_name + "." + part->name)));
    if (stages_.back()->works_between_samples() && stages_.size() > 1)
      throw SceneValueError(path, "part '" + part->name + "' comes after '" + parts.front().name +
                                      "'; it must come first, because it filters the signal before the converter samples it");
  }
}

std::vector<std::span<double>> Electronics::memory() const {
  std::vector<std::span<double>> memories;
  for (const auto& stage : stages_) {
    if (const std::span<double> memory = stage->memory(); !memory.empty()) memories.push_back(memory);
  }
  return memories;
}

std::uint64_t Electronics::saturated() const {
  std::uint64_t samples = 0;
  for (const auto& stage : stages_) samples += stage->saturated();
  return samples;
}

std::span<const float> Electronics::range_flags() const {
  for (const auto& stage : stages_) {
    if (const std::span<const float> flags = stage->range_flags(); !flags.empty()) return flags;
  }
  return {};
}

bool draws_numbers(const std::string& part) { return kind_of(part).drawn_per != DrawnPer::never; }

std::vector<Entry> electronics_of(const std::string& device, const std::vector<PartFigures>& figures) {
  std::vector<Entry> entries;
  for (const PartFigures& own : figures) {
    Entry entry = kind_of(own.part).entry;
    entry.source = device + ": " + own.source + ". General: " + entry.source;
    for (const PartFigures::Default& value : own.defaults) {
      const auto spec = std::ranges::find(entry.parameters, value.parameter, &ParameterSpec::name);
      if (spec == entry.parameters.end())
        throw std::logic_error(device + ": no parameter " + value.parameter + " of " + own.part);
      spec->default_text = value.text;
      spec->source = value.source;
    }
    entry.parameters = joined(std::move(entry.parameters), own.parameters);
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace slipbench
