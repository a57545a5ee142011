#include "detectors/network/frames.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "detectors/channel.h"
#include "detectors/spectral/spectral_features.h"
#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/quantity.h"

namespace slipbench::network {
namespace {

constexpr std::size_t most_kept = 50'000'000;  // values that a window, a median or the features of a frame may hold

// NaN sorts last, so that every sample has a place.
bool before(float a, float b) { return std::isnan(b) ? !std::isnan(a) : a < b; }

// Returns the index into a sample of each value that `input` picks, in order.
std::vector<std::size_t> picked(const Input& input, std::span<const Channel> channels) {
  std::vector<std::size_t> places;
  for (std::size_t p = 0; p < input.channels.size(); ++p) {
    const ChannelPick& pick = input.channels[p];
    const auto found = std::ranges::find(channels, pick.name, &Channel::name);
    if (found == channels.end()) {
      std::vector<std::string> names;
      for (const Channel& channel : channels) names.push_back(channel.name);
      const bool forces = std::ranges::find(names, "force") != names.end();
      throw InputError("the network needs the channel " + quote(pick.name) + allowed_names(pick.name, names) +
                       (forces ? "; the detector force_ratio reads forces, and deviation reads any channel"
                               : "; the detector deviation reads any channel"));
    }
    const std::string unit = unit_of_pick(pick, found->usual_unit);
    if (!unit.empty() && !found->unit.empty() && found->unit != unit) {
      throw InputError("the network reads the channel " + quote(pick.name) + " in " + quote(unit) +
                       ", but the sensor has it in " + quote(found->unit) + other_unit_remedy(found->unit, unit));
    }
    std::size_t first = 0;
    for (auto channel = channels.begin(); channel != found; ++channel) first += channel->size();
    const std::size_t size = found->size();
    if (pick.values.empty()) {
      for (std::size_t value = 0; value < size; ++value) places.push_back(first + value);
    }
    for (const std::size_t value : pick.values) {
      if (value >= size) {
        throw InputError("the network needs value " + std::to_string(value) + " of the channel " + quote(pick.name) +
                         ", which has " +
                         (size == 0 ? "no values" : std::to_string(size) + "; allowed: 0 to " + std::to_string(size - 1)));
      }
      places.push_back(first + value);
    }
  }
  if (places.empty()) throw InputError("the network must read at least one value of its sensor");
  return places;
}

// Returns one value for each feature.
std::vector<float> spread(const std::vector<double>& given, double otherwise, std::size_t features, const std::string& name) {
  if (given.size() > 1 && given.size() != features) {
    throw InputError("the network has " + counted(given.size(), "value") + " of " + name + " for the " +
                     counted(features, "feature") + " of a frame; allowed: none, 1 or " + std::to_string(features));
  }
  std::vector<float> result(features, static_cast<float>(given.empty() ? otherwise : given.front()));
  if (given.size() > 1) std::ranges::transform(given, result.begin(), [](double x) { return static_cast<float>(x); });
  return result;
}

}  // namespace

bool rate_fits(const Input& input, double rate) {
  constexpr double tolerance = 0.01;
  return std::abs(rate - input.rate) <= tolerance * input.rate;
}

struct Frames::State {  // all members are public, for the functions of the class below
  // Median of the latest `length` values, of fewer at the start.
  class Median {
   public:
    explicit Median(std::size_t length) : ring_(length) { sorted_.reserve(length); }

    float push(float value) {
      float& oldest = ring_[seen_++ % ring_.size()];
      if (sorted_.size() == ring_.size()) sorted_.erase(std::ranges::lower_bound(sorted_, oldest, before));
      oldest = value;
      sorted_.insert(std::ranges::upper_bound(sorted_, value, before), value);
      const std::size_t half = sorted_.size() / 2;
      return sorted_.size() % 2 == 1 ? sorted_[half] : 0.5F * (sorted_[half - 1] + sorted_[half]);
    }

    void reset() {
      sorted_.clear();
      seen_ = 0;
    }

   private:
    std::vector<float> ring_;
    std::vector<float> sorted_;
    std::size_t seen_ = 0;
  };

  State(const Input& about, std::span<const Channel> channels)
      : input(about),
        places(picked(about, channels)),
        bins(bins_within(about.rate, about.window, about.low, about.high)),
        rows(about.window) {
    const std::size_t values = places.size();
    const std::size_t features = frame_size(input, values);
    if (input.transform == Transform::units && values % 3 != 0) {
      throw InputError("the network reads " + counted(values, "value") + " in units of three; expected x, y, z of each unit");
    }
    if (features == 0) throw InputError("the network's frame is empty; it needs at least one feature");
    for (const std::size_t span : input.spans) rows = std::max(rows, span);
    if (std::max(rows, input.median) > most_kept / values || features > most_kept) {
      throw InputError("the network's frame needs more than " + std::to_string(most_kept) + " values, the most that is allowed");
    }
    for (const auto& pixel : input.pixels) {
      for (const std::size_t value : pixel) {
        if (value < values) continue;
        throw InputError("a pixel of the network shows value " + std::to_string(value) + ", of " + counted(values, "value") +
                         "; allowed: 0 to " + std::to_string(values - 1));
      }
    }
    offset = spread(input.offset, 0.0, features, "offset");
    scale = spread(input.scale, 1.0, features, "scale");
    // Added one by one because copies would lose the reserved capacity.
    medians.reserve(values);
    for (std::size_t v = 0; input.median > 1 && v < values; ++v) medians.emplace_back(input.median);
    window.resize(rows * values);
    means.resize(values);
    frame.resize(features);
    if (!input.spans.empty()) return;
    if (input.transform == Transform::samples) {
      if (!input.pixels.empty()) before_pixels.resize(input.window * values);
      return;
    }
    if (!input.pixels.empty()) before_pixels.resize(values * bins.count);
    fft.emplace(input.window);
    taper = input.hann ? hann_taper(input.window) : std::vector<double>(input.window, 1.0);
    double power = 0.0;
    for (const double w : taper) power += w * w;
    density = 1.0 / (input.rate * power);
  }

  // Returns sample n of the window, the oldest first.
  [[nodiscard]] double sample(std::size_t n, std::size_t value) const {
    const std::size_t row = next + n < input.window ? next + n : next + n - input.window;
    return double{window[row * places.size() + value]} - means[value];
  }

  void take(std::span<const float> values) {
    float* const row = &window[next * places.size()];
    for (std::size_t v = 0; v < places.size(); ++v) {
      const float x = values[places[v]];
      row[v] = medians.empty() ? x : medians[v].push(x);
    }
    ++seen;
    if (++next == rows) next = 0;
  }

  // Returns sample n of the latest `count`, the oldest first.
  [[nodiscard]] double recent(std::size_t n, std::size_t count, std::size_t value) const {
    const std::size_t row = next + rows - count + n;
    return double{window[(row < rows ? row : row - rows) * places.size() + value]};
  }

  struct Trend {
    double mean = 0.0, sd = 0.0, change = 0.0;  // change: n times the slope of the least-squares line
  };
  // Over the latest `span` samples, or as many as there are.
  [[nodiscard]] Trend trend(std::size_t span, std::size_t value) const {
    const std::size_t count = std::min(span, seen);
    const double n = static_cast<double>(count), middle = 0.5 * (n - 1.0);
    Trend one;
    for (std::size_t i = 0; i < count; ++i) one.mean += recent(i, count, value) / n;
    double square = 0.0, moment = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double x = recent(i, count, value) - one.mean;
      square += x * x;
      moment += (static_cast<double>(i) - middle) * x;
    }
    one.sd = std::sqrt(square / n);
    one.change = 12.0 * moment / (n * n - 1.0);  // sum of the squared deviations of 0 to n - 1 from their mean: n (n^2 - 1)/12
    return one;
  }

  void units(std::span<float> out) const {
    std::size_t at = 0;
    const auto put = [&](double feature) { out[at++] = static_cast<float>(feature); };
    for (std::size_t v = 0; v < places.size(); v += 3) {
      const double x = trend(input.spans[0], v).mean, y = trend(input.spans[0], v + 1).mean,
                   z = trend(input.spans[0], v + 2).mean, shear = math::hypot(x, y);
      put(math::asinh(z / input.floor));
      put(shear / (std::abs(z) + input.floor));
      for (const std::size_t span : input.spans) {
        const double dx = trend(span, v).change, dy = trend(span, v + 1).change;
        put(math::asinh(math::hypot(dx, dy) / input.floor));
        put(shear > 0.0 ? math::asinh((dx * x + dy * y) / (shear * input.floor)) : 0.0);
        put(math::asinh(trend(span, v + 2).change / input.floor));
      }
    }
  }

  void spreads(std::span<float> out) const {
    const std::size_t values = places.size();
    const std::span<float> by_value = out.last(2 * values);
    for (std::size_t k = 0; k < input.spans.size(); ++k) {
      const std::span<float> rising = out.subspan(k * values, values);
      for (std::size_t v = 0; v < values; ++v) {
        const Trend one = trend(input.spans[k], v);
        by_value[v] = rising[v] = static_cast<float>(math::log(one.sd + input.floor));
        by_value[values + v] = static_cast<float>(math::asinh(one.change / input.floor));
      }
      std::ranges::sort(rising, before);
    }
  }

  void levels(std::span<float> out) const {
    const std::size_t values = places.size();
    for (std::size_t v = 0; v < values; ++v) {
      out[v] = static_cast<float>(math::asinh(trend(input.window, v).mean / input.floor));
      for (std::size_t k = 0; k < input.spans.size(); ++k)
        out[(k + 1) * values + v] = static_cast<float>(math::asinh(trend(input.spans[k], v).change / input.floor));
    }
  }

  void centre() {
    for (std::size_t v = 0; v < places.size(); ++v) {
      means[v] = 0.0;
      double sum = 0.0;
      for (std::size_t n = 0; n < input.window; ++n) sum += sample(n, v);
      means[v] = sum / static_cast<double>(input.window);
    }
  }

  // Writes the frame before pixels are applied: [window, values] or [values, bins].
  void transform(std::span<float> out) {
    if (input.transform == Transform::spreads) return spreads(out);
    if (input.transform == Transform::levels) return levels(out);
    if (input.transform == Transform::units) return units(out);
    const std::size_t values = places.size();
    if (input.transform == Transform::samples) {
      for (std::size_t n = 0; n < input.window; ++n) {
        for (std::size_t v = 0; v < values; ++v) out[n * values + v] = static_cast<float>(sample(n, v));
      }
      return;
    }
    for (std::size_t v = 0; v < values; ++v) {
      const std::span<double> signal = fft->input();
      for (std::size_t n = 0; n < input.window; ++n) signal[n] = taper[n] * sample(n, v);
      const std::span<const std::complex<double>> spectrum = fft->transform();
      for (std::size_t b = 0; b < bins.count; ++b)
        out[v * bins.count + b] = static_cast<float>(feature(spectrum, bins.first + b));
    }
  }

  [[nodiscard]] double feature(std::span<const std::complex<double>> spectrum, std::size_t bin) const {
    if (input.transform == Transform::amplitude) return std::sqrt(std::norm(spectrum[bin]));
    const double sides = bin == 0 || 2 * bin == input.window ? 1.0 : 2.0;
    return math::log10(sides * std::norm(spectrum[bin]) * density + input.floor);
  }

  void pixels(std::span<const float> from) {
    const bool samples = input.transform == Transform::samples;
    const std::size_t count = samples ? input.window : bins.count;  // images
    const std::size_t values = places.size();
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t p = 0; p < input.pixels.size(); ++p) {
        double sum = 0.0;
        for (const std::size_t v : input.pixels[p]) sum += double{from[samples ? i * values + v : v * count + i]};
        const double mean = input.pixels[p].empty() ? 0.0 : sum / static_cast<double>(input.pixels[p].size());
        frame[samples ? i * input.pixels.size() + p : p * count + i] = static_cast<float>(mean);
      }
    }
  }

  Input input;
  std::vector<std::size_t> places;
  BinRange bins;                // of spectra alone
  std::vector<Median> medians;  // [values]; empty: no median
  std::size_t rows;             // of the ring: the window, or the longest span
  std::vector<float> window;    // [rows, values], a ring
  std::vector<double> means;    // [values], 0 if not centred
  std::optional<RealFft> fft;   // of spectra alone
  std::vector<double> taper;    // [window]
  double density = 0.0;         // factor from |X|^2 to a one-sided density
  std::vector<float> before_pixels;
  std::vector<float> offset, scale;  // [features]
  std::vector<float> frame;          // [features]
  std::size_t seen = 0;              // samples
  std::size_t next = 0;              // row of the window
};

void check_channels(const Input& input, const std::string& type, std::span<const Channel> channels) {
  if (type != input.sensor) {
    throw InputError("the network reads a " + quote(input.sensor) + " according to its metadata, but this sensor is a " +
                     quote(type));
  }
  picked(input, channels);
}

Frames::Frames(const Input& input, const std::string& type, double rate, std::span<const Channel> channels) {
  check_channels(input, type, channels);
  if (!rate_fits(input, rate)) {
    throw InputError("the network was trained for " + format_quantity(input.rate, Quantity::frequency) + ", but the sensor has " +
                     format_quantity(rate, Quantity::frequency) + "; the rates must agree within 1 %");
  }
  state_ = std::make_unique<State>(input, channels);
}
Frames::~Frames() = default;
Frames::Frames(Frames&&) noexcept = default;
Frames& Frames::operator=(Frames&&) noexcept = default;

bool Frames::push(std::span<const float> sample) {
  State& s = *state_;
  s.take(sample);
  if (s.seen < s.input.window || (s.seen - s.input.window) % s.input.stride != 0) return false;
  if (s.input.centre) s.centre();
  if (s.input.pixels.empty()) {
    s.transform(s.frame);
  } else {
    s.transform(s.before_pixels);
    s.pixels(s.before_pixels);
  }
  for (std::size_t i = 0; i < s.frame.size(); ++i) s.frame[i] = (s.frame[i] - s.offset[i]) * s.scale[i];
  return true;
}

std::span<const float> Frames::latest() const { return state_->frame; }

std::size_t Frames::size() const { return state_->frame.size(); }

void Frames::reset() {
  State& s = *state_;
  for (State::Median& median : s.medians) median.reset();
  std::ranges::fill(s.means, 0.0);
  std::ranges::fill(s.frame, 0.0F);
  s.seen = 0;
  s.next = 0;
}

}  // namespace slipbench::network
