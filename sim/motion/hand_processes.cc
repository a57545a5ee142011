#include "sim/motion/hand_processes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/core/math.h"

namespace slipbench {
namespace {

constexpr double limit = HandProcesses::limit;

// Returns 1 - e^-y (1 + y + y^2/2), without cancellation where y is small.
double beyond_second(double y) {
  if (y > 1.0) return 1.0 - math::exp(-y) * (1.0 + y + 0.5 * y * y);
  double term = y * y * y / 6.0, sum = term;
  for (int k = 4; k < 20; ++k) sum += term *= y / k;
  return math::exp(-y) * sum;
}

}  // namespace

void LowPassedNoise::begin(RandomStream& random) {
  x_ = random.normal();
  do u_ = random.normal();
  while (std::abs(u_) > limit);
}

void LowPassedNoise::advance(double s, RandomStream& random) {
  const double d = math::exp(-s), q12 = 2.0 * d * d * s * s;
  const double q11 = beyond_second(2.0 * s), q22 = 1.0 - d * d * (s * s + (1.0 - s) * (1.0 - s));
  const double l11 = std::sqrt(q11), l21 = q12 / l11, l22 = std::sqrt(std::max(0.0, q22 - l21 * l21));
  double x = 0.0, u = 0.0;
  do {
    const double w = random.normal();
    x = d * ((1.0 + s) * x_ + s * u_) + l11 * w;
    u = d * (-s * x_ + (1.0 - s) * u_) + l21 * w + l22 * random.normal();
  } while (std::abs(u) > limit || std::abs(x - x_) > limit * s);
  x_ = x;
  u_ = u;
}

ProcessPoint LowPassedNoise::bounded() const {
  const double over = std::abs(x_) - (limit - 1.0);
  if (over <= 0.0) return {x_, u_};
  const double bent = math::tanh(over);
  return {std::copysign(limit - 1.0 + bent, x_), (1.0 - bent * bent) * u_};
}

HandProcesses::HandProcesses(const Settings& settings, const MotionKey& key, std::string stream)
    : settings_(settings),
      key_(key),
      stream_(std::move(stream)),
      pole_(2.0 * std::numbers::pi * settings.corner),
      chain_(start()) {}

ProcessPoint HandProcesses::at(Which which, double t) const {
  const double s = go_to(t);
  const ProcessPoint p = chain_.before.points[which], q = chain_.after.points[which];
  const double rise = (q.value - p.value) / knot;
  return {p.value + knot * s * (p.rate + s * (3.0 * rise - 2.0 * p.rate - q.rate + s * (p.rate + q.rate - 2.0 * rise))),
          p.rate + s * (6.0 * rise - 4.0 * p.rate - 2.0 * q.rate + 3.0 * s * (p.rate + q.rate - 2.0 * rise))};
}

ProcessPoint HandProcesses::way(double t) const {
  const double s = go_to(t), first = chain_.before.q, q = first + s * (chain_.after.q - first);
  return {chain_.before.way + 0.5 * knot * s * (first + q), q};
}

// Between knots a cubic is at most twice as steep as at the knots and as their chord.
double HandProcesses::top_rate() const {
  return 2.0 * limit * (pole_ * math::exp(settings_.warp * limit) + 1.5 * (1.0 - settings_.rest) / settings_.rise);
}

double HandProcesses::top_way_rate() const { return std::max(0.0, settings_.drive + limit); }

HandProcesses::Chain HandProcesses::start() const {
  Chain chain{RandomStream(key_.seed, key_.trial, stream_), {}, {}, 1, {}, {}};
  chain.time.begin(chain.random);
  for (LowPassedNoise& process : chain.processes) process.begin(chain.random);
  chain.after = read(chain, 0.0);
  step(chain);
  return chain;
}

HandProcesses::Knot HandProcesses::read(const Chain& chain, double t) const {
  Knot made{{}, pole_ * math::exp(settings_.warp * chain.time.bounded().value), 0.0, 0.0};
  const double up = std::clamp((t - settings_.begin) / settings_.rise, 0.0, 1.0), more = 1.0 - settings_.rest;
  const double share = settings_.rest + more * up * up * (3.0 - 2.0 * up), growth = more * 6.0 * up * (1.0 - up) / settings_.rise;
  for (std::size_t i = 0; i < count; ++i) {
    const ProcessPoint point = chain.processes[i].bounded();
    made.points[i] = {share * point.value, share * made.pace * point.rate + growth * point.value};
  }
  made.q = up * std::max(0.0, settings_.drive + chain.processes[drive].bounded().value);
  return made;
}

void HandProcesses::step(Chain& chain) const {
  chain.before = chain.after;
  chain.time.advance(2.0 * std::numbers::pi * settings_.warp_corner * knot, chain.random);
  const double mean = 0.5 * (chain.before.pace + pole_ * math::exp(settings_.warp * chain.time.bounded().value));
  for (LowPassedNoise& process : chain.processes) process.advance(mean * knot, chain.random);
  chain.after = read(chain, static_cast<double>(chain.knots) * knot);
  chain.after.way = chain.before.way + 0.5 * knot * (chain.before.q + chain.after.q);
  ++chain.knots;
}

double HandProcesses::go_to(double t) const {
  const double place = std::max(0.0, t) / knot, floor = std::floor(place);
  const auto before = static_cast<std::size_t>(floor);
  if (before + 2 < chain_.knots) chain_ = start();
  while (chain_.knots < before + 2) step(chain_);
  return place - floor;
}

}  // namespace slipbench
