// The format csv: tables of one's own, told by a column map in YAML.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/error.h"
#include "sim/core/parameters.h"
#include "sim/scene/parser.h"
#include "sim/scene/section_readers.h"
#include "tools/program/import/source_table.h"

namespace slipbench {
namespace {

// A map of the column map with these keys.
class Block {
 public:
  Block(const YamlNode& node, std::string where, const std::vector<std::string_view>& keys)
      : node_(node), where_(std::move(where)) {
    require_map(node, where_, fmt::format("{}", fmt::join(keys, ", ")));
    check_keys(node, where_, keys);
  }
  [[nodiscard]] bool has(std::string_view key) const { return node_.find(key) != nullptr; }
  [[nodiscard]] std::string path(std::string_view key) const { return fmt::format("{}.{}", where_, key); }
  [[nodiscard]] const YamlNode& at(std::string_view key) const {
    if (!has(key)) fail(node_.origin, fmt::format("{} has no key '{}'; allowed: one that has", where_, key));
    return *node_.find(key);
  }
  [[nodiscard]] std::string text(std::string_view key) const {
    const std::string& text = text_of(at(key), path(key), "a text");
    if (!is_plain_name(text)) fail(at(key).origin, path(key) + " is " + quote(text) + "; allowed: a text of one line");
    return text;
  }
  // The spec's default where nothing is said.
  template <class Value>
  [[nodiscard]] Value value(const ParameterSpec& spec) const {
    return std::get<Value>(has(spec.name) ? scalar(at(spec.name), path(spec.name), spec) : default_of(spec));
  }

 private:
  const YamlNode& node_;
  std::string where_;
};

// Of every cell.
ParameterSpec scale_spec(Range allowed) { return number_spec("scale", Quantity::none, "1", allowed, "", ""); }

struct MappedChannel {
  SensorColumn column;              // without values
  double scale = 1.0;               // of a cell
  std::size_t components = 1;       // the last extent
  std::vector<std::string> titles;  // of columns, or "A .. B": A, B and all between them
};

struct ColumnMap {
  SensorRecord sensor;      // without channels and samples
  std::string time, state;  // titles; no state: empty
  double time_scale = 1.0;  // s
  std::vector<MappedChannel> channels;
};

MappedChannel channel_of(const YamlNode& node) {
  const Block block(node, "channels." + node.key, {"columns", "components", "scale", "unit"});
  if (!is_identifier(node.key) || node.key == "t")
    fail(node.key_origin, quote(node.key) + " is no channel's name; allowed: letters, digits and '_', no digit first, not t");
  MappedChannel channel;
  channel.column.name = node.key;
  channel.column.unit = block.text("unit");
  channel.scale = block.value<double>(scale_spec(any_value));
  channel.components = static_cast<std::size_t>(block.value<std::int64_t>(integer_spec("components", "1", {1.0, 1e6}, "", "")));
  const YamlNode& columns = block.at("columns");
  if (columns.kind != YamlNode::Kind::sequence || columns.children.empty())
    fail(columns.origin,
         block.path("columns") + " is " + described(columns) + "; allowed: titles, or FIRST .. LAST, in a sequence");
  for (const YamlNode& title : columns.children) channel.titles.push_back(text_of(title, block.path("columns"), "a title"));
  return channel;
}

ColumnMap read_map(const std::string& path) {
  const SceneFile file = SceneFile::load(path);
  const Block root(file.root(), "the column map", {"channels", "sensor", "state", "time", "type"});
  const Block time(root.at("time"), "time", {"column", "scale"});
  ColumnMap map;
  map.sensor.name = root.text("sensor");
  if (!is_identifier(map.sensor.name))
    fail(root.at("sensor").origin, quote(map.sensor.name) + " is no name; allowed: letters, digits and '_', no digit first");
  map.sensor.type = root.text("type");
  map.sensor.frame = "as the recordings' own tables have it";
  map.sensor.labels.truth = false;
  map.time = time.text("column");
  map.time_scale = time.value<double>(scale_spec(positive));
  require_map(root.at("channels"), "channels", "channels by their names");
  if (root.at("channels").children.empty()) fail(root.at("channels").origin, "channels is empty; allowed: one at least");
  for (const YamlNode& channel : root.at("channels").children) map.channels.push_back(channel_of(channel));
  if (!root.has("state")) return map;
  const Block state(root.at("state"), "state", {"column", "rule"});
  map.state = state.text("column");
  map.sensor.labels.rule = state.text("rule");
  return map;
}

std::size_t place_of(const SourceTable& table, const std::vector<std::string>& titles, const std::string& title) {
  const auto found = std::ranges::find(titles, title);
  if (found == titles.end()) table.fail("has no column " + quote(title) + allowed_names(title, titles));
  if (std::find(found + 1, titles.end(), title) != titles.end())
    table.fail("has two columns " + quote(title) + "; allowed: different titles of those that the map names");
  return static_cast<std::size_t>(found - titles.begin());
}

// Of a channel's columns, in the order of its values.
std::vector<std::size_t> places_of(const SourceTable& table, const std::vector<std::string>& titles,
                                   const MappedChannel& channel) {
  constexpr std::string_view to = " .. ";
  std::vector<std::size_t> places;
  for (const std::string& title : channel.titles) {
    const std::size_t dots = title.find(to), first = place_of(table, titles, title.substr(0, dots)),
                      last = dots == std::string::npos ? first : place_of(table, titles, title.substr(dots + to.size()));
    if (last < first) table.fail(quote(title) + " goes backwards; allowed: the first column first");
    for (std::size_t place = first; place <= last; ++place) places.push_back(place);
  }
  if (places.size() % channel.components != 0)
    table.fail(fmt::format("has {} columns for channel {}; allowed: a multiple of its {} components", places.size(),
                           channel.column.name, channel.components));
  return places;
}

}  // namespace

void read_mapped_csv(const SourceFile& file, const AddRecording& add) {
  if (file.map.empty())
    throw InputError("the format csv is told by a column map; allowed: slipbench import --format csv --map FILE.yaml");
  const ColumnMap map = read_map(file.map);
  SourceTable table(file);
  if (!table.next()) table.fail("the file is empty; allowed: a header and a row a sample");
  const std::vector<std::string> titles(table.cells().begin(), table.cells().end());
  const std::size_t time = place_of(table, titles, map.time), state = map.state.empty() ? 0 : place_of(table, titles, map.state);
  SensorRecord sensor = map.sensor;
  std::vector<std::vector<std::size_t>> places;
  for (const MappedChannel& channel : map.channels) {
    const std::vector<std::size_t>& own = places.emplace_back(places_of(table, titles, channel));
    SensorColumn& column = sensor.channels.emplace_back(channel.column);
    column.shape = {own.size() / channel.components};
    if (channel.components > 1) column.shape.push_back(channel.components);
    for (const std::size_t place : own) sensor.channel_names.push_back(titles[place]);
  }
  double resolution = std::numeric_limits<double>::infinity();  // s
  while (table.next()) {
    table.expect_cells(titles.size());
    table.expect_room(sensor.time.size() + 1, sizeof(double) + titles.size() * sizeof(float));
    const double latest = 1e10 / map.time_scale;  // beyond any clock's
    const double now = map.time_scale * table.number(time, map.time, -latest, latest);
    if (!sensor.time.empty() && !(now > sensor.time.back()))
      table.fail(
          fmt::format("column {}, {}, is {} s after {} s; allowed: rising times", time + 1, map.time, now, sensor.time.back()));
    sensor.time.push_back(now);
    resolution = std::min(resolution, map.time_scale * resolution_of(table.cells()[time]));
    for (std::size_t c = 0; c < places.size(); ++c) {
      const double scale = map.channels[c].scale, most = std::numeric_limits<float>::max() / std::max(1.0, std::abs(scale));
      for (const std::size_t place : places[c])
        sensor.channels[c].values.push_back(static_cast<float>(scale * table.number(place, titles[place], -most, most)));
    }
    constexpr std::array<int, 4> states{0, 1, 2, 3};
    if (!map.state.empty())
      sensor.labels.state_paper.push_back(static_cast<std::uint8_t>(table.one_of(state, map.state, states)));
  }
  set_timing(table, resolution, sensor);
  TrialRecord record = make_recording({{"file", file.name}}, "");
  record.body_time = sensor.time;
  record.sensors.push_back(std::move(sensor));
  add(std::move(record), 0);
}

}  // namespace slipbench
