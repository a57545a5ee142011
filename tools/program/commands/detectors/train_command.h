// `train`: slip detectors taught on datasets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "tools/program/cli/command.h"
#include "tools/program/train/train_hd.h"
#include "tools/program/train/train_network.h"

namespace slipbench {

class TrainCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  // What the words ask for, once they have been read.
  HdTraining options;                              // of gst_hd
  std::optional<train::NetworkTraining> training;  // of any other recipe

 private:
  void read_hd();
  void read_network();
  int train_hd();
  int train_network();
  // What `eval` is to be told to judge the network by what it was taught: one of the sensors that it learnt from, and the labels.
  [[nodiscard]] std::string eval_options(const std::vector<std::string>& sensors) const;

  // As given; empty: was not.
  std::string recipe_;
  std::optional<hd::Encoding> encoding_;
  std::optional<hd::Compat> compat_;
  std::optional<hd::Ties> ties_;
  std::optional<hd::Quantiser> quantiser_;
  std::optional<std::size_t> dimension_, window_, jobs_;
  bool context_ = false, no_context_ = false;  // neither: the encoding's own default
  std::string labels_;
  std::optional<train::Split> split_;
  std::optional<std::size_t> steps_, held_out_, turned_;
  bool resume_ = false;
};

}  // namespace slipbench
