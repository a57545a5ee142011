// What the studies simulate, trials of the project's scenes under changes, and the networks that they teach: many at a time.
#pragma once

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <thread>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/scene/parser.h"
#include "tools/base/files/output_file.h"
#include "tools/base/record/trial_record.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/base/workers/child_process.h"
#include "tools/base/workers/interrupt_guard.h"
#include "tools/base/workers/ordered_workers.h"
#include "tools/program/train/network/validation.h"
#include "tools/program/train/train_network.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

// A scene under one set of changes.
struct GridCell {
  std::string name;   // in progress and in errors
  std::string scene;  // from the project's root: "scenes/grasp/lift.yaml"
  std::vector<Override> overrides = {};
  std::function<void(Scene&)> change = {};  // of each trial's scene, beyond the overrides; may be empty
  std::size_t draws = 0;                    // trials of each cell of the scene's own sweep; 0: as many as the scene says

  // The command that runs the scene with its overrides; an option that says which trials has to follow.
  [[nodiscard]] std::string command(std::uint64_t seed) const;
};

struct GridTrial {
  Scene scene;  // as it runs
  std::size_t cell;
  std::size_t number;  // within its cell
  std::string params;  // JSON object of what the scene's sweep drew

  // Runs the trial and returns its full record, with these params. Throws InputError as run_trial does.
  [[nodiscard]] TrialRecord record() const;
};

// The trials of all cells, cell after cell. The draws of a trial depend on the seed and its number alone, not on its cell.
class Grid {
 public:
  // Throws InputError for a scene or an override that cannot be used.
  Grid(std::vector<GridCell> cells, std::uint64_t seed);
  Grid(const Grid&) = delete;
  Grid& operator=(const Grid&) = delete;

  [[nodiscard]] std::size_t size() const { return places_.size(); }  // trials of all cells
  [[nodiscard]] std::size_t cell_of(std::size_t index) const { return places_[index].first; }
  [[nodiscard]] const std::string& name_of(std::size_t index) const { return cells_[cell_of(index)].name; }

  // Hands the trial to `use`. An InputError gets the cell's name, the trial's number and the command that runs it.
  void with_trial(std::size_t index, const std::function<void(const GridTrial&)>& use) const;

 private:
  std::vector<GridCell> cells_;
  std::uint64_t seed_;
  Catalogues catalogues_;                                    // of the plans
  std::vector<TrialPlan> plans_;                             // of each cell
  std::vector<std::pair<std::size_t, std::size_t>> places_;  // cell and trial of each index
};

// What the networks of a study have said, on the disk as soon as each is done: a study that is killed or interrupted need not teach them again.
// A study teaches its networks in sets, one after the other, and each time in the same order. The file has a line that says whose it is, and
// a record of each network that is done: set, number, its bytes and their SHA-256. A last record that a killed run has left unfinished is dropped.
class KeptNetworks {
 public:
  // `of`: all that decides what the networks say, as the command and its options, the data and the program. `resume`: goes on with what is there,
  // else begins anew. Throws InputError where the file cannot be written, is damaged before its end, is not `of`, or has networks without `resume`.
  KeptNetworks(std::string path, const std::string& of, bool resume);

  // A file without a network goes.
  ~KeptNetworks();
  KeptNetworks(const KeptNetworks&) = delete;
  KeptNetworks& operator=(const KeptNetworks&) = delete;

  // The next set of networks begins.
  void begin_set() { ++set_; }
  // What network `index` of the set has said; null: it has to be taught.
  [[nodiscard]] const std::string* find(std::size_t index) const;
  // Keeps it: once this returns it is on the disk. Throws InputError with the system's reason.
  void keep(std::size_t index, const std::string& said);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::size_t size() const { return said_.size(); }  // networks of all sets
  // The study is done: the file goes.
  void remove();

 private:
  std::string path_;
  Descriptor file_;
  std::size_t set_ = 0;
  std::map<std::pair<std::size_t, std::size_t>, std::string> said_;  // by set and number
};

// Of JSON that has null where there is no figure.
inline double number_or_nan(const Json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

// options.jobs; as many as the machine has where it names none.
inline std::size_t jobs_of(const ReproduceOptions& options) {
  return options.jobs != 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency());
}

// Does work 0 to count - 1 on options.jobs threads and returns the results in this order. `options.say` hears `subject(index)`
// and how much is done whenever the subject changes, and at each 50th. Throws what the work throws, and Interrupted.
template <class Outcome>
std::vector<Outcome> run_in_order(std::size_t count, const ReproduceOptions& options,
                                  const std::function<std::string(std::size_t)>& subject,
                                  const std::function<Outcome(std::size_t)>& work) {
  const InterruptGuard guard("ending after what is at hand");
  OrderedWorkers<Outcome> workers(
      count, std::min(jobs_of(options), count), [&] { return work; }, &InterruptGuard::flag());
  std::vector<Outcome> outcomes;
  for (std::size_t k = 0; k < count; ++k) {
    if (options.say && (k % 50 == 0 || subject(k) != subject(k - 1))) {
      options.say(fmt::format("{} ({} of {} done)", subject(k), k, count));
    }
    std::optional<Outcome> outcome = workers.next();
    if (!outcome) throw Interrupted();
    outcomes.push_back(std::move(*outcome));
  }
  return outcomes;
}

// For networks, of which libtorch teaches one at a time in a process: does work 0 to count - 1, options.jobs at a time, each in a child process of
// its own, and returns the results in this order, the same whatever options.jobs. `options.say` hears `subject(index)` and how many have begun
// whenever the subject changes, and at each tenth. What options.kept holds of them is not done again. Call it while this process has no other
// thread. Throws what the work throws, and Interrupted.
template <class Value>
std::vector<std::vector<Value>> run_in_processes(std::size_t count, const ReproduceOptions& options,
                                                 const std::function<std::string(std::size_t)>& subject,
                                                 const std::function<std::vector<Value>(std::size_t)>& work) {
  static_assert(std::is_trivially_copyable_v<Value>, "values are handed over as bytes");
  const InterruptGuard guard;
  const auto say = [&](std::size_t k) {
    if (options.say && (k % 10 == 0 || subject(k) != subject(k - 1)))
      options.say(fmt::format("{} ({} of {} begun)", subject(k), k, count));
  };
  const auto sent = [&](std::size_t k) {
    const std::vector<Value> values = work(k);
    std::string bytes(values.size() * sizeof(Value), '\0');
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
  };
  std::vector<std::string> said(count);
  std::vector<std::size_t> left;
  if (options.kept != nullptr) options.kept->begin_set();
  for (std::size_t k = 0; k < count; ++k) {
    if (const std::string* kept = options.kept != nullptr ? options.kept->find(k) : nullptr) {
      said[k] = *kept;
    } else {
      left.push_back(k);
    }
  }
  const auto keep = [&](std::size_t i, const std::string& bytes) {
    said[left[i]] = bytes;
    if (options.kept != nullptr) options.kept->keep(left[i], bytes);
  };
  slipbench::run_in_processes(
      left.size(), jobs_of(options), [&](std::size_t i) { return sent(left[i]); }, [&](std::size_t i) { say(left[i]); },
      InterruptGuard::flag(), keep);
  std::vector<std::vector<Value>> results;
  for (const std::string& bytes : said) {
    std::vector<Value>& values = results.emplace_back(bytes.size() / sizeof(Value));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  }
  return results;
}

// Runs all trials of a grid under options.seed (1 without one), and returns what `reduce` makes of each: [cell][trial]. Throws
// InputError of a trial, and Interrupted.
template <class Outcome, class Reduce>
std::vector<std::vector<Outcome>> run_grid(const std::vector<GridCell>& cells, const ReproduceOptions& options, Reduce&& reduce) {
  const Grid grid(cells, options.seed.value_or(1));
  const auto one = [&](std::size_t index) {
    std::optional<Outcome> outcome;
    grid.with_trial(index, [&](const GridTrial& trial) { outcome.emplace(reduce(trial)); });
    return std::move(*outcome);
  };
  std::vector<Outcome> all = run_in_order<Outcome>(
      grid.size(), options, [&](std::size_t index) { return grid.name_of(index); }, one);
  std::vector<std::vector<Outcome>> by_cell(cells.size());
  for (std::size_t k = 0; k < all.size(); ++k) by_cell[grid.cell_of(k)].push_back(std::move(all[k]));
  return by_cell;
}

// A network to be judged on one fold of what it is to learn from.
struct FoldTask {
  std::size_t of;  // whose it is
  std::shared_ptr<const std::vector<train::FoldExample>> examples;
  std::vector<std::size_t> fold_of;
  std::size_t fold;
  train::Validation validation;
  std::string name;
};

// Throws Interrupted once the user has asked for an end, while an InterruptGuard stands.
inline void end_if_interrupted() {
  if (InterruptGuard::flag()) throw Interrupted();
}

// Hands each trial of a dataset to `use`. Throws InputError, naming the file.
void with_trials(const std::string& path, const std::function<void(const TrialRecord&)>& use);

// Refuses a name of `--only` that none of `names` is. Throws InputError with the nearest.
void check_only(const std::vector<std::string>& only, const std::vector<std::string>& names);

// Those of an axis that `only` names; all where it names none of them.
template <class Named>
std::vector<Named> chosen(const std::vector<Named>& all, const std::vector<std::string>& only) {
  std::vector<Named> kept;
  std::ranges::copy_if(all, std::back_inserter(kept),
                       [&](const Named& one) { return std::ranges::find(only, one.name) != only.end(); });
  return kept.empty() ? all : kept;
}

// The names of rows.
template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& one : all) names.emplace_back(one.name);
  return names;
}

// The rows of a table that options.only names; all where it is empty. Throws as check_only.
template <class Named>
std::vector<Named> rows_asked_for(const std::vector<Named>& all, const ReproduceOptions& options) {
  check_only(options.only, names_of(all));
  return chosen(all, options.only);
}

}  // namespace slipbench::reproduce
