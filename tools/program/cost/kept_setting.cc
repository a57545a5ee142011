#include "tools/program/cost/kept_setting.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include <unistd.h>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/base/files/output_file.h"
#include "tools/base/record/encoder.h"
#include "tools/base/record/json.h"

namespace slipbench {
namespace {

constexpr int schema = 1;
constexpr std::size_t most_kept = 32;  // settings of one scene, by overrides and seed: the latest

const TextKind kept_kind{"record of settings for a scene's accuracy", [](std::string_view beginning) {
                           return beginning.starts_with("{") &&
                                  beginning.find("\"slipbench_accuracy\"") != std::string_view::npos;
                         }};

Json overrides_as_json(const std::vector<Override>& overrides) {
  Json json = Json::array();
  for (const Override& change : overrides) json.push_back({change.path, change.value});
  return json;
}

std::vector<Override> overrides_of(const Json& json) {
  std::vector<Override> overrides;
  for (const Json& change : json) overrides.push_back({change.at(0).get<std::string>(), change.at(1).get<std::string>()});
  return overrides;
}

Json errors_as_json(const Errors& errors) {
  Json json = Json::object();
  for (const MeasureInfo& info : measure_table()) {
    if (const std::optional<MeasureError>& error = at(errors, info.measure)) {
      json[std::string(info.name)] = {{"worst", error->worst}, {"median", error->median}, {"different", error->different}};
    }
  }
  return json;
}

// What an entry is for: the same in, the same setting out.
Json subject_of(const SceneFile& file, const Scene& scene, const std::vector<Override>& overrides, const PlannedTrials& planned) {
  return {{"version", SLIPBENCH_VERSION},
          {"scene_sha256", text_sha256(file.text())},
          {"model_sha256", scene.model.empty() ? Json(nullptr) : Json(file_sha256(scene.model))},
          {"seed", scene.seed},
          {"trials", {{"asked", planned.asked}, {"of_each_cell", planned.plan.draws()}}},
          {"overrides", overrides_as_json(overrides)}};
}

Json entry_of(const Json& subject, const Scene& scene, const FoundSetting& found) {
  Json wish = Json::object();
  for (const AccuracyScene::Wish& part : scene.accuracy->wishes) wish[part.measure] = part.limit;
  Json looks = Json::array();
  for (const SettingLook& look : found.looks) {
    looks.push_back({{"setting", overrides_as_json(look.overrides)},
                     {"met", look.met},
                     {"errors", errors_as_json(look.errors)},
                     {"failure", look.failure.empty() ? Json(nullptr) : Json(look.failure)}});
  }
  Json entry = {{"subject", subject},
                {"wish", std::move(wish)},
                {"setting", overrides_as_json(found.overrides)},
                {"trials", found.trials},
                {"reference",
                 {{"is", found.reference},
                  {"setting", overrides_as_json(found.reference_overrides)},
                  {"errors", errors_as_json(found.reference_errors)}}},
                {"margin", margin},
                {"looks", std::move(looks)}};
  entry["sha256"] = text_sha256(entry.dump());
  return entry;
}

[[noreturn]] void refuse_to_keep(const std::string& why) {
  throw InputError(
      why +
      "; the setting that meets the scene's wish for accuracy is kept there; allowed: a file that can be written, or no wish: --set accuracy=none runs without");
}

// Refuses where write_text_file would fail. Whether a file can be made is known for sure only once one has been: its name is as
// long as the one that will be.
void check_record(const std::string& path, const std::string& scene_path) {
  try {
    check_text_target(path, {scene_path}, kept_kind);
  } catch (const InputError& error) {
    refuse_to_keep(error.what());
  }
  std::string name = path + "..XXXXXX";
  const int descriptor = ::mkstemp(name.data());
  if (descriptor < 0) refuse_to_keep(fmt::format("cannot write {}: {}", path, std::strerror(errno)));
  ::close(descriptor);
  ::unlink(name.c_str());
}

// The entries of the file; none where there is no file.
Json read_entries(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_type type = std::filesystem::status(path, error).type();
  // Where it cannot even be looked for, writing says why.
  if (type == std::filesystem::file_type::not_found || type == std::filesystem::file_type::none) return Json::array();
  if (type != std::filesystem::file_type::regular) refuse_to_keep(path + ": is no file");
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const auto damaged = [&](const std::string& why) {
    return InputError(
        fmt::format("{}: is no {}: {}; allowed: to remove it, and the setting is looked for anew", path, kept_kind.name, why));
  };
  if (!stream.is_open() || stream.bad()) throw InputError(path + ": cannot be read");
  try {
    const Json json = Json::parse(text);
    if (json.at("slipbench_accuracy") != schema) throw damaged(fmt::format("its slipbench_accuracy is not {}", schema));
    for (Json entry : json.at("settings")) {
      const std::string digest = entry.at("sha256").get<std::string>();
      entry.erase("sha256");
      if (digest != text_sha256(entry.dump())) throw damaged("an entry is not as it was written");
    }
    return json.at("settings");
  } catch (const nlohmann::json::exception& error) {
    throw damaged(error.what());
  }
}

// One line: "accuracy: time_step 0.5 ms; onset 0.12 % of 1 % against the closed form, 5 trials looked at".
std::string line_of(const Json& entry) {
  std::string errors;
  for (const auto& [name, limit] : entry.at("wish").items()) {
    const auto info = std::ranges::find(measure_table(), name, &MeasureInfo::name);
    const Json& last = entry.at("looks").back().at("errors").at(name);
    errors +=
        fmt::format("{}{} off by {}, allowed {}", errors.empty() ? "" : "; ", info->title,
                    error_text(info->measure, last.at("worst").get<double>()), error_text(info->measure, limit.get<double>()));
  }
  const std::size_t trials = entry.at("trials").size();
  return fmt::format("{}: {}, against {}, in {}", setting_text(overrides_of(entry.at("setting"))), errors,
                     entry.at("reference").at("is").get<std::string>(),
                     trials == 1 ? "one trial" : fmt::format("{} trials", trials));
}

}  // namespace

std::optional<KeptSetting> setting_for(const SweepOptions& sweep, const Catalogues& catalogues,
                                       const std::function<void()>& on_search) {
  SceneFile file = SceneFile::load(sweep.scene_path);
  for (const Override& change : sweep.overrides) file.apply(change);
  if (file.root().find("accuracy") == nullptr) return std::nullopt;
  const std::uint64_t seed = sweep.seed ? *sweep.seed : parse_scene(file, catalogues).seed;
  const PlannedTrials planned = plan_trials(file, catalogues, sweep, seed);
  const Scene scene = planned.plan.trial(0).scene;
  if (!scene.accuracy) return std::nullopt;

  const std::string path = sweep.scene_path + ".accuracy.json";
  const Json subject = subject_of(file, scene, sweep.overrides, planned);
  Json entries = read_entries(path);
  for (const Json& entry : entries) {
    if (entry.at("subject") == subject) return KeptSetting{overrides_of(entry.at("setting")), path, line_of(entry)};
  }

  check_record(path, sweep.scene_path);  // before the work
  if (on_search) on_search();
  const FoundSetting found = find_setting(planned).value();
  Json kept = Json::array();
  for (const Json& entry : entries) {
    if (entry.at("subject").at("scene_sha256") == subject.at("scene_sha256")) kept.push_back(entry);
  }
  while (kept.size() >= most_kept) kept.erase(0);
  kept.push_back(entry_of(subject, scene, found));
  write_text_file(path, Json{{"slipbench_accuracy", schema}, {"settings", kept}}.dump(1) + "\n");
  return KeptSetting{found.overrides, path, line_of(kept.back())};
}

}  // namespace slipbench
