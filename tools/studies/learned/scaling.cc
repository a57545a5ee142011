// How many trials to make, and what has to be varied in them: networks taught from parts of scenes/learn, judged by the benchmark.
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tools/base/files/output_file.h"
#include "tools/base/files/reject.h"
#include "tools/program/benchmark/benchmark.h"
#include "tools/studies/grid.h"

namespace slipbench::reproduce {
namespace scaling {
namespace {

constexpr std::size_t usual_trials = 1000;  // of the networks that lack a factor, which --full adds
constexpr std::size_t quick_part = 4;       // without --full a network takes a quarter of its recipe's steps

// What a scene draws, held at one value: the middle of its range.
struct Factor {
  std::string name;
  std::vector<Override> held;
  std::size_t cells = 0;  // of the scene's grid then; 0: as before
};

struct Subject {
  std::string name;  // type of sensor
  const char *scene, *recipe;
  std::size_t cells;  // of the scene's grid: what its `trials` multiply
  std::vector<Factor> factors;
};

std::vector<Override> at(std::initializer_list<std::pair<const char*, const char*>> values) {
  std::vector<Override> overrides;
  for (const auto& [key, value] : values) overrides.push_back({fmt::format("sweep.{}", key), fmt::format("[{}]", value)});
  return overrides;
}

const std::vector<Subject>& subjects() {
  static const std::vector<Subject> all{
      {"papillarray",
       "scenes/learn/papillarray.yaml",
       "slip_gru",
       24,
       {{"friction", at({{"friction.scale", "0.39"}, {"friction.kinetic", "0.875"}})},
        {"effects of friction", at({{"effects", "[]"}})},
        {"load and tilt", at({{"motion.compression", "0.49 mm"}, {"motion.tilt.0", "0 deg"}, {"motion.tilt.1", "0 deg"}})},
        {"start, stop, acceleration", at({{"motion.start", "1.75 s"},
                                          {"motion.stop", "0.95 s"},
                                          {"motion.acceleration", "0.2 m/s2"},
                                          {"motion.angular_acceleration", "1000 deg/s2"}})},
        {"direction and pivot", at({{"motion.direction", "180 deg"}, {"motion.pivot.0", "0 mm"}, {"motion.pivot.1", "0 mm"}})},
        {"motion: one speed, no turn", at({{"motion", "{speed: 8 mm/s}, {speed: 8 mm/s}, {speed: 0 mm/s}"}}), 3},
        {"device", at({{"sensors.pad.profile", "hexapod"},
                       {"sensors.pad.stiffness_sd", "0"},
                       {"sensors.pad.edge_drop", "0.19 mm"},
                       {"sensors.pad.corner_drop", "0.4 mm"},
                       {"sensors.pad.bristles", "6"},
                       {"sensors.pad.bristle_spread", "0.55"},
                       {"sensors.pad.electronics", "typical"}})}}},
      {"piezo_skin",
       "scenes/learn/piezo_skin.yaml",
       "piezo_slip",
       19,
       {{"friction", at({{"friction.scale", "0.47"}, {"friction.kinetic", "0.875"}})},
        {"load", at({{"motion.compression", "0.2 mm"}})},
        {"start and acceleration", at({{"motion.start", "2.05 s"}, {"motion.acceleration", "0.32 m/s2"}})},
        {"motion: one speed",
         at({{"motion",
              "{speed: 8 mm/s, travel: 20 mm}, {speed: 2 mm/s, travel: 0.005 mm}, "
              "{speed: 0.001 mm/s, travel: 1 mm}, {speed: 20 mm/s, clearance: 5 mm, travel: 20 mm, strokes: 10}"}}),
         4},
        {"motors", at({{"motion.vibration", "1.2"}, {"motion.idle_speed", "0 mm/s"}, {"motion.idle_start", "0 s"}})},
        {"tip", at({{"effects.0.inertia.frequency", "180 Hz"},
                    {"effects.0.inertia.damping", "0.1"},
                    {"effects.1.roughness.height", "1.6 um"},
                    {"effects.2.asperities.amplitude", "2 mN"},
                    {"effects.2.asperities.distance", "0.24 mm"},
                    {"sensors.pad.k_tangential", "5.5 N/mm"},
                    {"sensors.pad.tip_radius", "0.32 m"}})}}}};
  return all;
}

// A network to be taught and judged.
struct Task {
  const Subject* subject;
  const Factor* without;  // null: everything varies
  std::size_t trials;     // asked for
};

// By the open recordings of the board.
struct Judged {
  double trials = 0.0;
  ResultPoint inside, outside;
  double delay = 0.0, early = 0.0, alarms = 0.0;  // inside: s, share of the slips, a minute without slip
};

// The row of what the caller named, in the board's open recordings of a domain.
const Json& given_row(const Json& board, const char* domain) {
  for (const Json& set : board.at("sets")) {
    if (set.value("domain", "") != domain) continue;
    for (const Json& row : set.at("rows"))
      if (row.at("kind") == "given") return row;
  }
  reject("reproduce: learned/scaling: the board has no row of the network in its recordings {}", domain);
}

Judged judged(const std::string& file, const std::string& sensor) {
  benchmark::Options options;
  options.asked.detectors = {file};
  options.asked.sensor = sensor;
  options.jobs = 1;
  options.interrupt = &InterruptGuard::flag();
  const Json board = benchmark::benchmark(options), &inside = given_row(board, "inside"), &outside = given_row(board, "outside");
  const auto score = [](const Json& row) {
    const Json& one = row.at("score");
    return ResultPoint{100.0 * number_or_nan(one.at("value")), 100.0 * number_or_nan(one.at("low")),
                       100.0 * number_or_nan(one.at("high"))};
  };
  const Json& figures = inside.at("figures");
  return {.inside = score(inside),
          .outside = score(outside),
          .delay = number_or_nan(figures.at("figures").at("delay_median_s").at("value")),
          .early = figures.at("early").get<double>() / std::max(1.0, figures.at("slipping").get<double>()),
          .alarms = number_or_nan(inside.at("false_alarms_per_minute"))};
}

Judged taught_and_judged(const Task& task, ReproduceOptions options) {
  options.jobs = 1;  // others run beside this one
  const ScratchFolder folder;
  const std::string dataset = folder.file("learn.h5"), file = folder.file("slip.onnx");
  const std::size_t cells = task.without != nullptr && task.without->cells != 0 ? task.without->cells : task.subject->cells;
  make_dataset(dataset, task.subject->scene, task.without != nullptr ? task.without->held : std::vector<Override>{},
               std::max<std::size_t>(1, task.trials / cells), nullptr, options);
  train::NetworkTraining training;
  training.datasets = {dataset};
  training.all = true;
  training.recipe = train::find_recipe(task.subject->recipe);
  training.recipe.members = 1;  // what data buy, not what several networks do
  if (!options.full) training.recipe.training.steps /= quick_part;
  training.seed = options.seed.value_or(1);
  training.by_score = true;
  training.output = file;
  const train::NetworkSummary summary =
      train::train_network(training, [](const train::MemberProgress&) { end_if_interrupted(); });
  Judged found = judged(file, task.subject->name);
  found.trials = static_cast<double>(summary.trials);
  return found;
}

std::vector<Task> tasks_of(const std::vector<Subject>& chosen_subjects, const ReproduceOptions& options) {
  std::vector<std::size_t> counts{100, 300, usual_trials, 3000};
  if (options.full) counts.insert(counts.end(), {10'000, 30'000});
  if (options.trials != 0) counts = {options.trials};
  const std::size_t of_factors = options.trials != 0 ? options.trials : usual_trials;
  std::vector<Task> tasks;
  for (const Subject& subject : chosen_subjects) {
    for (const std::size_t count : counts) tasks.push_back({&subject, nullptr, count});
    if (!options.full) continue;
    for (const Factor& factor : subject.factors) tasks.push_back({&subject, &factor, of_factors});
  }
  return tasks;
}

std::string interval(const ResultPoint& score) { return fmt::format("{:.1f} to {:.1f}", score.low, score.high); }

std::vector<std::string> row_of(const std::string& name, const Judged& one) {
  return {name,
          fmt::format("{:.1f}", one.inside.value),
          interval(one.inside),
          fmt::format("{:.0f} ms", 1e3 * one.delay),
          fmt::format("{:.0f} %", 100.0 * one.early),
          fmt::format("{:.1f}", one.alarms),
          fmt::format("{:.1f}", one.outside.value),
          interval(one.outside)};
}

// Of one sensor: by the number of trials, and by what does not vary.
void add_subject(const Subject& subject, const std::vector<Task>& tasks, const std::vector<std::vector<Judged>>& found,
                 Result& result) {
  const std::vector<std::string> figures{"score inside", "95 %", "median delay", "early", "alarms/min", "score outside", "95 %"};
  ResultTable counts{subject.name + ": by the number of trials", {"trials"}},
      factors{subject.name + ": without a factor", {"held"}};
  counts.head.insert(counts.head.end(), figures.begin(), figures.end());
  factors.head.insert(factors.head.end(), figures.begin(), figures.end());
  ResultChart chart{.title = subject.name + " on slip-2",
                    .across = "trials learnt from",
                    .up = "score",
                    .places = {},
                    .curves = {{"inside", {}}, {"outside", {}}},
                    .bar_name = "never slip"};
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    if (tasks[k].subject->name != subject.name) continue;
    const Judged& one = found[k].front();
    const std::string trials = fmt::format("{:.0f}", one.trials),
                      name = tasks[k].without != nullptr ? tasks[k].without->name : trials;
    (tasks[k].without != nullptr ? factors : counts).rows.push_back(row_of(name, one));
    result.figures[subject.name].push_back({{"trials", one.trials},
                                            {"without", tasks[k].without != nullptr ? Json(name) : Json(nullptr)},
                                            {"inside", or_null(one.inside.value)},
                                            {"outside", or_null(one.outside.value)},
                                            {"delay_median_s", or_null(one.delay)},
                                            {"early", one.early},
                                            {"false_alarms_per_minute", or_null(one.alarms)}});
    if (tasks[k].without != nullptr) continue;
    chart.places.push_back(trials);
    chart.curves[0].points.push_back(one.inside);
    chart.curves[1].points.push_back(one.outside);
  }
  factors.note =
      fmt::format("Some {} trials each; what is named stands at one value of its range in all of them.", tasks.back().trials);
  if (chart.places.size() > 1) result.charts.push_back(std::move(chart));
  result.tables.push_back(std::move(counts));
  if (!factors.rows.empty()) result.tables.push_back(std::move(factors));
}

}  // namespace
}  // namespace scaling

Result learned_scaling(const ReproduceOptions& options) {
  using namespace scaling;
  const std::vector<Subject> asked = rows_asked_for(subjects(), options);
  static_cast<void>(train::network_libraries());  // says what is missing before anything is run
  const std::vector<Task> tasks = tasks_of(asked, options);
  const auto found = run_in_processes<Judged>(
      tasks.size(), options, [&](std::size_t k) { return tasks[k].subject->name; },
      [&](std::size_t k) { return std::vector<Judged>{taught_and_judged(tasks[k], options)}; });

  Result result;
  result.title = "What a slip detector learns from how many trials";
  result.source = "No paper's table: networks taught from parts of scenes/learn, judged by the open recordings of slip-2.";
  for (const Subject& subject : asked) add_subject(subject, tasks, found, result);
  result.setup = {
      fmt::format("Seed {} of trials and of training; the operating point by --score.", options.seed.value_or(1)),
      options.full
          ? "As many steps as the recipe has."
          : "A quarter of the recipe's steps; --full: all of them, more trials, and one factor of the scene held at a time.",
      "Intervals are of the judged recordings, not of another training."};
  result.remarks = {"No grasp is learnt from here, so nothing is said of loops."};
  return result;
}

}  // namespace slipbench::reproduce
