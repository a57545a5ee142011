// Networks that learn from recordings of the piezoelectric skin's bench, and how well they judge others.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "tools/program/learn/validation.h"
#include "tools/studies/piezo_fft_gru/piezo_recordings.h"

namespace slipbench::reproduce {

inline constexpr std::size_t fold_count = 5;
inline constexpr std::size_t with_slip = 0, motors_alone = 1;  // groups of recordings

// A row of Table I.
struct NetworkRow {
  std::string name, text;
  learn::NetworkShape shape;
  std::size_t steps;
  double f1, accuracy;  // published, 0 to 1 and %
};
const std::vector<NetworkRow>& network_rows();

// The recordings at one level of the motors' vibration, as examples by either label.
struct MotorLevel {
  double level = 0.0;  // NaN: the dataset does not say
  std::map<learn::LabelRule, std::vector<learn::Example>> examples;
  std::vector<std::size_t> groups;  // of each example, with_slip or motors_alone
  std::vector<std::string> tips;    // of each example
  double labels_differ = 0.0;       // share of the frames of recordings with a slip
};
// By rising level. Throws InputError where a level has too few recordings that slip for the folds.
std::vector<MotorLevel> levels_of(const std::vector<PiezoRecording>& recordings);

using GroupCounts = std::array<learn::Counts, 2>;  // of with_slip and of motors_alone

struct NetworkFigures {
  double accuracy = 0.0, f1 = 0.0;  // balanced, %, NaN of none; of slip
};
NetworkFigures on_slip(const GroupCounts& counts);  // on recordings with a slip
NetworkFigures on_all(const GroupCounts& counts);

// Validations that the tables need: queued first, then run together.
class Validations {
 public:
  // `options` and all examples must outlive it.
  explicit Validations(const ReproduceOptions& options) : options_(options) {}

  // One network for each fold of `fold_of`. `slip_alone`: it learns from recordings with a slip alone. Returns a number to ask
  // with.
  std::size_t queue(const std::vector<learn::Example>& examples, const std::vector<std::size_t>& fold_of, const NetworkRow& row,
                    bool slip_alone);
  // Throws InputError and Interrupted.
  void run();

  // After run(): of all folds together, and fold by fold.
  [[nodiscard]] GroupCounts result(std::size_t validation) const;
  [[nodiscard]] const std::vector<GroupCounts>& folds(std::size_t validation) const { return by_fold_[validation]; }

 private:
  // One network to be judged on one fold.
  struct Task {
    std::size_t of;  // validation
    const std::vector<learn::Example>* examples;
    std::vector<std::size_t> fold_of;
    std::size_t fold;
    learn::Validation validation;
  };

  const ReproduceOptions& options_;
  std::vector<Task> tasks_;
  std::vector<std::vector<GroupCounts>> by_fold_;  // of each validation
};

}  // namespace slipbench::reproduce
