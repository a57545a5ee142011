// The only file with libtorch's headers.
#include <fcntl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include <openssl/evp.h>
#include <torch/torch.h>

#include "sim/core/process/regular_file.h"
#include "sim/core/random.h"
#include "tools/base/files/reject.h"
#include "tools/program/train/network/network.h"

namespace slipbench::train {
namespace {

using torch::Tensor;

constexpr std::int64_t ignored = -100;  // class of a masked frame, for libtorch

std::int64_t extent(std::size_t value) { return static_cast<std::int64_t>(value); }

std::vector<std::int64_t> sizes_of(const Shape& shape) { return {shape.begin(), shape.end()}; }

Tensor copied(std::span<const float> values, const std::vector<std::int64_t>& sizes) {
  Tensor tensor = torch::empty(sizes);
  std::copy(values.begin(), values.end(), tensor.data_ptr<float>());
  return tensor;
}

// Frames [N, T, shape...] through one layer at a time.
class Forward {
 public:
  // `state`: the parameters of all layers.
  Forward(const NetworkShape& shape, std::vector<Tensor>& state, bool learns) : shape_(shape), state_(state), learns_(learns) {}

  Tensor operator()(Tensor x) {
    next_ = 0;
    for (const Layer& layer : shape_.layers) x = std::visit([&](const auto& kind) { return apply(kind, x); }, layer);
    return x;
  }

 private:
  Tensor& take() { return state_[next_++]; }

  // Every frame by itself: `of` takes and gives [N T, shape...].
  template <class Of>
  static Tensor each_frame(const Tensor& x, Of&& of) {
    const Tensor y = of(x.flatten(0, 1));
    std::vector<std::int64_t> sizes = y.sizes().vec();
    sizes[0] = x.size(0);
    sizes.insert(sizes.begin() + 1, x.size(1));
    return y.reshape(sizes);
  }

  Tensor apply(const Linear&, const Tensor& x) {
    const Tensor &weight = take(), &bias = take();
    return torch::linear(x, weight, bias);
  }
  static Tensor apply(const Relu&, const Tensor& x) { return torch::relu(x); }
  static Tensor apply(const Tanh&, const Tensor& x) { return torch::tanh(x); }
  Tensor apply(const BatchNorm& norm, const Tensor& x) {
    const Tensor &scale = take(), &offset = take(), &mean = take(), &variance = take();
    const auto axis = extent(norm.axis) + 1;
    return each_frame(x, [&](const Tensor& frames) {
      const Tensor moved = axis == 1 ? frames : frames.transpose(1, axis);
      const Tensor y = torch::batch_norm(moved, scale, offset, mean, variance, learns_, 0.1, 1e-5, false);
      return axis == 1 ? y : y.transpose(1, axis);
    });
  }
  Tensor apply(const Gru& gru, const Tensor& x) {
    const std::vector<Tensor> weights{take(), take(), take(), take()};
    return std::get<0>(
        torch::gru(x, torch::zeros({1, x.size(0), extent(gru.units)}), weights, true, 1, 0.0, learns_, false, true));
  }
  Tensor apply(const Lstm& lstm, const Tensor& x) {
    const std::vector<Tensor> weights{take(), take(), take(), take()};
    const Tensor zero = torch::zeros({1, x.size(0), extent(lstm.units)});
    return std::get<0>(torch::lstm(x, {zero, zero}, weights, true, 1, 0.0, learns_, false, true));
  }
  Tensor apply(const ConvLstm& lstm, const Tensor& x) {
    const Tensor &weight = take(), &bias = take();
    const std::int64_t padding = extent(lstm.kernel) / 2;
    Tensor hidden = torch::zeros({x.size(0), extent(lstm.channels), x.size(3), x.size(4)}), cell = hidden;
    std::vector<Tensor> frames;
    for (std::int64_t t = 0; t < x.size(1); ++t) {
      const Tensor gates = torch::conv2d(torch::cat({x.select(1, t), hidden}, 1), weight, bias, 1, padding);
      const std::vector<Tensor> four = gates.chunk(4, 1);
      cell = torch::sigmoid(four[1]) * cell + torch::sigmoid(four[0]) * torch::tanh(four[2]);
      hidden = torch::sigmoid(four[3]) * torch::tanh(cell);
      frames.push_back(hidden);
    }
    return torch::stack(frames, 1);
  }
  Tensor apply(const Conv1d&, const Tensor& x) {
    const Tensor &weight = take(), &bias = take();
    return torch::conv1d(x.transpose(1, 2), weight, bias).transpose(1, 2);
  }
  Tensor apply(const Conv2d& conv, const Tensor& x) {
    const Tensor &weight = take(), &bias = take();
    return each_frame(x, [&](const Tensor& frames) { return torch::conv2d(frames, weight, bias, 1, extent(conv.padding)); });
  }
  static Tensor apply(const MaxPool&, const Tensor& x) {
    return each_frame(x, [](const Tensor& frames) { return torch::max_pool2d(frames, 2); });
  }
  static Tensor apply(const GlobalAverage&, const Tensor& x) { return x.mean({3, 4}); }
  static Tensor apply(const PoolUnits& pool, const Tensor& x) {
    const Tensor both = torch::cat({x.mean(2, true), x.amax(2, true)}, 3);
    return pool.beside ? torch::cat({x, both.expand({-1, -1, x.size(2), -1})}, 3) : both.squeeze(2);
  }
  Tensor apply(const GraphConvolution& graph, const Tensor& x) {
    const Tensor &weight = take(), &bias = take();
    const std::vector<float> adjacency(graph.adjacency.begin(), graph.adjacency.end());
    return torch::matmul(copied(adjacency, {x.size(2), x.size(2)}), torch::matmul(x, weight)) + bias;
  }
  static Tensor apply(const Flatten&, const Tensor& x) { return x.flatten(2); }
  static Tensor apply(const Reshape& reshape, const Tensor& x) {
    std::vector<std::int64_t> sizes = sizes_of(reshape.shape);
    sizes.insert(sizes.begin(), {x.size(0), x.size(1)});
    return x.reshape(sizes);
  }
  static Tensor apply(const Permute& permute, const Tensor& x) {
    std::vector<std::int64_t> order{0, 1};
    for (const std::size_t axis : permute.order) order.push_back(extent(axis) + 2);
    return x.permute(order);
  }
  static Tensor apply(const Last&, const Tensor& x) { return x.narrow(1, x.size(1) - 1, 1); }

  const NetworkShape& shape_;
  std::vector<Tensor>& state_;
  bool learns_;
  std::size_t next_ = 0;
};

// A checkpoint begins with the SHA-256 of what follows: libtorch notices no changed bit in its archives.
constexpr std::size_t digest_size = 32;

std::string digest_of(const std::string& bytes) {
  std::array<unsigned char, digest_size> digest{};
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1)
    throw std::bad_alloc();  // nothing else can be amiss
  return {digest.begin(), digest.end()};
}

// What clips are drawn from.
class Clips {
 public:
  Clips(std::span<const FrameSequence> sequences, const TrainingOptions& options, const NetworkShape& shape)
      : sequences_(sequences),
        options_(options),
        inputs_(shape.inputs),
        before_(history_of(shape) - 1),
        of_class_(class_count(shape)) {
    answers_ = std::ranges::any_of(shape.layers, [](const Layer& layer) { return std::holds_alternative<Last>(layer); })
                   ? 1
                   : options.clip;
    std::size_t longest = 0;
    for (std::size_t s = 0; s < sequences.size(); ++s) {
      const FrameSequence& sequence = sequences[s];
      if (sequence.label.size() * inputs_ != sequence.features.size())
        throw std::invalid_argument("features do not fit the labels");
      if (sequence.label.size() <= before_) throw std::invalid_argument("a sequence is shorter than what an answer is made of");
      longest = std::max(longest, sequence.label.size() - before_);
      std::vector<std::uint8_t>& labels = labels_.emplace_back(sequence.label);
      std::size_t run = 0;
      for (std::size_t t = 0; t < labels.size(); ++t) {
        run = t > 0 && sequence.label[t] == sequence.label[t - 1] ? run + 1 : 1;
        if (labels[t] == masked) continue;
        if (labels[t] >= of_class_.size()) throw std::invalid_argument("a label is no class");
        if (labels[t] > 0 && options.onset_frames > 0 && run > options.onset_frames && run % 10 != 0) labels[t] = masked;
        if (labels[t] != masked && t >= before_) of_class_[labels[t]].push_back({s, t});
      }
    }
    answers_ = std::min(answers_, longest);
    if (answers_ == 0 || options.batch == 0) throw std::invalid_argument("a clip without a frame");
    for (const std::vector<Place>& frames : of_class_) {
      if (frames.empty()) throw std::invalid_argument("a class has no frame to learn from");
    }
  }

  // Of each class: the inverse of its share; all alike where classes are drawn.
  [[nodiscard]] Tensor weights() const {
    double all = 0.0;
    for (const std::vector<Place>& frames : of_class_) all += static_cast<double>(frames.size());
    std::vector<float> weights;
    for (const std::vector<Place>& frames : of_class_) {
      weights.push_back(options_.balance == Balance::drawing
                            ? 1.0F
                            : static_cast<float>(all / static_cast<double>(of_class_.size() * frames.size())));
    }
    return copied(weights, {extent(weights.size())});
  }

  // Those of a step, whatever was drawn before: features [B, T, inputs] and classes [B, T'].
  [[nodiscard]] std::pair<Tensor, Tensor> draw(std::size_t step) const {
    RandomStream random(options_.seed, step, "clips");
    const std::size_t frames = answers_ + before_;
    Tensor features = torch::empty({extent(options_.batch), extent(frames), extent(inputs_)});
    Tensor classes = torch::empty({extent(options_.batch), extent(answers_)}, torch::kLong);
    for (std::size_t b = 0; b < options_.batch; ++b) {
      const Place place = options_.balance == Balance::drawing ? around_a_class(random) : anywhere(random);
      const FrameSequence& sequence = sequences_[place.sequence];
      const std::size_t there = std::min(frames, sequence.label.size() - place.frame);
      float* into_features = features.data_ptr<float>() + b * frames * inputs_;
      into_features = std::copy_n(sequence.features.data() + place.frame * inputs_, there * inputs_, into_features);
      for (std::size_t t = there; t < frames; ++t)
        into_features = std::copy_n(sequence.features.end() - extent(inputs_), inputs_, into_features);
      std::int64_t* const into = classes.data_ptr<std::int64_t>() + b * answers_;
      for (std::size_t t = 0; t < answers_; ++t) {
        const std::uint8_t label = before_ + t < there ? labels_[place.sequence][place.frame + before_ + t] : masked;
        into[t] = label == masked ? ignored : label;
      }
    }
    return {features, classes};
  }

 private:
  struct Place {
    std::size_t sequence = 0, frame = 0;
  };
  // The last frame that a clip of a sequence can begin with.
  [[nodiscard]] std::size_t latest(std::size_t sequence) const {
    const std::size_t answers = sequences_[sequence].label.size() - before_;
    return answers > answers_ ? answers - answers_ : 0;
  }
  Place anywhere(RandomStream& random) const {
    const std::size_t sequence = random.integer(sequences_.size());
    return {sequence, random.integer(latest(sequence) + 1)};
  }
  Place around_a_class(RandomStream& random) const {
    const std::vector<Place>& frames = of_class_[random.integer(of_class_.size())];
    const Place wanted = frames[random.integer(frames.size())];
    const std::size_t answer = wanted.frame - before_, last = latest(wanted.sequence);
    const std::size_t first = answer + 1 > answers_ ? answer + 1 - answers_ : 0, end = std::min(answer, last);
    return {wanted.sequence, first + random.integer(end - first + 1)};
  }

  std::span<const FrameSequence> sequences_;
  const TrainingOptions& options_;
  std::vector<std::vector<std::uint8_t>> labels_;  // of each sequence, those that teach
  std::size_t inputs_, before_, answers_ = 0;      // frames before the first answer of a clip, answers of a clip
  std::vector<std::vector<Place>> of_class_;       // the frames that have an answer, by class
};

// One network works at a time: with the BLAS of Debian (libopenblas0-serial) two at a time give other weights now and then.
std::mutex& turn() {
  static std::mutex mutex;
  return mutex;
}

class TorchNetwork final : public Network {
 public:
  TorchNetwork(const NetworkShape& shape, std::uint64_t seed)
      : shape_(shape), classes_(class_count(shape)), history_(history_of(shape)) {
    RandomStream random(seed, 0, "network");
    Shape frame{shape.inputs};
    for (const Layer& layer : shape.layers) {
      for (const Parameter& parameter : parameters_of(layer, frame)) {
        Tensor tensor = torch::full(sizes_of(parameter.shape), parameter.first);
        if (parameter.drawn) {
          const double bound = 1.0 / std::sqrt(static_cast<double>(parameter.fan_in));
          std::generate_n(tensor.data_ptr<float>(), tensor.numel(),
                          [&] { return static_cast<float>(random.uniform(-bound, bound)); });
        }
        if (!parameter.running) {
          tensor.requires_grad_(true);
          learnt_.push_back(tensor);
        }
        state_.push_back(tensor);
      }
      frame = shape_after(layer, frame);
    }
  }

  const NetworkShape& shape() const override { return shape_; }

  std::vector<std::vector<float>> state() const override {
    std::vector<std::vector<float>> all;
    for (const Tensor& tensor : state_) all.emplace_back(tensor.data_ptr<float>(), tensor.data_ptr<float>() + tensor.numel());
    return all;
  }

  TrainingResult train(std::span<const FrameSequence> learnt, std::span<const FrameSequence> validation,
                       const TrainingOptions& options, const Checkpoint& checkpoint,
                       const std::function<void(const TrainingProgress&)>& report) override {
    const std::lock_guard alone(turn());
    const Clips clips(learnt, options, shape_);
    const Tensor weights = clips.weights();
    const auto optimiser = make_optimiser(options);
    Run run;
    const bool left = !checkpoint.path.empty() && std::filesystem::exists(checkpoint.path);
    if (left && !checkpoint.resume) {
      throw InputError(
          checkpoint.path +
          ": is what a training that did not end has left; allowed: --resume, which goes on with it, or none of that file");
    }
    if (left) {
      load(checkpoint, *optimiser, run);
    } else {
      keep(run);
    }
    while (!run.ended && run.result.losses.size() < options.steps) {
      if (options.before_step) options.before_step();
      const std::size_t step = run.result.losses.size();
      set_rate(*optimiser, options.learning_rate * (1.0 - (1.0 - options.final_rate) * static_cast<double>(step) /
                                                              static_cast<double>(options.steps)));
      run.result.losses.push_back(learn(clips.draw(step), weights, *optimiser, options));
      const std::size_t done = step + 1;
      if (done % std::max<std::size_t>(options.validate_every, 1) == 0 || done == options.steps) {
        judge(run, validation, options, done);
        if (!checkpoint.path.empty()) save(checkpoint, *optimiser, run);
        if (report) report(progress(run, options, done, validation.empty()));
      }
    }
    const torch::NoGradGuard no_gradient;
    for (std::size_t i = 0; i < state_.size(); ++i) state_[i].copy_(run.best[i]);
    return run.result;
  }

  std::vector<float> logits(std::span<const float> features) const override {
    const std::lock_guard alone(turn());
    const std::int64_t frames = extent(features.size() / shape_.inputs);
    const Tensor output = answers(copied(features, {1, frames, extent(shape_.inputs)})).contiguous();
    return {output.data_ptr<float>(), output.data_ptr<float>() + output.numel()};
  }

 private:
  // A training as far as it has come.
  struct Run {
    TrainingResult result;
    std::vector<Tensor> best;
    double latest = 0.0;             // balanced accuracy of the latest validation
    std::size_t worse = 0;           // validations since the best one
    std::size_t reported_steps = 0;  // whose loss has been reported
    bool ended = false;
  };

  void keep(Run& run) const {
    run.best.clear();
    for (const Tensor& tensor : state_) run.best.push_back(tensor.detach().clone());
  }

  std::unique_ptr<torch::optim::Optimizer> make_optimiser(const TrainingOptions& options) const {
    if (options.optimiser == Optimiser::adam)
      return std::make_unique<torch::optim::Adam>(learnt_, torch::optim::AdamOptions(options.learning_rate));
    return std::make_unique<torch::optim::RMSprop>(learnt_, torch::optim::RMSpropOptions(options.learning_rate));
  }

  static void set_rate(torch::optim::Optimizer& optimiser, double rate) { optimiser.param_groups()[0].options().set_lr(rate); }

  double learn(const std::pair<Tensor, Tensor>& clips, const Tensor& weights, torch::optim::Optimizer& optimiser,
               const TrainingOptions& options) {
    const auto& [features, classes] = clips;
    const Tensor logits = Forward(shape_, state_, true)(features);
    const Tensor loss = torch::nn::functional::cross_entropy(logits.reshape({-1, extent(classes_)}), classes.reshape({-1}),
                                                             torch::nn::functional::CrossEntropyFuncOptions()
                                                                 .weight(weights)
                                                                 .label_smoothing(options.label_smoothing)
                                                                 .ignore_index(ignored));
    optimiser.zero_grad();
    loss.backward();
    optimiser.step();
    return loss.item<double>();
  }

  // Logits of frames [N, T, inputs]: [N, T - history + 1, classes].
  Tensor answers(const Tensor& features) const {
    const torch::NoGradGuard no_gradient;
    Forward forward(shape_, state_, false);
    const bool windows =
        std::ranges::any_of(shape_.layers, [](const Layer& layer) { return std::holds_alternative<Last>(layer); });
    if (!windows) return forward(features);
    const Tensor every = features.unfold(1, extent(history_), 1).permute({0, 1, 3, 2}).contiguous();  // [N, T', history, inputs]
    std::vector<Tensor> parts;  // what is convolved over many windows at once takes much memory
    const Tensor flat = every.flatten(0, 1);
    for (std::int64_t first = 0; first < flat.size(0); first += 256)
      parts.push_back(forward(flat.narrow(0, first, std::min<std::int64_t>(256, flat.size(0) - first))));
    return torch::cat(parts).reshape({every.size(0), every.size(1), extent(classes_)});
  }

  // Mean of the recalls of the classes that occur.
  double balanced_accuracy(std::span<const FrameSequence> sequences) const {
    std::vector<double> right(classes_), all(classes_);
    for (std::size_t first = 0; first < sequences.size();) {
      const std::size_t length = sequences[first].label.size();
      std::size_t last = first;  // sequences of one length go through together, up to some 4,096 frames
      while (last < sequences.size() && sequences[last].label.size() == length &&
             (last - first + 1) * length <= std::max<std::size_t>(4096, length))
        ++last;
      Tensor features = torch::empty({extent(last - first), extent(length), extent(shape_.inputs)});
      for (std::size_t s = first; s < last; ++s)
        std::ranges::copy(sequences[s].features, features.data_ptr<float>() + (s - first) * length * shape_.inputs);
      const Tensor called = answers(features).argmax(2).contiguous();
      for (std::size_t s = first; s < last; ++s) {
        const std::int64_t* const row = called.data_ptr<std::int64_t>() + static_cast<std::int64_t>(s - first) * called.size(1);
        for (std::size_t t = history_ - 1; t < length; ++t) {
          const std::uint8_t label = sequences[s].label[t];
          if (label == masked) continue;
          all[label] += 1.0;
          right[label] += row[t + 1 - history_] == label ? 1.0 : 0.0;
        }
      }
      first = last;
    }
    double sum = 0.0, occurring = 0.0;
    for (std::size_t c = 0; c < classes_; ++c) {
      if (all[c] == 0.0) continue;
      sum += right[c] / all[c];
      occurring += 1.0;
    }
    return sum / occurring;
  }

  void judge(Run& run, std::span<const FrameSequence> validation, const TrainingOptions& options, std::size_t done) const {
    if (!validation.empty()) run.latest = balanced_accuracy(validation);
    if (validation.empty() || std::isnan(run.result.validation) || run.latest > run.result.validation) {
      keep(run);
      run.result.best_step = done;
      if (!validation.empty()) run.result.validation = run.latest;
      run.worse = 0;
    } else {
      ++run.worse;
      run.ended = options.patience > 0 && run.worse >= options.patience;
    }
  }

  static TrainingProgress progress(Run& run, const TrainingOptions& options, std::size_t done, bool unjudged) {
    double sum = 0.0;
    for (std::size_t i = run.reported_steps; i < done; ++i) sum += run.result.losses[i];
    TrainingProgress now{
        done, run.ended ? done : options.steps, sum / static_cast<double>(done - run.reported_steps), {}, run.worse == 0};
    run.reported_steps = done;
    if (!unjudged) now.validation = run.latest;
    return now;
  }

  void save(const Checkpoint& checkpoint, const torch::optim::Optimizer& optimiser, const Run& run) const {
    torch::serialize::OutputArchive archive, inner;
    archive.write("identity", c10::IValue(checkpoint.identity));
    for (std::size_t i = 0; i < state_.size(); ++i) {
      archive.write("state" + std::to_string(i), state_[i].detach());
      archive.write("best" + std::to_string(i), run.best[i]);
    }
    optimiser.save(inner);
    archive.write("optimiser", inner);
    archive.write("losses", torch::tensor(run.result.losses, torch::kDouble));
    archive.write("figures", torch::tensor({run.result.validation, run.latest}, torch::kDouble));
    archive.write("counts",
                  torch::tensor({extent(run.result.best_step), extent(run.worse), std::int64_t{run.ended}}, torch::kLong));
    std::ostringstream stream;
    archive.save_to(stream);
    const std::string bytes = std::move(stream).str(), partial = checkpoint.path + ".partial";
    if (!write_synced_file(partial.c_str(), O_TRUNC, digest_of(bytes) + bytes) ||
        std::rename(partial.c_str(), checkpoint.path.c_str()) != 0)
      reject("{}: cannot be written: {}", partial, std::strerror(errno));
  }

  void load(const Checkpoint& checkpoint, torch::optim::Optimizer& optimiser, Run& run) {
    const torch::NoGradGuard no_gradient;
    const std::string refused =
        checkpoint.path +
        ": is damaged, or no checkpoint of a training; allowed: what a killed `slipbench train` left, or none of that file and of --resume";
    std::ifstream file(checkpoint.path, std::ios::binary);
    const std::string all{std::istreambuf_iterator<char>(file), {}};
    if (file.bad() || all.size() < digest_size || all.substr(0, digest_size) != digest_of(all.substr(digest_size)))
      throw InputError(refused);
    std::istringstream bytes(all.substr(digest_size));
    torch::serialize::InputArchive archive, inner;
    try {
      archive.load_from(bytes);
      c10::IValue identity;
      archive.read("identity", identity);
      if (identity.toStringRef() != checkpoint.identity) {
        throw InputError(checkpoint.path +
                         ": is of another training (data, recipe or options); allowed: the same command, or none of --resume");
      }
      const auto tensor = [&](const std::string& name) {
        Tensor value;
        archive.read(name, value);
        return value;
      };
      for (std::size_t i = 0; i < state_.size(); ++i) {
        state_[i].copy_(tensor("state" + std::to_string(i)));
        run.best.push_back(tensor("best" + std::to_string(i)));
      }
      archive.read("optimiser", inner);
      optimiser.load(inner);
      const Tensor losses = tensor("losses"), figures = tensor("figures"), counts = tensor("counts");
      run.result.losses.assign(losses.data_ptr<double>(), losses.data_ptr<double>() + losses.numel());
      run.reported_steps = run.result.losses.size();
      run.result.validation = figures[0].item<double>();
      run.latest = figures[1].item<double>();
      run.result.best_step = static_cast<std::size_t>(counts[0].item<std::int64_t>());
      run.worse = static_cast<std::size_t>(counts[1].item<std::int64_t>());
      run.ended = counts[2].item<std::int64_t>() != 0;
    } catch (const c10::Error&) {
      throw InputError(refused);
    }
  }

  NetworkShape shape_;
  std::size_t classes_, history_;
  mutable std::vector<Tensor> state_;  // libtorch has no tensors that cannot be written to
  std::vector<Tensor> learnt_;         // those among them that are no running means
};

// One thread a network: the order of sums is then the same everywhere.
Network* make_torch_network(const NetworkShape& shape, std::uint64_t seed) {
  at::set_num_threads(1);
  return new TorchNetwork(shape, seed);
}

}  // namespace
}  // namespace slipbench::train

extern "C" __attribute__((visibility("default"))) const slipbench::train::TorchLibrary* slipbench_torch_library() {
  static const slipbench::train::TorchLibrary library{slipbench::train::make_torch_network, slipbench::train::write_onnx,
                                                      "libtorch " TORCH_VERSION ", onnx " SLIPBENCH_ONNX_VERSION};
  return &library;
}
