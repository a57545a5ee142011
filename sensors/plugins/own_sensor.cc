#include "sensors/plugins/own_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/core/counted.h"
#include "sim/core/error.h"

namespace slipbench {
namespace {

// The names of a channel's values: "force_3_0".
std::vector<std::string> value_names(const Channel& channel) {
  std::vector<std::string> names{channel.name};
  for (const std::size_t extent : channel.shape) {
    std::vector<std::string> longer;
    for (const std::string& name : names) {
      for (std::size_t i = 0; i < extent; ++i) longer.push_back(name + "_" + std::to_string(i));
    }
    names = std::move(longer);
  }
  return names;
}

}  // namespace

void OwnSensor::refuse(const std::string& what) const { throw SceneValueError(where_, subject_ + " " + what); }

void OwnSensor::set(OwnLayout layout) {
  if (!(layout.rate > 0.0) || std::isinf(layout.rate))
    refuse("has a rate of " + format_number(layout.rate) + " Hz; it must be finite and above 0 Hz");
  std::vector<Element>& elements = layout.elements;
  if (elements.empty() || elements.size() > OwnLayout::most_elements)
    refuse("has a layout of " + counted(elements.size(), "element") + "; allowed: 1 to " +
           std::to_string(OwnLayout::most_elements));
  for (std::size_t i = 0; i < elements.size(); ++i) {
    Element& element = elements[i];
    const std::size_t unit = layout.units.at(i), units = layout_.units.size();
    const auto bad = [&](const std::string& problem) {
      refuse("has a layout in which element " + std::to_string(i) + " " + problem);
    };
    if (element.axis.isZero(0.0)) element.axis = Element{}.axis;
    if (!element.tip.allFinite()) bad("has a tip that is not finite");
    if (!(std::abs(element.axis.norm() - 1.0) < 1e-6)) bad("has a direction that is not a unit vector");
    element.axis.normalize();
    for (const double k : {element.k_normal, element.k_tangential}) {
      if (!(k > 0.0) || std::isinf(k)) bad("has a stiffness of " + format_number(k) + " N/m; it must be finite and above 0 N/m");
    }
    if (unit > units || unit + 1 < units)
      bad("belongs to unit " + std::to_string(unit) + ", but unit " + std::to_string(units) +
          " would be next; units are numbered from 0 without gaps");
    if (unit == units) layout_.units.push_back({i, 0});
    ++layout_.units.back().count;
  }
  if (layout.channels.empty() || layout.channels.size() > OwnLayout::most_channels)
    refuse("has " + counted(layout.channels.size(), "channel") + "; allowed: 1 to " + std::to_string(OwnLayout::most_channels));
  std::size_t size = 0;
  for (Channel& channel : layout.channels) {
    const auto bad = [&](const std::string& problem) { refuse("has the channel " + quote(channel.name) + " " + problem); };
    if (!is_identifier(channel.name) || channel.name == "t")
      bad("with an invalid name; allowed: letters, digits and '_', no digit first, and not t, the name of the times");
    if (std::ranges::count(layout.channels, channel.name, &Channel::name) != 1) bad("twice");
    double values = 1.0;
    for (const std::size_t extent : channel.shape) values *= static_cast<double>(extent);
    if (channel.shape.empty() || channel.shape.size() > OwnLayout::most_dimensions || !(values >= 1.0) ||
        values + static_cast<double>(size) > static_cast<double>(OwnLayout::most_values))
      bad("with an invalid shape; allowed: 1 to 8 extents and up to " + std::to_string(OwnLayout::most_values) +
          " values per sample");
    channel.channel_names = value_names(channel);
    size += channel.size();
  }
  rate_ = layout.rate;
  layout_.elements = std::move(elements);
  layout_.element_truth = true;
  channels_ = std::move(layout.channels);
  values_.resize(size);
  frame_.values = values_;
}

const SensorFrame& OwnSensor::measure(const ContactFrame& truth) {
  std::ranges::fill(values_, std::numeric_limits<float>::quiet_NaN());
  read(truth, values_);
  std::span<const float> values = values_;
  for (const Channel& channel : channels_) {
    const auto own = values.first(channel.size());
    const auto bad = std::ranges::find_if(own, [](float value) { return !std::isfinite(value); });
    if (bad != own.end())
      refuse("returns in measure " + format_number(static_cast<double>(*bad)) + " for " +
             channel.channel_names[static_cast<std::size_t>(bad - own.begin())] + " at " + format_number(truth.time) +
             " s; it must be finite");
    values = values.subspan(own.size());
  }
  frame_.time = truth.time;
  return frame_;
}

}  // namespace slipbench
