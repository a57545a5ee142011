#include "tools/benchmark/submission.h"

// Reads, writes and compares submissions.
#include <algorithm>

#include <fmt/format.h>

#include "tools/benchmark/protocol.h"
#include "tools/dataset/trial_difference.h"
#include "tools/files/reject.h"

namespace slipbench::benchmark {
namespace {

std::string found(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

// Replaces each number of `recomputed` by that of `submitted` if both agree within the tolerance.
void adopt_close_numbers(const Json& submitted, Json& recomputed) {
  if (submitted.is_number_float() && recomputed.is_number_float()) {
    if (agree(submitted.get<double>(), recomputed.get<double>(), 0.0)) recomputed = submitted;
  } else if (submitted.is_object() && recomputed.is_object()) {
    for (auto& [key, value] : recomputed.items()) {
      if (submitted.contains(key)) adopt_close_numbers(submitted.at(key), value);
    }
  } else if (submitted.is_array() && recomputed.is_array()) {
    for (std::size_t i = 0; i < std::min(submitted.size(), recomputed.size()); ++i)
      adopt_close_numbers(submitted[i], recomputed[i]);
  }
}

}  // namespace

Json request_json(const BoardRequest& request) {
  Json parameters = Json::array();
  for (const Override& change : request.parameters) parameters.push_back({change.path, change.value});
  return {{"detectors", request.detectors},
          {"set", parameters},
          {"real", request.real},
          {"sensor", request.sensor},
          {"trials", request.trials}};
}

BoardRequest parse_request(const Json& json, const std::string& file) {
  try {
    BoardRequest request;
    request.detectors = json.at("detectors").get<std::vector<std::string>>();
    for (const Json& change : json.at("set")) request.parameters.push_back({change.at(0), change.at(1)});
    request.real = json.at("real").get<std::vector<std::string>>();
    request.sensor = json.at("sensor").get<std::string>();
    request.trials = json.at("trials").get_ref<const Json::number_unsigned_t&>();  // rejects -1 and 1e300
    return request;
  } catch (const Json::exception& error) {
    reject("{}: /asked: {}; expected a file that benchmark --submit wrote", file, error.what());
  }
}

std::string submission_text(const Json& result) { return result.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

Json parse_submission(const std::string& text, const std::string& name) {
  constexpr int deepest = 100;  // comparison recurses so deep
  const auto bounded = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > deepest)
      reject("{}: is nested more than {} levels deep; expected a file that benchmark --submit wrote", name, deepest);
    return true;
  };
  const Json json = Json::parse(text, bounded, false);
  if (!json.is_object() || !json.contains(result_key) || !json.contains("asked") || !json.contains("protocol"))
    throw InputError(name + " is not a submission; expected a file that benchmark --submit wrote");
  const Json& protocol = json.at("protocol");
  if (!protocol.is_object() || !protocol.contains("name") || !protocol.at("name").is_string())
    throw InputError(name + ": /protocol/name is missing or not a text; expected a file that benchmark --submit wrote");
  const Protocol known = find_protocol(protocol.at("name").get<std::string>(), name);
  const std::string here = protocol_sha256(known);
  const std::string there = protocol.contains("sha256") ? found(protocol.at("sha256")) : "nothing";
  if (there != found(here))
    reject("{}: /protocol/sha256: {} in the file, but {} for {} in this program", name, there, found(here), known.name);
  return json;
}

std::string difference(const std::string& text, const Json& submitted, Json recomputed) {
  if (submitted.contains("machine")) recomputed["machine"] = submitted.at("machine");
  // The sentences on real recordings are text for the page, not results.
  const Json::json_pointer real("/protocol/real");
  if (submitted.contains(real) && recomputed.contains(real)) recomputed[real] = submitted.at(real);
  adopt_close_numbers(submitted, recomputed);
  if (submission_text(recomputed) == text) return "";
  for (const Json& change : Json::diff(submitted, recomputed)) {
    const std::string path = change.at("path").get<std::string>();
    const Json::json_pointer place(path);
    const std::string before = submitted.contains(place) ? found(submitted.at(place)) : "nothing";
    const std::string now = recomputed.contains(place) ? found(recomputed.at(place)) : "nothing";
    return fmt::format("{}: {} in the file, but {} recomputed", path, before, now);
  }
  const std::string here = submission_text(recomputed);
  const auto [a, b] = std::ranges::mismatch(text, here);
  return fmt::format("byte {}: the same values, but written differently", a - text.begin());
}

}  // namespace slipbench::benchmark
