#include "tools/cli/commands/detectors/detector_commands.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/quantity.h"
#include "tools/cli/arguments.h"
#include "tools/files/reject.h"
#include "tools/learning_data/label_rules.h"
#include "tools/train/recipe_list.h"
#include "tools/workers/python_package/python_package.h"

namespace slipbench {
namespace {

// Returns lowest and highest rate [Hz] of a text such as "50 Hz..1 kHz", or "50..1000 Hz" with one unit
// for both.
std::array<double, 2> range_of_rates(const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots != std::string::npos) {
    const std::string high = text.substr(dots + 2);
    std::string low = text.substr(0, dots);
    if (low.find_first_not_of("0123456789. ") == std::string::npos)
      low += " " + high.substr(std::min(high.size(), high.find_first_not_of("0123456789. ")));
    try {
      const std::array rates{parse_quantity(low, Quantity::frequency), parse_quantity(high, Quantity::frequency)};
      if (rates[0] > 0.0 && rates[0] <= rates[1] && std::isfinite(rates[1])) return rates;
    } catch (const std::invalid_argument&) {
      // Reported below.
    }
  }
  reject("train: --rates is {}; expected the lowest and the highest rate, such as 50 Hz..1 kHz", quote(text));
}

}  // namespace

void TrainCommand::declare(Arguments& arguments) {
  arguments.about("train", "Train a network that detects slip",
                  fmt::format(R"(
Trains a network by a recipe of `slipbench list recipes` and writes it as an ONNX file, which records
the trials that it was trained on; `eval` leaves them out. `slipbench train-hd` trains the
hyperdimensional detector.

Data: if the dataset has a split, the network trains on train, chooses its state on valid (or on a
fifth of train, if valid is empty) and is tested on test. Without a split, or with --all, a fifth of
the trials is held out for the test, and a fifth of the rest for validation. With --split, a fifth of
the materials, objects or octaves of speed is held out.

The file contains the complete detector, including its operating point: the threshold, the
consecutive frames that begin and end an alarm, and the minimum duration of an alarm. On the
validation trials, training chooses the operating point with the highest balanced accuracy and at
most --alarms false alarms. With --score it chooses the operating point with which the first FILE has
the highest score of the open recordings of slip-4 (`slipbench benchmark`). The score depends on the
distance that the object has slipped at the alarm. The choice is limited to operating points that
raise no alarm in --specificity percent of the trials without slip, in each FILE (also of --with) with
20 such validation trials or more. If there is no such point, the nearest one is chosen. Training uses
one thread. --resume continues a killed training with a bit-identical result.

Labels:
{}
Examples:
  slipbench train hexapod.h5 --recipe papillarray_gru --steps 20 -o detector.onnx)",
                              label_rules_text(LabelUse::training)));
  arguments.input("FILE", dataset_, "Dataset (HDF5)", ".h5").required();
  arguments.file("-o,--output FILE.onnx", output_, "File for the network (required)").required();
  arguments.text("--recipe NAME", recipe_, "What to train (required): `slipbench list recipes`").offers(train::recipe_names);
  arguments.text("--labels RULE", labels_,
                 fmt::format("Labels: {} (default: of the recipe)", fmt::join(label_rule_names(LabelUse::training), ", ")));
  arguments.text("--sensor NAME", sensor_, "Name of the sensor in the scene (default: every sensor that fits)");
  arguments.number("--seed N", seed_, "Seed of weights and draws (default: 1)", 0);
  arguments.word("--split FACT", split_, "Property by which training and test are separated: {} (default: of the recipe)",
                 train::split_words);
  arguments.number("--held-out PERCENT", held_out_, "Share of the trials for the test, 0 to 50 (default: 20)", 0, 50);
  arguments.number("--steps N", steps_, "Training steps (default: of the recipe)", 1, 10'000'000);
  arguments.number("--turned N", turned_,
                   "For sensors with images: copies of each trial with rotated images, 0 to 11 (default: of the recipe)", 0, 11);
  arguments.text("--rates LOW..HIGH", rates_,
                 "Draw the rate of each trial from this range, e.g. '50 Hz..1 kHz' (default: rate of the recipe)");
  point_.declare(arguments, "1/min");
  arguments.lines("--with FILE", with_, "Another dataset for training, e.g. of grasps; repeatable");
  arguments.flag("--all", all_, "Ignore the split of the dataset (/mask) and divide all trials anew");
  arguments.flag("--resume", resume_, "Continue a killed training from OUTPUT.checkpoint-0");
  arguments.then([this] { read(); });
}

void TrainCommand::read() {
  if (recipe_.empty()) {
    reject(
        "train: needs --recipe, a name of `slipbench list recipes`; `slipbench train-hd` trains the hyperdimensional detector");
  }
  train::check_recipe(recipe_);
  point_.read("train");
  std::vector<std::string> datasets{dataset_};
  datasets.insert(datasets.end(), with_.begin(), with_.end());
  request = Json{{"datasets", datasets},
                 {"recipe", recipe_},
                 {"labels", Json()},
                 {"split", Json()},
                 {"held_out", Json()},
                 {"sensor", sensor_},
                 {"all", all_},
                 {"seed", seed_},
                 {"steps", or_null(steps_)},
                 {"turned", or_null(turned_)},
                 {"rates", rates_.empty() ? Json() : Json(range_of_rates(rates_))},
                 {"alarms", or_null(point_.alarms)},
                 {"by_score", point_.score},
                 {"specificity", or_null(point_.specificity)},
                 {"output", output_},
                 {"resume", resume_}};
  if (!labels_.empty()) request["labels"] = label_rule_name(labels_of("train", labels_, LabelUse::training));
  if (split_) request["split"] = choice_name(train::split_words, *split_);
  if (held_out_) request["held_out"] = 0.01 * static_cast<double>(*held_out_);
  if (!output_.ends_with(".onnx")) reject("train: -o {}: a network is an ONNX file, whose name must end with .onnx", output_);
}

int TrainCommand::run() {
  const PythonModule module("slipbench._train", "train --recipe " + recipe_, "");
  take_stdout_back();
  request["json"] = json;
  module.start(request);
}

}  // namespace slipbench
