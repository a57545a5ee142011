#include "tools/studies/biotac/biotac_stability.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "sensors/biotac_sp/electrodes.h"
#include "sim/core/error.h"

namespace slipbench::reproduce::biotac {
namespace {

constexpr std::size_t inputs = fingers * electrodes, plain_steps = 1000, network_steps = 500;
constexpr std::size_t published_draws = 620;  // of each of nine cells: 5,580 grasps of the 5,581

// A row of a table in which networks are compared on all data that there are, by sample and by object.
struct Compared {
  std::string name;
  std::vector<std::string> first;                    // cells: what it is, the paper's
  std::vector<std::pair<Set, std::size_t>> lessons;  // of Lessons, in the order of the columns
};

std::string grasps_text(const std::vector<Grasp>& grasps) {
  std::set<std::string> objects;
  for (const Grasp& grasp : grasps) objects.insert(grasp.object);
  return fmt::format(
      "{} grasps of {} objects, {:.0f} % lost", grasps.size(), objects.size(),
      100.0 * static_cast<double>(std::ranges::count(grasps, true, &Grasp::slipped)) / static_cast<double>(grasps.size()));
}

}  // namespace

StabilityNetwork logistic_regression() {
  return {{"lr", "logistic regression", {inputs, {train::Linear{2}}}, plain_steps}, as_list};
}

StabilityNetwork plain_network(std::size_t more) {
  StabilityNetwork mlp{
      {"mlp", "MLP 128", {inputs, {train::Linear{128}, train::BatchNorm{}, train::Relu{}, train::Linear{2}}}, more * plain_steps},
      as_list};
  if (more == 1) return mlp;
  mlp.network.name = "mlp_longer";
  mlp.network.text = fmt::format("MLP 128, {} times the steps", more);
  return mlp;
}

StabilityNetwork cnn(const train::biotac::ImageLayout& layout, std::size_t units) {
  return {{"cnn", fmt::format("CNN {}, {} ({} x {})", units, layout.name, layout.rows, layout.columns),
           train::biotac::image_network(layout, fingers, units), network_steps},
          [&layout](const Grasp& grasp) { return as_image(grasp, layout); }};
}

StabilityNetwork gcn(const std::vector<double>& adjacency, std::string name, std::string text) {
  return {{std::move(name), std::move(text), train::biotac::graph_network(adjacency, fingers), network_steps}, as_graph};
}

std::vector<double> nearest_graph(std::size_t k) {
  if (k == 0) return train::biotac::drawn_graph();
  const auto& places = biotac_sp::electrode_places();
  std::vector<double> adjacency(electrodes * electrodes, 0.0);
  for (std::size_t node = 0; node < electrodes; ++node) {
    std::vector<std::size_t> order(electrodes);
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, [&](std::size_t other) { return (places[other] - places[node]).squaredNorm(); });
    for (std::size_t i = 0; i <= k; ++i) adjacency[node * electrodes + order[i]] = 1.0 / static_cast<double>(k + 1);
  }
  return adjacency;
}

Set set_of(const std::vector<Grasp>& grasps, const StabilityNetwork& network, FoldsBy by, std::uint64_t seed) {
  Set set;
  set.folds = stability_folds;
  std::vector<std::string> objects;
  for (const Grasp& grasp : grasps) {
    set.examples.push_back(network.shown(grasp));
    objects.push_back(grasp.object);
  }
  set.fold_of = by == FoldsBy::object ? folds_by_object(objects, set.folds, seed)
                                      : train::folds(std::vector<std::size_t>(grasps.size()), set.folds, seed);
  return set;
}

GraspSets grasps_for(const ReproduceOptions& options, std::size_t usual, const std::function<bool(const Grasp&)>& kept) {
  if (!options.data.empty() && options.trials != 0)
    throw InputError("reproduce: --trials is for grasps that are made; allowed: --data alone");
  if (!options.data.empty()) check_simulated(options.data);
  GraspSets sets;
  if (!options.real.empty()) sets.real = read_grasps(options.real, options);
  sets.synthetic = options.data.empty() ? run_grasps(options.trials != 0 ? options.trials
                                                     : options.full      ? published_draws
                                                                         : usual,
                                                     options)
                                        : read_grasps(options.data, options);
  for (std::vector<Grasp>* grasps : {&sets.real, &sets.synthetic})
    std::erase_if(*grasps, [&](const Grasp& one) { return !kept(one); });
  return sets;
}

Result compare(const ReproduceOptions& options, const GraspSets& grasps, const std::vector<std::string>& head,
               const std::vector<std::pair<StabilityNetwork, std::vector<std::string>>>& networks) {
  Lessons lessons(options);
  ResultTable table;
  table.head = head;
  std::vector<std::pair<const std::vector<Grasp>*, const char*>> sources;
  if (!grasps.real.empty()) sources.emplace_back(&grasps.real, "real");
  sources.emplace_back(&grasps.synthetic, "synthetic");
  std::vector<Compared> rows;
  for (const auto& [network, first] : networks) {
    Compared& row = rows.emplace_back(Compared{network.network.name, first, {}});
    for (const auto& [source, name] : sources) {
      for (const FoldsBy by : {FoldsBy::sample, FoldsBy::object}) {
        Set set = set_of(*source, network, by, options.seed.value_or(1));
        const std::size_t number = lessons.queue(set, nullptr, Learns::own, network.network);
        set.examples.clear();
        row.lessons.emplace_back(std::move(set), number);
      }
    }
  }
  lessons.run();
  Result result;
  for (const auto& [source, name] : sources) {
    for (const char* by : {"by sample", "by object"}) table.head.push_back(fmt::format("{}: {}", name, by));
  }
  for (const Compared& row : rows) {
    std::vector<std::string> cells = row.first;
    for (std::size_t i = 0; i < row.lessons.size(); ++i) {
      const auto& [set, number] = row.lessons[i];
      const Scores scores = scores_of(lessons.answers(number), set.fold_of);
      cells.push_back(cell(scores.accuracy));
      result.figures[sources[i / 2].second][i % 2 == 0 ? "by_sample" : "by_object"][row.name] = json_of(scores);
    }
    table.rows.push_back(std::move(cells));
  }
  result.tables.push_back(std::move(table));
  result.setup = stability_setup(options, grasps);
  if (options.real.empty()) result.remarks.push_back(without_real("bts3v2", "3dperceptionlab/biotacsp-stability-set-v2"));
  return result;
}

std::vector<std::string> stability_setup(const ReproduceOptions& options, const GraspSets& grasps) {
  std::vector<std::string> lines;
  if (!grasps.real.empty())
    lines.push_back(fmt::format("Real: {} of {} (paper: 5,581 of 51).", grasps_text(grasps.real), options.real));
  lines.push_back(fmt::format("Synthetic: {} of {}.", grasps_text(grasps.synthetic),
                              options.data.empty() ? "scenes/biotac_sp/grasp.yaml, three sets of fingers" : options.data));
  lines.push_back(
      fmt::format("{} folds; mean and standard deviation of the folds. One network learns all palms.", stability_folds));
  lines.push_back(fmt::format(
      "Each electrode scaled to 0..1 by what is learnt. Adam at 1e-3, {} steps of 64 for CNN and GCN, {} for the others, classes drawn alike; the "
      "last state is judged.",
      (options.full ? 4 : 1) * network_steps, (options.full ? 4 : 1) * plain_steps));
  return lines;
}

}  // namespace slipbench::reproduce::biotac
