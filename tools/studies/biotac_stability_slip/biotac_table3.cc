// Table 3 of the paper: direction of slip under one finger, on objects that were not learnt; with and without the place of the touch.
#include <map>
#include <set>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/studies/biotac_stability_slip/biotac_learning.h"

namespace slipbench::reproduce {
namespace biotac {
namespace {

constexpr std::size_t short_rows = 5, long_rows = 50, usual_draws = 4,
                      published_touches = 8;  // draws of each of 28 cells and each device
constexpr std::size_t classes = 7, direction_steps = 1200;

// Who learns, and who judges.
constexpr std::array<std::array<const char*, 2>, 6> direction_columns{{{"real", "real alone"},
                                                                       {"synthetic_to_real", "synthetic alone"},
                                                                       {"both", "both"},
                                                                       {"random_to_real", "random site alone"},
                                                                       {"synthetic", "synthetic, on synthetic"},
                                                                       {"random_site", "random site, on random site"}}};

constexpr std::size_t without_real_from = 4;  // the columns that need no recordings

struct DirectionNetwork : Network {
  Window window;
  std::size_t columns = direction_columns.size();  // the first so many of them, without real recordings all: of what takes long
};

Set windows_of_all(const std::vector<Touch>& touches, const Window& window, std::size_t folds, std::uint64_t seed) {
  Set set;
  set.folds = folds;
  std::vector<std::string> objects;
  for (const Touch& touch : touches) {
    for (train::FoldExample& example : windows_of(touch, window)) {
      set.examples.push_back(std::move(example));
      objects.push_back(touch.object);
    }
  }
  set.fold_of = folds_by_object(objects, folds, seed);
  return set;
}

// Of windows of `rows`, frames of `inputs`: all rows at once.
train::NetworkShape direction_regression(std::size_t inputs, std::size_t rows) {
  return {inputs, {train::Conv1d{classes, rows}}};
}
train::NetworkShape direction_plain(std::size_t inputs, std::size_t rows) {
  return {inputs, {train::Conv1d{128, rows}, train::BatchNorm{}, train::Relu{}, train::Linear{classes}}};
}

std::vector<DirectionNetwork> direction_networks(bool full) {
  using namespace train::biotac;
  const ImageLayout& image = image_layouts().front();
  std::vector<DirectionNetwork> all;
  for (const bool site : {true, false}) {
    const train::Scaling scaling = site ? train::Scaling::range : train::Scaling::standard;
    const char* const suffix = site ? "" : "_no_site";
    const auto add = [&](const char* name, const char* text, train::NetworkShape shape, std::size_t steps, Window window,
                         std::size_t columns = direction_columns.size()) {
      window.site = site;
      all.push_back(
          {{fmt::format("{}{}", name, suffix), fmt::format("{}, {} ms{}", text, 10 * window.rows, site ? "" : ", mean taken off"),
            std::move(shape), steps, scaling},
           window,
           columns});
    };
    const Window brief{.rows = short_rows, .stride = short_rows}, whole{.rows = long_rows, .stride = long_rows / 2};
    Window images = brief;
    images.layout = &image;
    const std::size_t three = 3;  // columns of what takes long
    add("lr", "logistic regression", direction_regression(electrodes, short_rows), direction_steps, brief);
    add("mlp", "MLP 128", direction_plain(electrodes, short_rows), direction_steps, brief);
    add("lstm", "LSTM, 5 layers of 32", lstm_network(5, short_rows), direction_steps / 2, brief,
        site ? direction_columns.size() : three);
    if (site) {
      add("lstm_longer", "the same, four times the steps", lstm_network(5, short_rows), 2 * direction_steps, brief, 1);
      add("lstm_2", "LSTM, 2 layers of 32", lstm_network(2, short_rows), direction_steps, brief, three);
    }
    if (full) add("convlstm", "ConvLSTM, 5 layers of 32", conv_lstm_network(image, 5, 32, short_rows), direction_steps, images);
    if (!full)
      add("convlstm", "ConvLSTM, 2 layers of 8", conv_lstm_network(image, 2, 8, short_rows), direction_steps, images,
          site ? three : 2);
    add("lstm_500", "LSTM, 2 layers of 32", lstm_network(2, long_rows), direction_steps / 4, whole, site ? 2 : three);
    if (site) continue;
    Window figures = whole;
    figures.figures = Window::Figures::by_electrode;
    add("sd_trend", "MLP 128 of SDs and trends", direction_plain(2 * electrodes, 1), direction_steps / 2, figures);
    figures.figures = Window::Figures::sorted;
    add("sorted_sd", "MLP 128 of the SDs in order", direction_plain(electrodes, 1), direction_steps / 2, figures);
  }
  return all;
}

std::size_t object_count(const std::vector<Touch>& touches) {
  std::set<std::string> objects;
  for (const Touch& touch : touches) objects.insert(touch.object);
  return objects.size();
}

// What learns and judges. Without real recordings the synthetic ones do, alone.
struct Touches {
  std::vector<Touch> real, synthetic, random_site;
};

Touches all_touches(const ReproduceOptions& options) {
  const std::size_t draws = options.trials != 0 ? options.trials : options.full ? published_touches : usual_draws;
  Touches touches;
  if (!options.real.empty()) touches.real = read_touches(options.real, options);
  touches.synthetic = options.data.empty() ? run_touches(slip_scene, draws, options) : read_touches(options.data, options);
  touches.random_site = run_touches(random_site_scene, draws, options);
  return touches;
}

struct Row {
  const DirectionNetwork* network;
  std::map<std::string, std::pair<std::size_t, std::vector<std::size_t>>> numbers;  // of Lessons; the folds to report by
};

Row queued(const DirectionNetwork& one, const Touches& touches, std::uint64_t seed, Lessons& lessons) {
  Row row{&one, {}};
  const auto set_of_touches = [&](const std::vector<Touch>& some) {
    return windows_of_all(some, one.window, object_count(some), seed);
  };
  const Set made = set_of_touches(touches.synthetic), anywhere = set_of_touches(touches.random_site);
  const auto add = [&](const char* name, const Set& set, const Set* other, Learns learns) {
    row.numbers[name] = {lessons.queue(set, other, learns, one), set.fold_of};
  };
  const Set recorded = touches.real.empty() ? Set() : set_of_touches(touches.real);
  for (const auto& [name, text] : touches.real.empty() ? std::span(direction_columns).subspan(without_real_from)
                                                       : std::span(direction_columns).first(one.columns)) {
    const std::string column = name;
    if (column == "real") add(name, recorded, nullptr, Learns::own);
    if (column == "synthetic_to_real") add(name, recorded, &made, Learns::other);
    if (column == "both") add(name, recorded, &made, Learns::both);
    if (column == "random_to_real") add(name, recorded, &anywhere, Learns::other);
    if (column == "synthetic") add(name, made, nullptr, Learns::own);
    if (column == "random_site") add(name, anywhere, nullptr, Learns::own);
  }
  return row;
}

ResultTable published() {
  return {"The paper: accuracy on objects of a kind, five repetitions",
          {"network, 50 ms", "rigid and smooth", "rough", "little contact", "mean"},
          {{"LSTM", "82.5 +- 2.0", "73.8 +- 2.0", "72.4 +- 3.6", "76.1 +- 2.4"},
           {"ConvLSTM", "82.6 +- 1.2", "73.5 +- .7", "70.9 +- 1.9", "75.5 +- 1.2"}},
          ""};
}

// The scores of `columns` of direction_columns, which go into `figures`, too.
ResultTable scores_table(const char* title, const std::vector<Row>& rows, std::span<const std::array<const char*, 2>> columns,
                         const Lessons& lessons, MeanSd Scores::*member, Json& figures) {
  ResultTable table{title, {"network"}};
  for (const auto& [name, text] : columns) table.head.emplace_back(text);
  for (const Row& row : rows) {
    std::vector<std::string> cells{row.network->text};
    for (const auto& [name, text] : columns) {
      const auto found = row.numbers.find(name);
      if (found == row.numbers.end()) {
        cells.emplace_back("-");
        continue;
      }
      const auto& [number, fold_of] = found->second;
      const Scores scores = scores_of(lessons.answers(number), fold_of);
      figures[row.network->name][name] = json_of(scores);
      cells.push_back(cell(scores.*member));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

std::vector<std::string> setup_of(const ReproduceOptions& options, const Touches& touches) {
  const auto recordings = [&](const std::vector<Touch>& some) {
    return fmt::format("{} recordings of {} objects", some.size(), object_count(some));
  };
  std::vector<std::string> setup;
  if (!touches.real.empty()) setup.push_back(fmt::format("Real: {}, {}.", options.real, recordings(touches.real)));
  setup.push_back(fmt::format("Synthetic: {}, {}.",
                              options.data.empty() ? fmt::format("{}, {} fingers", slip_scene, devices) : options.data,
                              recordings(touches.synthetic)));
  setup.push_back(fmt::format("Random site: {}, {} fingers, {}.", random_site_scene, devices, recordings(touches.random_site)));
  setup.push_back(fmt::format(
      "Five rows of 100 Hz, one after the other; 0.5 s, half overlapping. Mean and standard deviation of the objects. Each electrode scaled to 0..1, "
      "or to mean 0 and deviation 1 where the window's mean is taken off. Adam at 1e-3, {} steps of 64 at 50 ms, the LSTM of five layers half of them; the last state "
      "is judged.",
      (options.full ? 4 : 1) * direction_steps));
  return setup;
}

}  // namespace
}  // namespace biotac

Result biotac_table3(const ReproduceOptions& options) {
  using namespace biotac;
  const std::vector<DirectionNetwork> asked = rows_asked_for(direction_networks(options.full), options);
  if (!options.data.empty() && options.trials != 0)
    throw InputError("reproduce: --trials is for recordings that are made; allowed: --data alone");
  if (!options.data.empty()) check_simulated(options.data);
  Lessons lessons(options);
  const Touches touches = all_touches(options);
  std::vector<Row> rows;
  for (const DirectionNetwork& one : asked) rows.push_back(queued(one, touches, options.seed.value_or(1), lessons));
  lessons.run();

  Result result;
  result.title = "Direction of slip under a BioTac SP: t, n, e, s, w, cw, aw";
  result.source = fmt::format("Table 3 of {}. Figures in %.", paper);
  const auto columns = std::span(direction_columns).subspan(touches.real.empty() ? without_real_from : 0);
  result.tables = {published(),
                   scores_table("Seven classes, balanced accuracy, object left out (chance 14.3)", rows, columns, lessons,
                                &Scores::balanced, result.figures),
                   scores_table("Slip against touch, area under the curve, object left out", rows, columns, lessons, &Scores::auc,
                                result.figures)};
  for (const auto& [name, from] : result.figures.items()) {
    if (from.contains("real") && from.contains("synthetic_to_real"))
      result.real.push_back({fmt::format("slip against touch, AUC, {}: learnt here from real, from synthetic recordings", name),
                             from["real"]["auc"].get<double>(), from["synthetic_to_real"]["auc"].get<double>(), judged_here});
  }
  result.tables.back().note =
      "A network that names the direction says slip by the probability of all classes but t. The first columns are judged on real objects that were "
      "not learnt; synthetic and random site alone are one network each.";
  result.setup = setup_of(options, touches);
  result.remarks = {
      "The paper judges seven other objects, which are not in the local copy of its recordings: here each of the four is left out in turn.",
      "Where the finger is touched tells the direction in these recordings: without the window's mean there is only what moves within it."};
  if (!options.full) result.remarks.emplace_back("The paper's ConvLSTM has five layers of 32 filters (--full), here two of 8.");
  if (options.real.empty()) result.remarks.push_back(without_real("biotacsp-dos", "yayaneath/BioTacSP-DoS"));
  return result;
}

}  // namespace slipbench::reproduce
