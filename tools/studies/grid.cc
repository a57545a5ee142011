#include "tools/studies/grid.h"

#include "tools/base/dataset/guarded.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/project/project_file.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/run/run_trial.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench::reproduce {

std::string GridCell::command(std::uint64_t seed) const {
  std::string line = "slipbench run " + scene;
  for (const Override& one : overrides) line += fmt::format(" --set '{}={}'", one.path, one.value);
  return fmt::format("{} --seed {}", line, seed);
}

TrialRecord GridTrial::record() const {
  TrialRecord record = run_trial(scene, number, Recording::full, max_record_bytes, &InterruptGuard::flag()).record;
  record.params = params;
  return record;
}

Grid::Grid(std::vector<GridCell> cells, std::uint64_t seed)
    : cells_(std::move(cells)), seed_(seed), catalogues_(program_catalogues()) {
  for (const GridCell& cell : cells_) {
    SceneFile file = SceneFile::load(project_file(cell.scene));
    for (const Override& one : cell.overrides) file.apply(one);
    plans_.emplace_back(file, catalogues_, cell.draws, seed_);
    for (std::size_t trial = 0; trial < plans_.back().size(); ++trial) places_.emplace_back(plans_.size() - 1, trial);
  }
}

void Grid::with_trial(std::size_t index, const std::function<void(const GridTrial&)>& use) const {
  const auto [place, number] = places_[index];
  const GridCell& cell = cells_[place];
  try {
    TrialPlan::Trial planned = plans_[place].trial(number);
    planned.scene.seed = seed_;
    if (cell.change) cell.change(planned.scene);
    Json params = Json::object();
    for (const auto& [path, value] : planned.drawn) params[path] = Json::parse(value);
    use({std::move(planned.scene), place, number, params.dump()});
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}, trial {}: {}; the same{}: {} --trials {} --trial {}", cell.name, number, error.what(),
                                 cell.change ? ", but for what the name says" : "", cell.command(seed_), plans_[place].size(),
                                 number));
  }
}

Packed packed_trials(const std::string& path, const std::function<void(const TrialRecord&, Packed&)>& pack) {
  return Packed(guarded(path, [&] {
    Packed bytes;
    for_each_trial(DatasetReader(path), [&](const TrialRecord& record) {
      try {
        pack(record, bytes);
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", path, error.what()));
      }
    });
    return bytes.release();
  }));
}

void make_dataset(const std::string& path, const char* scene, const std::vector<Override>& overrides, std::size_t draws,
                  const char* what, const ReproduceOptions& options) {
  SweepOptions sweep;
  sweep.scene_path = project_file(scene);
  sweep.overrides = overrides;
  sweep.seed = options.seed.value_or(1);
  sweep.trials = draws;
  sweep.jobs = options.jobs;
  sweep.output = path;
  sweep.interrupt = &InterruptGuard::flag();
  run_sweep(sweep, program_catalogues(), [&](const SweepProgress& progress) {
    if (what != nullptr && options.say && progress.done % 50 == 0)
      options.say(fmt::format("{} ({} of {} done)", what, progress.done, progress.total));
  });
  end_if_interrupted();
}

train::NetworkSummary teach(const std::string& name, const train::Recipe& recipe, train::LabelRule labels,
                            const std::string& dataset, const std::string& output, const ReproduceOptions& options) {
  train::NetworkTraining training;
  training.datasets = {dataset};
  training.recipe = recipe;
  training.recipe.labels = labels;
  training.seed = options.seed.value_or(1);
  training.output = output;
  return train::train_network(training, [&](const train::MemberProgress& progress) {
    end_if_interrupted();
    if (options.say) options.say(fmt::format("{}: step {} of {}", name, progress.training.step, progress.training.steps));
  });
}

void check_only(const std::vector<std::string>& only, const std::vector<std::string>& names) {
  for (const std::string& name : only) {
    if (std::ranges::find(names, name) != names.end()) continue;
    throw InputError(fmt::format("reproduce: --only: unknown name {}{}", quote(name), allowed_names(name, names)));
  }
}

}  // namespace slipbench::reproduce
