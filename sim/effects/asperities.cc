#include <algorithm>
#include <array>

#include "sim/contact/vectorise.h"
#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/stick_slip.h"

namespace slipbench {
namespace {

using kernel::Lanes;

constexpr double second_mode = 2.1;  // its frequency relative to the first mode's

// A ringing mode of all elements. Its force along either axis is A exp(-s t) sin(w t), the
// imaginary part of a decaying phasor.
struct Mode {
  const double *turn_re, *turn_im;  // phasor's rotation and decay over the step
  double *x_re, *x_im, *y_re, *y_im;
};

// Advances the mode by a step and adds its force.
SLIPBENCH_DISPATCHED void turn(const Mode& mode, const TipColumns& tips) {
  for (std::size_t i = 0; i < tips.padded; i += kernel::lanes) {
    const Lanes c = kernel::lanes_at(mode.turn_re + i), s = kernel::lanes_at(mode.turn_im + i);
    const Lanes x_re = kernel::lanes_at(mode.x_re + i), x_im = kernel::lanes_at(mode.x_im + i);
    const Lanes y_re = kernel::lanes_at(mode.y_re + i), y_im = kernel::lanes_at(mode.y_im + i);
    const Lanes force_x = c * x_im + s * x_re, force_y = c * y_im + s * y_re;
    kernel::put_lanes(mode.x_re + i, c * x_re - s * x_im);
    kernel::put_lanes(mode.y_re + i, c * y_re - s * y_im);
    kernel::put_lanes(mode.x_im + i, force_x);
    kernel::put_lanes(mode.y_im + i, force_y);
    kernel::put_lanes(tips.transmitted_x + i, kernel::lanes_at(tips.transmitted_x + i) + force_x);
    kernel::put_lanes(tips.transmitted_y + i, kernel::lanes_at(tips.transmitted_y + i) + force_y);
  }
}

class Asperities final : public RingingEffect {
 public:
  Asperities(const Parameters& p, const EffectContext& context, const TipEffect& tip)
      : amplitude_(p.number("amplitude")),
        scatter_(p.number("scatter")),
        load_(p.number("load")),
        speed_(p.number("speed")),
        second_(p.number("second")),
        share_(context.share),
        stream_(context.stream("asperities")),
        count_(context.elements),
        padded_((count_ + kernel::lanes - 1) / kernel::lanes * kernel::lanes),
        turns_(4 * padded_),
        memory_(columns * padded_) {
    for (std::size_t i = 0; i < count_; ++i) {
      distance_.push_back(p.number("distance") / share_[i]);
      for (const double ratio : {1.0, second_mode})
        oscillators_.push_back({ratio * tip.natural_frequency(i), tip.damping_ratio()});
    }
  }

  void ring(const TipColumns& tips) override {
    if (tips.dt == 0.0) return;
    set_step(tips.dt);
    for (const std::size_t mode : {0U, 1U}) turn(mode_at(mode), tips);
    for (std::size_t i = 0; i < count_; ++i) {
      while (tips.path[i] >= column(next)[i]) meet(tips, i);
    }
  }

  [[nodiscard]] std::span<double> memory() override { return memory_; }

 private:
  // Columns of the memory: two modes, then the position on its path of an element's next asperity
  // [m], and the number drawn for it.
  enum Column : std::size_t { modes, next = modes + 8, drawn, columns };

  [[nodiscard]] double* column(std::size_t c) { return memory_.data() + c * padded_; }
  [[nodiscard]] Mode mode_at(std::size_t mode) {
    const auto mode_column = [&](std::size_t c) { return column(modes + 4 * mode + c); };
    return {turns_.data() + 2 * mode * padded_,
            turns_.data() + (2 * mode + 1) * padded_,
            mode_column(0),
            mode_column(1),
            mode_column(2),
            mode_column(3)};
  }

  // exp((-s + i w) time)
  [[nodiscard]] static std::array<double, 2> turned(const Oscillator& oscillator, double time) {
    const double fade = math::exp(-oscillator.zeta * oscillator.omega * time);
    const double angle = oscillator.omega * std::sqrt(1.0 - oscillator.zeta * oscillator.zeta) * time;
    const auto [sine, cosine] = math::sincos(angle);
    return {fade * cosine, fade * sine};
  }

  void set_step(double dt) {
    if (dt == step_) return;
    step_ = dt;
    for (std::size_t i = 0; i < count_; ++i) {
      for (const std::size_t mode : {0U, 1U}) {
        const auto [re, im] = turned(oscillators_[2 * i + mode], dt);
        turns_[2 * mode * padded_ + i] = re;
        turns_[(2 * mode + 1) * padded_ + i] = im;
      }
    }
  }

  // Element i has reached its next asperity within the step; draws the one after it. The random
  // numbers of each asperity have a fixed position in the stream: they depend only on how many
  // asperities the element has met.
  void meet(const TipColumns& tips, std::size_t i) {
    constexpr std::uint64_t most = std::uint64_t{1} << 40;  // asperities per element
    double &place = column(next)[i], &number = column(drawn)[i];
    stream_.seek(2 * (most * i + static_cast<std::uint64_t>(number)));
    const double way = -distance_[i] * math::log1p(-stream_.uniform()), sign = stream_.uniform() < 0.5 ? -1.0 : 1.0;
    const double spread = stream_.normal();
    if (number > 0.0) {  // number 0 is not an asperity: it is the start of the path
      const double slip = std::sqrt(tips.slip_x[i] * tips.slip_x[i] + tips.slip_y[i] * tips.slip_y[i]);
      const double since = slip > 0.0 ? std::min(1.0, (tips.path[i] - place) / slip) * tips.dt : 0.0;
      const double hardness = std::sqrt(std::max(0.0, tips.f_normal[i]) / (share_[i] * load_) * slip / (tips.dt * speed_));
      const double push = slip > 0.0 ? sign * amplitude_ * hardness * math::exp(scatter_ * spread) / slip : 0.0;
      for (const std::size_t mode : {0U, 1U}) {
        const auto [re, im] = turned(oscillators_[2 * i + mode], since);
        const double force = mode == 0 ? push : second_ * push;
        const Mode rings = mode_at(mode);
        rings.x_re[i] += re * force * tips.slip_x[i];
        rings.x_im[i] += im * force * tips.slip_x[i];
        rings.y_re[i] += re * force * tips.slip_y[i];
        rings.y_im[i] += im * force * tips.slip_y[i];
        tips.transmitted_x[i] += im * force * tips.slip_x[i];
        tips.transmitted_y[i] += im * force * tips.slip_y[i];
      }
    }
    place += way;
    number += 1.0;
  }

  double amplitude_, scatter_, load_, speed_, second_;
  std::vector<double> share_, distance_;  // 1, m
  std::vector<Oscillator> oscillators_;   // [elements][2]
  RandomStream stream_;
  std::size_t count_, padded_;
  double step_ = 0.0;           // s, step for which turns_ holds
  std::vector<double> turns_;   // [2 modes][re, im][padded]
  std::vector<double> memory_;  // [columns][padded]
};

}  // namespace

EffectKind asperities() {
  return {
      {"asperities",
       "A slipping element hits single asperities, which make its body ring.",
       "The asperities are a Poisson process along the path that a tip has slipped: one every `distance` for a unit, shared equally by its elements.\n"
       "Each asperity adds A exp(-zeta w t) (sin(w1 t) + second sin(w2 t)) to the force felt along the slip, w1 and w2 = 2.1 w1 those of inertia.\n"
       "A = +-amplitude sqrt(f_n/load) sqrt(v/speed) exp(scatter g), g normal; f_n: load of the element over its share, v: speed of the tip. The tip's friction is not changed.",
       "assumed: band of slip noise that does not move with speed, as published for a piezoelectric fingertip (50 to 450 Hz)",
       {number_spec("distance", Quantity::length, "0.2 mm", positive, "Mean distance between two asperities that a unit hits.",
                    "assumed: 3 to 8 in a millimetre"),
        number_spec("amplitude", Quantity::force, "4 mN", non_negative, "Median force at `load` and `speed`.", "assumed"),
        number_spec("scatter", Quantity::none, "0.7", {0.0, 2.0}, "Standard deviation of ln A.", "assumed"),
        number_spec("load", Quantity::force, "5 N", positive, "Load of the unit at which the median of A is `amplitude`.",
                    "assumed"),
        number_spec("speed", Quantity::speed, "10 mm/s", positive, "Speed at which the median of A is `amplitude`.", "assumed"),
        number_spec("second", Quantity::none, "1", non_negative, "Amplitude of the second mode over that of the first.",
                    "assumed: a short blow excites both modes alike")}},
      {Change::tip_force, Change::stick_force},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        if (!effects.tip) throw SceneValueError("effects", "asperities needs the effect inertia");
        if (effects.tip->damping_ratio() >= 1.0) {
          throw SceneValueError("effects", "asperities needs tips that ring: the damping of inertia must be below 1");
        }
        effects.ringing.push_back(std::make_unique<Asperities>(p, context, *effects.tip));
      },
      true};
}

}  // namespace slipbench
