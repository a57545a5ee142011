#include "tools/verify/verify.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/process/check_readable.h"
#include "sim/core/process/interrupted.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/shard_set.h"
#include "tools/files/reject.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/recorded_scene.h"
#include "tools/verify/cone.h"
#include "tools/verify/contact.h"
#include "tools/verify/slip.h"
#include "tools/verify/verification.h"
#include "tools/workers/ordered_children.h"

namespace slipbench {
namespace {

using verify::Check;
using verify::Verification;

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// Time limit of one process [s]: damage can make HDF5 loop endlessly.
double longest_part(const DatasetReader& reader) {
  double megabytes = 0.0;
  for (const std::string& file : reader.files()) megabytes += 1e-6 * static_cast<double>(std::filesystem::file_size(file));
  return 120.0 + 20.0 * megabytes;
}

class DatasetCheck {
 public:
  explicit DatasetCheck(const std::string& path)
      : reader_(dataset_header_at(path)), catalogues_(program_catalogues()), digests_(reader_.files().size()) {}

  // Uses one process per hardware thread; damage may crash it.
  Json run(const std::string& path, const std::atomic<bool>* interrupt) {
    check_order();
    const std::size_t parts = std::max(1U, std::thread::hardware_concurrency());
    const std::vector<std::size_t>& trials = reader_.trials();
    const double limit = longest_part(reader_);
    OrderedChildren children(
        parts, parts, [&](std::size_t part) { return check_part(part, parts); }, interrupt, limit);
    auto trial = trials.begin();
    while (std::optional<ChildEnd> end = children.next()) {
      if (end->kind == ChildEnd::Kind::lost) reject("{}: is damaged: the process that read it {}", path, end->loss(limit));
      const Json found = Json::parse(std::move(*end).result(path));
      verification_.add(found.at("verification"));
      for (const Json& digest : found.at("digests")) {
        if (!digest.is_null()) digests_[reader_.file_of(*trial)].emplace_back(*trial, digest.get<Digest>());
        ++trial;
      }
    }
    end_if(interrupt);
    check_file_digests();
    Json result{{"files", reader_.files()},
                {"schema", reader_.schema(0)},
                {"complete", reader_.complete()},
                {"trials", reader_.trials().size()}};
    if (const auto& part = reader_.header().part) result["shard"] = shard_text(*part);
    result.update(verification_.json());
    return result;
  }

 private:
  // Part `part` of `parts` of the trials: its results and digests.
  std::string check_part(std::size_t part, std::size_t parts) {
    verification_ = {};
    const std::vector<std::size_t>& trials = reader_.trials();
    std::vector<std::optional<Digest>> digests;
    for (std::size_t i = part * trials.size() / parts; i < (part + 1) * trials.size() / parts; ++i) {
      std::optional<TrialRecord> record;
      hold(Check::values, trials[i], [&] { record = reader_.read_trial(trials[i]); });
      digests.push_back(check_digest(trials[i], record ? &*record : nullptr));
      if (record) check_content(*record);
    }
    Json found = {{"verification", verification_.json()}, {"digests", Json::array()}};
    for (const std::optional<Digest>& digest : digests) found["digests"].push_back(or_null(digest));
    return dumped(found);
  }

  // Records a read error as a failure of the check.
  template <class Action>
  void hold(Check check, std::optional<std::size_t> trial, const Action& action) {
    try {
      action();
    } catch (const std::runtime_error& error) {
      verification_.fail(check, {trial}, error.what());
    }
  }

  // `record`: the trial as read; null: unreadable.
  std::optional<Digest> check_digest(std::size_t trial, const TrialRecord* record) {
    std::optional<Digest> found;
    hold(Check::digests, trial, [&] {
      found = reader_.stored_digest(trial, record);
      const std::string written = reader_.trial_sha256(trial);
      if (!written.empty() && written != hexadecimal(*found)) {
        verification_.fail(
            Check::digests, {trial},
            fmt::format("its content has the SHA-256 {}, but its attribute sha256 is {}", hexadecimal(*found), written));
      }
      verification_.count(Check::digests, 1);
    });
    return found;
  }

  void check_file_digests() {
    for (std::size_t file = 0; file < digests_.size(); ++file) {
      const std::string name = reader_.files()[file];
      if (reader_.schema(file) == 1) {
        verification_.leave_out(Check::digests, "attributes: the dataset has schema 1, whose digest covers only the arrays");
      }
      const std::string& written = reader_.content_sha256()[file];
      if (written.empty()) {
        verification_.leave_out(Check::digests,
                                reader_.schema(file) == 1
                                    ? "arrays: the run was killed before it wrote content_sha256"
                                    : "the file's own attributes: the run was killed before it wrote content_sha256");
        continue;
      }
      hold(Check::digests, std::nullopt, [&] {
        const std::string found = reader_.stored_sha256(file, digests_[file]);
        if (found == written) return;
        verification_.fail(Check::digests, {},
                           fmt::format("{}: its content has the SHA-256 {}, but content_sha256 is {}", name, found, written));
      });
    }
  }

  void check_order() {
    const std::vector<std::size_t>& trials = reader_.trials();
    verification_.count(Check::order, trials.size());
    const std::vector<FailedTrial>& failed = reader_.failed();
    for (const FailedTrial& trial : failed) {
      if (std::ranges::binary_search(trials, trial.trial))
        verification_.fail(Check::order, {trial.trial}, "exists, but is listed as failed");
    }
    for (std::size_t i = 1; i < trials.size(); ++i) {
      const auto between = std::ranges::count_if(
          failed, [&](const FailedTrial& trial) { return trial.trial > trials[i - 1] && trial.trial < trials[i]; });
      const std::size_t next = trials[i - 1] + 1 + static_cast<std::size_t>(between);
      if (reader_.header().part) {
        verification_.leave_out(Check::order,
                                "missing trials: the dataset is a shard, which is compared with the other given shards");
      } else if (trials[i] > next && !reader_.complete()) {
        verification_.leave_out(Check::order, "missing trials: the run was killed before it listed the failed trials");
      } else if (trials[i] > next) {
        verification_.fail(Check::order, {trials[i]},
                           fmt::format("follows trial {}; the trials between are missing", trials[i - 1]));
      }
      if (reader_.file_of(trials[i]) < reader_.file_of(trials[i - 1])) {
        verification_.fail(Check::order, {trials[i]}, fmt::format("is in an earlier file than trial {}", trials[i - 1]));
      }
    }
    hold(Check::order, std::nullopt, [&] { check_masks(); });
  }

  void check_masks() {
    std::vector<std::size_t> listed;
    for (const char* part : {"train", "valid", "test"}) {
      const std::vector<std::size_t> members = reader_.mask(part);
      if (!std::ranges::is_sorted(members))
        verification_.fail(Check::order, {{}, fmt::format("mask/{}", part)}, "is not in order");
      listed.insert(listed.end(), members.begin(), members.end());
    }
    if (listed.empty() && !reader_.complete()) {
      verification_.leave_out(Check::order, "masks: the run did not finish and wrote none");
      return;
    }
    std::ranges::sort(listed);
    for (std::size_t i = 1; i < listed.size(); ++i) {
      if (listed[i] == listed[i - 1]) verification_.fail(Check::order, {listed[i], "mask"}, "is listed twice");
    }
    for (const std::size_t trial : listed) {
      if (!std::ranges::binary_search(reader_.trials(), trial))
        verification_.fail(Check::order, {trial, "mask"}, "is listed, but does not exist");
    }
    for (const std::size_t trial : reader_.trials()) {
      if (!std::ranges::binary_search(listed, trial)) verification_.fail(Check::order, {trial, "mask"}, "is in no part");
    }
  }

  void check_content(const TrialRecord& record) {
    const std::size_t trial = record.trial;
    hold(Check::values, trial, [&] {
      if (record.seed != reader_.header().seed) {
        verification_.fail(Check::order, {trial},
                           fmt::format("has the seed {}, but its file has {}", record.seed, reader_.header().seed));
      }
      if (record.sensors.empty()) {
        for (const Check check : {Check::times, Check::values, Check::events, Check::cone, Check::slip, Check::contact}) {
          verification_.leave_out(check, "trials without arrays (--record outcome)");
        }
        return;
      }
      verify::check_times(record, verification_);
      verify::check_values(record, verification_);
      check_samples(trial, record);
      if (const std::string& truth = reader_.header().truth; !truth.empty()) {
        for (const Check check : {Check::events, Check::cone, Check::slip, Check::contact})
          verification_.leave_out(check, fmt::format("all: the dataset has no truth ({})", truth));
        verification_.leave_out(Check::times, "times against rate_hz: an imported recording keeps the recorded times");
        return;
      }
      bool sound = true;
      for (const SensorRecord& sensor : record.sensors) sound = verify::check_events(sensor, trial, verification_) && sound;
      if (sound) verify::check_outcome(record, verification_);
      check_laws(record, sound);
    });
  }

  // A sensor's labels must have its times, and num_samples must be the bodies' count.
  void check_samples(std::size_t trial, const TrialRecord& record) {
    for (const SensorRecord& sensor : record.sensors) {
      if (!has_labels(sensor.labels)) continue;
      const std::string path = "labels/" + sensor.name + "/t";
      if (reader_.read<double>(trial, path) != sensor.time)
        verification_.fail(Check::times, {trial, path}, "are not the times of the sensor");
    }
    if (const std::size_t samples = reader_.info(trial).num_samples; samples != record.body_time.size()) {
      verification_.fail(Check::times, {trial, "truth"},
                         fmt::format("has {}, but num_samples is {}", counted(record.body_time.size(), "row"), samples));
    }
  }

  // Checks Coulomb's law, slip if the events are `sound`, and contact with one surface.
  void check_laws(const TrialRecord& record, bool sound) {
    std::optional<Scene> scene;
    try {
      if (!scene_) scene_ = recorded_file(reader_);
      scene = recorded_scene(*scene_, record, catalogues_);
    } catch (const std::exception& error) {
      for (const Check check : {Check::cone, Check::slip, Check::contact})
        verification_.leave_out(check, fmt::format("all: this program cannot read the scene ({})", error.what()));
      return;
    }
    for (const SensorRecord& sensor : record.sensors) {
      const auto found = std::ranges::find(scene->sensors, sensor.name, &SensorScene::name);
      if (found == scene->sensors.end()) {
        verification_.fail(Check::cone, {record.trial, "sensors/" + sensor.name}, "is not a sensor of the scene");
        continue;
      }
      const auto index = static_cast<std::size_t>(found - scene->sensors.begin());
      verify::check_cone(verify::cone_law(*scene, index), sensor, record.trial, verification_);
      if (sound) verify::check_slip(scene->fidelity, sensor, record.trial, verification_);
      verify::check_contact(*scene, index, record, sensor, verification_);
    }
  }

  DatasetReader reader_;
  Catalogues catalogues_;
  std::optional<SceneFile> scene_;                                    // with the overrides
  std::vector<std::vector<std::pair<std::size_t, Digest>>> digests_;  // by file
  Verification verification_;
};

// Index of the file in its dataset.
std::uint64_t shard_of(const std::string& path) {
  check_readable(FileKind::dataset_file, path);
  const std::optional<FileAbout> about = file_about(path);
  if (!about) throw InputError(path + ": is not a dataset");
  return about->shard;
}

// Compares several shards.
Json shards_result(const std::vector<std::string>& paths) {
  Json result{{"shards", paths.size()}, {"trials", nullptr}, {"duplicates", nullptr}, {"within_rounding", nullptr}};
  std::vector<std::string> failures;
  try {
    const ShardSet set(paths);
    failures = set.gaps();
    result["trials"] = set.size();
    result["duplicates"] = set.duplicates();
    result["within_rounding"] = set.within_rounding();
  } catch (const InputError& error) {
    failures.emplace_back(error.what());
  }
  result["holds"] = failures.empty();
  result["failures"] = failures;
  return Json::parse(dumped(result));  // valid UTF-8, whatever the files hold
}

}  // namespace

Verified verify_datasets(const std::vector<std::string>& paths, const std::atomic<bool>* interrupt) {
  Verified verified;
  std::set<std::string> seen;  // files of verified datasets
  std::vector<std::string> further;
  std::vector<std::string> shards;
  const auto run = [&](const std::string& path, const auto& action) {
    try {
      action();
    } catch (const Interrupted&) {
      throw;
    } catch (const std::runtime_error& error) {
      verified.readable = false;
      verified.datasets.push_back({{"file", path}, {"error", error.what()}});
    }
  };
  for (const std::string& path : paths) {
    run(path, [&] {
      if (shard_of(path) != 0) {
        further.push_back(path);
        return;
      }
      Json result = Json::parse(dumped(DatasetCheck(path).run(path, interrupt)));
      for (const Json& file : result["files"])
        seen.insert(std::filesystem::path(file.get<std::string>()).lexically_normal().string());
      verified.holds = verified.holds && result["holds"].get<bool>();
      if (result.contains("shard")) shards.push_back(path);
      Json dataset{{"file", path}};
      dataset.update(result);
      verified.datasets.push_back(std::move(dataset));
    });
  }
  for (const std::string& path : further) {
    run(path, [&] {
      if (!seen.contains(std::filesystem::path(path).lexically_normal().string())) {
        throw InputError(path + ": is a later file of a dataset; give its first file");
      }
      verified.datasets.push_back({{"file", path}, {"part_of", "a dataset above"}});
    });
  }
  if (shards.size() > 1) {
    run(fmt::format("{}", fmt::join(shards, ", ")), [&] {
      verified.sweep = shards_result(shards);
      verified.holds = verified.holds && verified.sweep["holds"].get<bool>();
    });
  }
  return verified;
}

Json verified_json(const Verified& verified) {
  Json object{{"holds", verified.holds && verified.readable}, {"datasets", verified.datasets}};
  if (!verified.sweep.is_null()) object["sweep"] = verified.sweep;
  return object;
}

}  // namespace slipbench
