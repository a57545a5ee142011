#include "detectors/network/description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "detectors/spectral/spectral_features.h"
#include "sim/api/pad_state_names.h"
#include "sim/core/choice.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"

namespace slipbench::network {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_bytes = 16u << 20u;   // of the text
constexpr int deepest = 32;                      // nested objects and arrays
constexpr double most_rate = 1e9;                // Hz
constexpr std::size_t most_samples = 1'000'000;  // of a window, a stride, a median, a history
constexpr std::size_t most_values = 1'000'000;   // of a sample, an image, a frame
constexpr std::size_t most_classes = 1000;
constexpr std::size_t most_states = 1000;

constexpr std::array transforms{
    Choice<Transform>{"samples", Transform::samples},     Choice<Transform>{"log_psd", Transform::log_psd},
    Choice<Transform>{"amplitude", Transform::amplitude}, Choice<Transform>{"spreads", Transform::spreads},
    Choice<Transform>{"levels", Transform::levels},       Choice<Transform>{"units", Transform::units}};
constexpr std::array outputs{Choice<Output>{"logits", Output::logits}, Choice<Output>{"probabilities", Output::probabilities}};

constexpr std::array<std::pair<const char*, std::size_t Alarm::*>, 3> alarm_keys{
    {{"on", &Alarm::on}, {"off", &Alarm::off}, {"least", &Alarm::least}}};

bool is_spectrum(Transform transform) { return transform == Transform::log_psd || transform == Transform::amplitude; }

bool reads_single_samples(const Input& input) { return input.window == 1 && input.median == 1; }

// Returns a short form of a JSON value for messages.
std::string shown(const Json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  if (value.is_string()) return quote(value.get_ref<const std::string&>());
  return value.dump();
}

// A JSON object in which unknown keys are errors.
class Object {
 public:
  Object(const Json& json, std::string subject, std::string path, const std::vector<std::string_view>& known)
      : json_(json), subject_(std::move(subject)), path_(std::move(path)) {
    if (!json.is_object()) refuse("", shown(json) + "; expected an object");
    for (const auto& [key, value] : json.items()) {
      if (std::ranges::find(known, key) == known.end()) refuse("", "unknown key " + quote(key) + allowed_names(key, known));
    }
  }

  // Throws InputError with "FILE: input.rate: " and `what`.
  [[noreturn]] void refuse(const std::string& key, const std::string& what) const {
    const std::string at = where(key);
    throw InputError(subject_ + ": " + (at.empty() ? "" : at + ": ") + what);
  }

  [[nodiscard]] bool has(const std::string& key) const { return json_.contains(key); }

  const Json& need(const std::string& key) const {
    if (!has(key)) refuse("", "has no key '" + key + "', which is required");
    return json_.at(key);
  }

  [[nodiscard]] std::string text(const std::string& key) const {
    const Json& value = need(key);
    if (!value.is_string() || value.get_ref<const std::string&>().empty()) {
      refuse(key, shown(value) + "; expected a non-empty text");
    }
    return value.get<std::string>();
  }

  template <class Words>
  [[nodiscard]] auto choice(const std::string& key, const Words& words) const {
    const std::string word = text(key);
    const auto value = choice_value(words, word);
    if (!value) refuse(key, quote(word) + allowed_names(word, choice_names(words)));
    return *value;
  }

  [[nodiscard]] bool flag(const std::string& key, bool otherwise) const {
    if (!has(key)) return otherwise;
    if (!json_.at(key).is_boolean()) refuse(key, shown(json_.at(key)) + "; allowed: true, false");
    return json_.at(key).get<bool>();
  }

  // Returns a finite number that satisfies `fits`.
  template <class Fits>
  [[nodiscard]] double number(const std::string& key, Fits&& fits, const std::string& allowed) const {
    const Json& value = need(key);
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!std::isfinite(number) || !fits(number)) refuse(key, shown(value) + "; allowed: " + allowed);
    return number;
  }

  [[nodiscard]] std::size_t count(const std::string& key, std::size_t otherwise, std::size_t most) const {
    if (!has(key)) return otherwise;
    return whole(json_.at(key), key, 1, most);
  }

  // Returns the non-negative integers of an array.
  [[nodiscard]] std::vector<std::size_t> indices(const Json& value, const std::string& key) const {
    std::vector<std::size_t> result;
    for (const Json& entry : array(value, key)) result.push_back(whole(entry, key, 0, most_values - 1));
    return result;
  }

  [[nodiscard]] std::vector<double> numbers(const std::string& key) const {
    std::vector<double> result;
    if (!has(key)) return result;
    for (const Json& entry : array(json_.at(key), key)) {
      const double number = entry.is_number() ? entry.get<double>() : std::nan("");
      // Frames are float32.
      if (!(std::abs(number) <= double{std::numeric_limits<float>::max()})) {
        refuse(key, shown(entry) + "; allowed: numbers in the range of float32");
      }
      result.push_back(number);
    }
    return result;
  }

  const Json& array(const Json& value, const std::string& key) const {
    if (!value.is_array()) refuse(key, shown(value) + "; expected an array");
    if (value.size() > most_values) refuse(key, shown(value) + "; allowed: at most " + std::to_string(most_values));
    return value;
  }

  [[nodiscard]] std::string where(const std::string& key) const {
    return path_ + (path_.empty() || key.empty() ? "" : ".") + key;
  }
  [[nodiscard]] const std::string& subject() const { return subject_; }

 private:
  [[nodiscard]] std::size_t whole(const Json& value, const std::string& key, std::size_t least, std::size_t most) const {
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(number >= static_cast<double>(least) && number <= static_cast<double>(most)) || number != std::floor(number)) {
      refuse(key, shown(value) + "; allowed: a whole number, " + std::to_string(least) + " to " + std::to_string(most));
    }
    return static_cast<std::size_t>(number);
  }

  const Json& json_;
  std::string subject_;
  std::string path_;
};

// Refuses repeated keys and unlimited nesting, which nlohmann's parser accepts; its writer then
// recurses without limit.
Json parsed(std::string_view text, const std::string& subject) {
  if (text.size() > most_bytes) {
    throw InputError(subject + ": " + std::to_string(text.size()) + " bytes of JSON; allowed: at most " +
                     std::to_string(most_bytes));
  }
  std::vector<std::set<std::string>> keys;  // of each object that is open
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    if (depth > deepest) throw InputError(subject + ": JSON nested more than " + std::to_string(deepest) + " deep");
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second) {
      throw InputError(subject + ": key " + quote(value.get_ref<const std::string&>()) + " appears twice in one object");
    }
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), watch);
  } catch (const Json::exception& error) {
    throw InputError(subject + ": is not valid JSON: " + printable(error.what()));
  }
}

ChannelPick parse_channel(const Json& json, const Object& input) {
  const Object object(json, input.subject(), input.where("channels"), {"name", "values", "unit"});
  ChannelPick pick{.name = object.text("name"), .values = {}};
  if (object.has("unit")) pick.unit = object.text("unit");
  if (object.has("values")) {
    pick.values = object.indices(object.need("values"), "values");
    if (pick.values.empty())
      object.refuse("values", "an empty array; expected at least one value, or no key 'values' for all values");
  }
  return pick;
}

// Reads the keys that belong to a spectrum.
void parse_spectrum(const Object& object, Input& input) {
  const double half = 0.5 * input.rate;
  const bool spectrum = is_spectrum(input.transform);
  for (const char* key : {"low", "high", "hann"}) {
    if (!spectrum && object.has(key)) object.refuse(key, "needs the transform log_psd or amplitude");
  }
  const bool spans =
      input.transform == Transform::spreads || input.transform == Transform::levels || input.transform == Transform::units;
  if (input.transform != Transform::log_psd && !spans && object.has("floor")) {
    object.refuse("floor", "needs the transform log_psd, spreads, levels or units");
  }
  if (!spans && object.has("spans")) object.refuse("spans", "needs the transform spreads, levels or units");
  if (spans) {
    input.spans = object.indices(object.need("spans"), "spans");
    if (input.spans.empty() || std::ranges::min(input.spans) < 2 || input.window < 2)
      object.refuse("spans", "expected at least one span, and spans and a window of 2 samples or more");
    if (input.centre || object.has("pixels"))
      object.refuse("transform", "the transforms spreads, levels and units cannot be combined with centre and pixels");
    input.floor = object.number(
        "floor", [](double floor) { return floor > 0.0; }, "a number above 0, in the sensor's unit");
  }
  if (!spectrum) return;
  const std::string limits = format_quantity(0.0, Quantity::frequency) + " to " + format_quantity(half, Quantity::frequency) +
                             ", half the rate, as a number of Hz";
  input.low = object.number(
      "low", [&](double f) { return f >= 0.0 && f <= half; }, limits);
  input.high = object.number(
      "high", [&](double f) { return f >= 0.0 && f <= half; }, limits);
  if (bins_within(input.rate, input.window, input.low, input.high).count == 0) {
    object.refuse("high", "no bin of the spectrum lies between " + format_quantity(input.low, Quantity::frequency) + " and " +
                              format_quantity(input.high, Quantity::frequency) + "; the band must contain a multiple of " +
                              readable_quantity(input.rate / static_cast<double>(input.window), Quantity::frequency));
  }
  input.hann = object.flag("hann", false);
  if (input.transform == Transform::log_psd) {
    input.floor = object.number(
        "floor", [](double floor) { return floor > 0.0; }, "a number above 0, in unit^2/Hz");
  }
}

Input parse_input(const Json& json, const std::string& subject) {
  const Object object(json, subject, "input",
                      {"sensor", "rate", "channels", "median", "window", "stride", "centre", "transform", "low", "high", "hann",
                       "floor", "spans", "pixels", "offset", "scale", "history", "rates"});
  Input input;
  input.sensor = object.text("sensor");
  input.rate = object.number(
      "rate", [](double rate) { return rate > 0.0 && rate <= most_rate; }, "a number of Hz above 0, to 1e9");
  for (const Json& channel : object.array(object.need("channels"), "channels")) {
    input.channels.push_back(parse_channel(channel, object));
  }
  if (input.channels.empty()) object.refuse("channels", "an empty array; expected at least one channel");
  input.median = object.count("median", 1, most_samples);
  input.window = object.count("window", 1, most_samples);
  input.stride = object.count("stride", 1, most_samples);
  input.centre = object.flag("centre", false);
  if (object.has("transform")) input.transform = object.choice("transform", transforms);
  parse_spectrum(object, input);
  if (object.has("pixels")) {
    for (const Json& pixel : object.array(object.need("pixels"), "pixels")) {
      input.pixels.push_back(object.indices(pixel, "pixels"));
    }
    if (input.pixels.empty()) object.refuse("pixels", "an empty array; expected at least one pixel, or no key 'pixels'");
  }
  input.offset = object.numbers("offset");
  input.scale = object.numbers("scale");
  input.history = object.count("history", 1, most_samples);
  if (object.has("rates")) {
    const std::vector<double> rates = object.numbers("rates");
    if (rates.size() != 2 || !(rates[0] > 0.0) || rates[1] < rates[0] || rates[1] > most_rate)
      object.refuse("rates", "expected the lowest and the highest rate in Hz, above 0, to 1e9");
    input.slowest = rates[0];
    input.fastest = rates[1];
  }
  return input;
}

std::vector<State> parse_states(const Object& whole) {
  std::vector<State> states;
  for (const Json& entry : whole.array(whole.need("states"), "states")) {
    const Object object(entry, whole.subject(), "states", {"input", "output"});
    const State state{.input = object.text("input"), .output = object.text("output")};
    const auto once = [&](const std::string& key, std::string State::*name) {
      if (std::ranges::find(states, state.*name, name) != states.end()) {
        object.refuse(key, quote(state.*name) + " is listed twice");
      }
    };
    once("input", &State::input);
    once("output", &State::output);
    if (states.size() == most_states) whole.refuse("states", "more than " + std::to_string(most_states) + " states");
    states.push_back(state);
  }
  return states;
}

std::vector<Class> parse_classes(const Object& whole) {
  std::vector<Class> classes;
  const Json& json = whole.array(whole.need("classes"), "classes");
  if (json.size() < 2 || json.size() > most_classes) {
    whole.refuse("classes", shown(json) + "; expected an array of 2 to " + std::to_string(most_classes) + " classes");
  }
  for (const Json& entry : json) {
    const Object object(entry, whole.subject(), "classes", {"name", "state"});
    Class one{.name = object.text("name"), .state = object.choice("state", pad_states)};
    if (std::ranges::find(classes, one.name, &Class::name) != classes.end()) {
      object.refuse("name", quote(one.name) + " is listed twice");
    }
    classes.push_back(std::move(one));
  }
  const auto slipping = std::ranges::count_if(classes, [](const Class& one) { return slips(one.state); });
  if (slipping == 0) whole.refuse("classes", "no class slips; at least one needs the state incipient or gross");
  if (slipping == std::ssize(classes)) {
    whole.refuse("classes", "all classes slip; at least one needs the state no_contact or non_slip");
  }
  return classes;
}

}  // namespace

std::string unit_of_pick(const ChannelPick& pick, const std::string& usual) {
  if (!pick.unit.empty()) return pick.unit;
  if (pick.name == "force") return "N";
  return pick.name == "displacement" ? "m" : usual;
}

double rate_read(const Input& input) {
  return reads_single_samples(input) ? input.rate / static_cast<double>(input.stride) : input.rate;
}

Input at_rate_read(const Input& input) {
  Input same = input;
  if (!reads_single_samples(input)) return same;
  same.rate = rate_read(input);
  same.stride = 1;
  return same;
}

double least_rate(const Input& input) {
  return input.slowest > 0.0 ? std::min(input.slowest, rate_read(input)) : rate_read(input);
}

std::size_t frame_size(const Input& input, std::size_t values) {
  const std::size_t lines = input.pixels.empty() ? values : input.pixels.size();
  if (input.transform == Transform::samples) return input.window * lines;
  if (input.transform == Transform::spreads) return (input.spans.size() + 2) * values;
  if (input.transform == Transform::levels) return (input.spans.size() + 1) * values;
  if (input.transform == Transform::units) return values / 3 * (2 + 3 * input.spans.size());
  return lines * bins_within(input.rate, input.window, input.low, input.high).count;
}

Description parse_description(std::string_view text, const std::string& subject) {
  const Json json = parsed(text, subject);
  Description description;
  const Object object(json, subject, "", {"format", "input", "states", "output", "classes", "threshold", "alarm", "trained"});
  static_cast<void>(object.number(
      "format", [](double format) { return format == 1.0; }, "1"));
  description.input = parse_input(object.need("input"), subject);
  if (object.has("states")) description.states = parse_states(object);
  if (object.has("output")) description.output = object.choice("output", outputs);
  description.classes = parse_classes(object);
  if (object.has("threshold")) {
    description.threshold = object.number(
        "threshold", [](double share) { return share > 0.0 && share <= 1.0; }, "a number above 0, to 1");
  }
  if (object.has("alarm")) {
    const Object alarm(object.need("alarm"), subject, "alarm", {"on", "off", "least"});
    for (const auto& [key, frames] : alarm_keys) description.alarm.*frames = alarm.count(key, 1, most_samples);
  }
  if (object.has("trained")) {
    const Json& trained = object.need("trained");
    if (!trained.is_object()) object.refuse("trained", shown(trained) + "; expected an object");
    description.trained = trained.dump();
  }
  return description;
}

std::string description_text(const Description& description) {
  const Input& input = description.input;
  Json in;
  in["sensor"] = input.sensor;
  in["rate"] = input.rate;
  in["channels"] = Json::array();
  for (const ChannelPick& pick : input.channels) {
    Json channel{{"name", pick.name}};
    if (!pick.values.empty()) channel["values"] = pick.values;
    if (!pick.unit.empty()) channel["unit"] = pick.unit;
    in["channels"].push_back(std::move(channel));
  }
  in["median"] = input.median;
  in["window"] = input.window;
  in["stride"] = input.stride;
  in["centre"] = input.centre;
  in["transform"] = choice_name(transforms, input.transform);
  if (is_spectrum(input.transform)) {
    in["low"] = input.low;
    in["high"] = input.high;
    in["hann"] = input.hann;
  }
  if (input.floor > 0.0) in["floor"] = input.floor;
  if (!input.spans.empty()) in["spans"] = input.spans;
  if (!input.pixels.empty()) in["pixels"] = input.pixels;
  if (!input.offset.empty()) in["offset"] = input.offset;
  if (!input.scale.empty()) in["scale"] = input.scale;
  in["history"] = input.history;
  if (input.fastest > 0.0) in["rates"] = {input.slowest, input.fastest};

  Json json;
  json["format"] = 1;
  json["input"] = std::move(in);
  json["states"] = Json::array();
  for (const State& state : description.states) json["states"].push_back({{"input", state.input}, {"output", state.output}});
  json["output"] = choice_name(outputs, description.output);
  json["classes"] = Json::array();
  for (const Class& one : description.classes) {
    json["classes"].push_back({{"name", one.name}, {"state", choice_name(pad_states, one.state)}});
  }
  json["threshold"] = description.threshold;
  for (const auto& [key, frames] : alarm_keys) json["alarm"][key] = description.alarm.*frames;
  json["trained"] = Json::parse(description.trained);
  return json.dump();
}

std::string example_description() {
  return R"({"format": 1,
 "input": {"sensor": "papillarray", "rate": 1000, "channels": [{"name": "force"}], "window": 40, "stride": 10},
 "classes": [{"name": "hold", "state": "non_slip"}, {"name": "slip", "state": "gross"}]})";
}

}  // namespace slipbench::network
