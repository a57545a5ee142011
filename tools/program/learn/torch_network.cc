// The only file with libtorch's headers.
#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include <torch/torch.h>

#include "sim/core/random.h"
#include "tools/program/learn/torch_library.h"

namespace slipbench::learn {
namespace {

namespace nn = torch::nn;
using torch::Tensor;

std::int64_t extent(std::size_t value) { return static_cast<std::int64_t>(value); }

// Features [B, T, inputs] to logits of hold and slip [B, T, 2].
class Layers final : public nn::Module {
 public:
  Layers(const NetworkShape& shape, std::uint64_t seed) : shape_(shape) {
    RandomStream random(seed, 0, "network");
    const std::int64_t dim = extent(shape.dim);
    if (shape.architecture == Architecture::gru) {
      gru_ = register_module(
          "gru", nn::GRU(nn::GRUOptions(extent(shape.inputs), dim).num_layers(extent(shape.layers)).batch_first(true)));
      draw(gru_->parameters(), shape.dim, random);
    }
    for (std::size_t layer = 0; gru_.is_empty() && layer < shape.layers; ++layer) {
      const std::size_t inputs = layer == 0 ? shape.inputs : shape.dim;
      const std::string name = "layer" + std::to_string(layer);
      if (shape.architecture == Architecture::mlp) {
        linear_.push_back(register_module(name, nn::Linear(extent(inputs), dim)));
        draw(linear_.back()->parameters(), inputs, random);
      } else {
        conv_.push_back(register_module(name, nn::Conv1d(nn::Conv1dOptions(extent(inputs), dim, extent(shape.kernel)))));
        draw(conv_.back()->parameters(), inputs * shape.kernel, random);
      }
    }
    classes_ = register_module("classes", nn::Linear(dim, 2));
    draw(classes_->parameters(), shape.dim, random);
  }

  Tensor forward(Tensor x) {
    if (!gru_.is_empty()) return classes_(std::get<0>(gru_(x)));
    for (nn::Linear& layer : linear_) x = torch::relu(layer(x));
    if (!conv_.empty()) {
      x = x.transpose(1, 2);  // [B, channels, T]
      const std::int64_t past = extent(shape_.kernel) - 1;
      for (nn::Conv1d& layer : conv_) x = torch::relu(layer(torch::constant_pad_nd(x, {past, 0})));  // sees no later frame
      x = x.transpose(1, 2);
    }
    return classes_(x);
  }

 private:
  static void draw(const std::vector<Tensor>& parameters, std::size_t fan_in, RandomStream& random) {
    const torch::NoGradGuard no_gradient;
    const double bound = 1.0 / std::sqrt(static_cast<double>(fan_in));
    for (const Tensor& parameter : parameters) {
      float* const values = parameter.data_ptr<float>();
      std::generate_n(values, parameter.numel(), [&] { return static_cast<float>(random.uniform(-bound, bound)); });
    }
  }

  NetworkShape shape_;
  std::vector<nn::Linear> linear_;
  std::vector<nn::Conv1d> conv_;
  nn::GRU gru_{nullptr};
  nn::Linear classes_{nullptr};
};

// Weight of hold and of slip: a class counts by the inverse of its share.
Tensor class_weights(std::span<const FrameSequence> sequences, std::size_t inputs) {
  std::array<double, 2> frames{};
  for (const FrameSequence& sequence : sequences) {
    if (sequence.slip.size() * inputs != sequence.features.size()) throw std::invalid_argument("features do not fit the labels");
    for (const std::uint8_t slip : sequence.slip) frames[slip != 0 ? 1 : 0] += 1.0;
  }
  if (frames[0] == 0.0 || frames[1] == 0.0) throw std::invalid_argument("a class has no frame to learn from");
  const double all = frames[0] + frames[1];
  return torch::tensor({static_cast<float>(0.5 * all / frames[0]), static_cast<float>(0.5 * all / frames[1])});
}

// Clips drawn from the sequences, each sequence equally often.
class Clips {
 public:
  Clips(std::span<const FrameSequence> sequences, const TrainingOptions& options, std::size_t inputs)
      : sequences_(sequences), inputs_(inputs), batch_(options.batch), clip_(options.clip), random_(options.seed, 0, "clips") {
    for (const FrameSequence& sequence : sequences) clip_ = std::min(clip_, sequence.slip.size());
    if (clip_ == 0 || batch_ == 0) throw std::invalid_argument("a clip without a frame");
  }

  // Features [B, T, inputs] and classes [B T].
  std::pair<Tensor, Tensor> draw() {
    Tensor features = torch::empty({extent(batch_), extent(clip_), extent(inputs_)});
    Tensor classes = torch::empty({extent(batch_ * clip_)}, torch::kLong);
    for (std::size_t b = 0; b < batch_; ++b) {
      const FrameSequence& sequence = sequences_[random_.integer(sequences_.size())];
      const std::size_t first = random_.integer(sequence.slip.size() - clip_ + 1);
      std::copy_n(sequence.features.data() + first * inputs_, clip_ * inputs_, features.data_ptr<float>() + b * clip_ * inputs_);
      std::copy_n(sequence.slip.data() + first, clip_, classes.data_ptr<std::int64_t>() + b * clip_);
    }
    return {features, classes};
  }

 private:
  std::span<const FrameSequence> sequences_;
  std::size_t inputs_, batch_, clip_;
  RandomStream random_;
};

// One network works at a time: with the BLAS of Debian (libopenblas0-serial) two at a time give other weights now and then.
std::mutex& turn() {
  static std::mutex mutex;
  return mutex;
}

class TorchNetwork final : public Network {
 public:
  TorchNetwork(const NetworkShape& shape, std::uint64_t seed) : shape_(shape), layers_(shape, seed) {}

  std::vector<float> weights() const override {
    std::vector<float> all;
    for (const Tensor& parameter : layers_.parameters()) {
      all.insert(all.end(), parameter.data_ptr<float>(), parameter.data_ptr<float>() + parameter.numel());
    }
    return all;
  }

  std::vector<double> train(std::span<const FrameSequence> sequences, const TrainingOptions& options) override {
    const std::lock_guard alone(turn());
    const Tensor weights = class_weights(sequences, shape_.inputs);
    Clips clips(sequences, options, shape_.inputs);
    torch::optim::RMSprop optimiser(layers_.parameters(), torch::optim::RMSpropOptions(options.learning_rate));
    std::vector<double> losses;
    for (std::size_t step = 0; step < options.steps; ++step) {
      const double done = static_cast<double>(step) / static_cast<double>(options.steps);
      static_cast<torch::optim::RMSpropOptions&>(optimiser.param_groups()[0].options())
          .lr(options.learning_rate * (1.0 - 0.9 * done));
      const auto [features, classes] = clips.draw();
      const Tensor loss = torch::nn::functional::cross_entropy(layers_.forward(features).reshape({-1, 2}), classes,
                                                               torch::nn::functional::CrossEntropyFuncOptions().weight(weights));
      optimiser.zero_grad();
      loss.backward();
      optimiser.step();
      losses.push_back(loss.item<double>());
    }
    return losses;
  }

  std::vector<float> log_odds(std::span<const float> features) const override {
    const std::lock_guard alone(turn());
    const torch::NoGradGuard no_gradient;
    const std::int64_t frames = extent(features.size() / shape_.inputs);
    Tensor input = torch::empty({1, frames, extent(shape_.inputs)});
    std::copy(features.begin(), features.end(), input.data_ptr<float>());
    const Tensor logits = layers_.forward(input);
    const Tensor odds = (logits.select(2, 1) - logits.select(2, 0)).contiguous();
    return {odds.data_ptr<float>(), odds.data_ptr<float>() + odds.numel()};
  }

 private:
  NetworkShape shape_;
  mutable Layers layers_;  // libtorch's forward() is not const
};

}  // namespace
}  // namespace slipbench::learn

// One thread a network: the order of sums is then the same everywhere.
extern "C" __attribute__((visibility("default"))) slipbench::learn::Network* slipbench_make_network(
    const slipbench::learn::NetworkShape& shape, std::uint64_t seed) {
  at::set_num_threads(1);
  return new slipbench::learn::TorchNetwork(shape, seed);
}
