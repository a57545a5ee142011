#include "tools/program/train/hd_json.h"

#include <stdexcept>

namespace slipbench {
namespace {

constexpr std::array<std::pair<const char*, PadState>, 3> named_classes{
    {{"non_slip", PadState::non_slip}, {"incipient", PadState::incipient}, {"gross", PadState::gross}}};

Json confusion_json(const Confusion& confusion) {
  Json recalls;
  Json counts;
  for (const auto& [name, truth] : named_classes) {
    recalls[name] = or_null(recall(confusion, truth));
    for (const auto& [called_name, called] : named_classes) {
      counts[name][called_name] = confusion[static_cast<std::size_t>(truth)][static_cast<std::size_t>(called)];
    }
  }
  return {{"frames", samples_in_contact(confusion)},
          {"recall_of_slip", or_null(recall_of_slip(confusion))},
          {"balanced_accuracy", or_null(balanced_accuracy(confusion))},
          {"constant_balanced_accuracy", or_null(constant_balanced_accuracy(confusion))},
          {"accuracy", or_null(accuracy(confusion))},
          {"constant_accuracy", or_null(constant_accuracy(confusion))},
          {"recall", recalls},
          {"called", counts}};
}

Json delays_json(const Delays& delays) {
  return {{"sequences", delays.sequences},
          {"slipping", delays.slipping},
          {"noticed", delays.delay.size()},
          {"early", delays.early},
          {"missed", delays.missed},
          {"false_alarms", delays.false_alarms},
          {"delay_s",
           {{"lower_quartile", or_null(quantile(delays.delay, 0.25))},
            {"median", or_null(median(delays.delay))},
            {"upper_quartile", or_null(quantile(delays.delay, 0.75))}}}};
}

Json mean_sd_json(const MeanSd& value) { return {{"mean", or_null(value.mean)}, {"sd", or_null(value.sd)}}; }

Json model_json(const hd::Model& model, hd::Quantiser quantiser) {
  return {{"name", model_name(model)},
          {"dimension", model.dimension},
          {"window", model.window},
          {"context_driven", model.context_driven},
          {"compat", hd::name_of(hd::compat_words, model.compat)},
          {"ties", hd::name_of(hd::ties_words, model.ties)},
          {"quantiser", hd::name_of(hd::quantiser_words, quantiser)}};
}

}  // namespace

Evaluation pooled(std::span<const Evaluation> draws) {
  Evaluation sum;
  for (const Evaluation& draw : draws) {
    sum.training += draw.training;
    sum.distinct += draw.distinct;
    sum.tested += draw.tested;
    add(sum.all, draw.all);
    add(sum.moving, draw.moving);
    sum.delays.add(draw.delays);
  }
  return sum;
}

Json evaluation_json(const Evaluation& evaluation) {
  Json json = {{"training", evaluation.training},
               {"distinct", evaluation.distinct},
               {"tested", evaluation.tested},
               {"all", confusion_json(evaluation.all)},
               {"moving", confusion_json(evaluation.moving)}};
  if (evaluation.delays.sequences > 0) json["delay"] = delays_json(evaluation.delays);
  return json;
}

Json draws_json(std::span<const Evaluation> draws) {
  Json each = Json::array();
  for (const Evaluation& draw : draws) each.push_back(evaluation_json(draw));
  const auto figure = [&draws](double (*of)(const Confusion&), Confusion Evaluation::*frames) {
    return mean_sd_json(over_draws(draws, [&](const Evaluation& e) { return of(e.*frames); }));
  };
  return {{"recall_of_slip", figure(recall_of_slip, &Evaluation::all)},
          {"balanced_accuracy", figure(balanced_accuracy, &Evaluation::all)},
          {"accuracy", figure(accuracy, &Evaluation::all)},
          {"constant_accuracy", figure(constant_accuracy, &Evaluation::all)},
          {"moving_recall_of_slip", figure(recall_of_slip, &Evaluation::moving)},
          {"moving_balanced_accuracy", figure(balanced_accuracy, &Evaluation::moving)},
          {"moving_accuracy", figure(accuracy, &Evaluation::moving)},
          {"pooled", evaluation_json(pooled(draws.subspan(1)))},
          {"draws", each}};
}

Json train_json(const HdSummary& summary, const HdTraining& options) {
  return {{"dataset", options.dataset},
          {"memories", options.output},
          {"model", model_json(options.model, options.quantiser)},
          {"labels", slip_rule_name(options.sequences.labels)},
          {"seed", options.seed},
          {"sequences", summary.sequences},
          {"frames", summary.samples},
          {"by_sequence", draws_json(summary.by_sequence)},
          {"by_frame", draws_json(summary.by_frame)}};
}

std::string model_name(const hd::Model& model) {
  const std::string prefix = model.context_driven ? "CL-" : "";
  switch (model.encoding) {
    case hd::Encoding::spatial: return prefix + "sHDC";
    case hd::Encoding::spatial_temporal: return prefix + "stHDC";
    case hd::Encoding::graph_spatial_temporal: return prefix + "gstHDC";
  }
  throw std::logic_error("encoding without a name");
}

}  // namespace slipbench
