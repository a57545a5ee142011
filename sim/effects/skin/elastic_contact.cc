#include "sim/effects/skin/elastic_contact.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "sim/core/error.h"

namespace slipbench {
namespace {

// Ten times the iterations of the worst first step seen.
constexpr int most_iterations = 2000;

// Returns the residual at which a solver stops; `allowed`: the tolerance, `off`: the residual at
// the start of the step. A step smaller than the tolerance must be solved too, to a part of `off`.
// Otherwise a body would feel no change until it has moved by the tolerance, and the late push
// would shake it.
double near_enough(double allowed, double off) {
  constexpr double left = 0.03, nothing = 1e-4;
  return std::max(nothing * allowed, std::min(allowed, left * off));
}

[[noreturn]] void fail(const std::string& what) {
  throw SceneValueError("effects", "elastic_skin: " + what + " did not converge within " + std::to_string(most_iterations) +
                                       " iterations; raise its tolerance");
}

}  // namespace

ElasticContact::ElasticContact(std::unique_ptr<Influence> influence, std::size_t elements, double tolerance)
    : influence_(std::move(influence)), n_(elements), tolerance_(tolerance), memory_(12 * elements + 2) {
  const auto n = static_cast<Eigen::Index>(elements);
  for (Eigen::ArrayXd* a : {&residual_, &direction_, &moved_, &slides_}) a->setZero(n);
  for (Eigen::ArrayX2d* a : {&guess_, &at_guess_, &next_, &at_next_, &change_}) a->setZero(n, 2);
}

// Computes the displacements `way` under `force`. Only the difference from friction() goes through
// the compliance: the rounding error is then that of shift() alone, and a gain has none that the
// guesses of many steps could accumulate.
void ElasticContact::apply(const Eigen::ArrayX2d& force, Eigen::ArrayX2d& way) {
  change_ = force - friction();
  influence_->shear(change_.col(0).data(), change_.col(1).data(), way.col(0).data(), way.col(1).data());
  way += shift();
}

// Sets pressure() to `next` and updates sunk().
void ElasticContact::take_pressure(const Eigen::Ref<const Eigen::ArrayXd>& next) {
  Values p = pressure();
  change_.col(0) = next - p;
  influence_->press(change_.col(0).data(), moved_.data());
  p = next;
  sunk() += moved_;
}

// First guess: the forces of the last step, extrapolated along that step's increment to the least
// energy on that line. Leaves minus the start values in the gains, to which press() adds the
// solution.
void ElasticContact::guess_pressure(const Eigen::Ref<const Eigen::ArrayXd>& gap) {
  Values p = pressure(), w = sunk(), gain = pressure_gain(), way = sunk_gain();
  const double curved = (gain * way).sum();
  const double again = curved > 0.0 ? std::clamp(-(gain * (gap + w)).sum() / curved, 0.0, 2.0) : 0.0;
  residual_ = p + again * gain;
  gain = -p;
  direction_ = again * way;
  way = -w;
  if ((residual_ < 0.0).any()) {
    take_pressure(residual_.max(0.0));
  } else {
    p = residual_;
    w += direction_;
  }
}

void ElasticContact::press(const Eigen::Ref<const Eigen::ArrayXd>& gap) {
  Values p = pressure(), w = sunk();
  const double depth = std::max(0.0, -gap.minCoeff());
  if (depth == 0.0) {
    for (const std::size_t k : {0U, 1U, 10U, 11U}) column(k).setZero();
    return;
  }
  const auto lack = [&] {
    residual_ = gap + w;
    return (p > 0.0).select(residual_.abs(), (-residual_).max(0.0)).maxCoeff();
  };
  const double off = lack(), enough = near_enough(tolerance_ * depth, off);
  if (off <= enough) return;
  guess_pressure(gap);
  const double own = 1.0 / influence_->own_normal();
  double before = 0.0;  // squared residual of the last iteration; 0: start along the gradient
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (lack() <= enough) {
      pressure_gain() += p;
      sunk_gain() += w;
      return;
    }
    const double now = (p > 0.0).select(residual_.square(), 0.0).sum();
    direction_ = (p > 0.0).select(residual_ + (before > 0.0 ? now / before : 0.0) * direction_, 0.0);
    double length = own;
    if (now > 0.0) {
      influence_->press(direction_.data(), moved_.data());
      length = (residual_ * direction_).sum() / (moved_ * direction_).sum();
    }
    const bool joins = (p == 0.0 && residual_ < 0.0).any();
    const bool leaves = (p > 0.0 && p <= length * direction_).any();
    if (joins || leaves) {
      constexpr double shy = 0.1;  // joining elements are also sunk by their neighbours' load
      take_pressure((p > 0.0).select((p - length * direction_).max(0.0), -shy * own * residual_.min(0.0)));
      before = 0.0;
    } else {
      p -= length * direction_;
      w -= length * moved_;
      before = now;
    }
  }
  fail("the pressure");
}

// Projects onto the discs |q| <= L.
void ElasticContact::project(Eigen::ArrayX2d& force, const Eigen::Ref<const Eigen::ArrayXd>& limit) {
  residual_ = (force.col(0).square() + force.col(1).square()).sqrt();
  residual_ = (residual_ > limit).select(limit / residual_, 1.0);
  force.col(0) *= residual_;
  force.col(1) *= residual_;
}

// The curvature of q'C q is at most C's greatest row sum, which a uniform load along the diagonal
// gives to a few per cent. It changes little with the contact, and shear() notices a step that is
// too long.
void ElasticContact::find_curvature(const Eigen::Ref<const Eigen::ArrayXd>& limit) {
  constexpr double alike = 0.1;
  const double count = (limit > 0.0).cast<double>().sum();
  if (std::abs(count - counted()) <= alike * counted()) return;
  counted() = count;
  next_.col(0) = next_.col(1) = (limit > 0.0).cast<double>();
  influence_->shear(next_.col(0).data(), next_.col(1).data(), at_next_.col(0).data(), at_next_.col(1).data());
  curvature() = std::max(influence_->own_tangential(), at_next_.maxCoeff());
}

// First guess: the forces of the last step, extrapolated along that step's increment to the least
// energy on that line.
void ElasticContact::guess(const Eigen::ArrayX2d& target, const Eigen::Ref<const Eigen::ArrayXd>& limit) {
  const double curved = (gain() * gain_way()).sum();
  const double again = curved > 0.0 ? std::clamp((gain() * (target - shift())).sum() / curved, 0.0, 2.0) : 0.0;
  next_ = guess_ = friction() + again * gain();
  project(guess_, limit);
  if ((guess_ == next_).all()) {
    at_guess_ = shift() + again * gain_way();
  } else {
    apply(guess_, at_guess_);
  }
}

void ElasticContact::shear(const Eigen::ArrayX2d& target, const Eigen::Ref<const Eigen::ArrayXd>& limit) {
  Pairs q = friction(), u = shift();
  const double greatest = limit.maxCoeff();
  if (greatest == 0.0) {
    slides_.setZero();
    for (const std::size_t k : {2U, 4U, 6U, 8U}) pair(k).setZero();
    return;
  }
  find_curvature(limit);
  next_ = q - (u - target) / curvature();
  project(next_, limit);
  const double off = (next_ - q).abs().maxCoeff();
  guess(target, limit);
  gain() = -q;
  gain_way() = -u;
  q = guess_;
  u = at_guess_;
  double step = 1.0 / curvature(), momentum = 1.0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    next_ = guess_ - step * (at_guess_ - target);
    project(next_, limit);
    constexpr double nothing = 1e-9;  // share of the friction limit; below it: rounding, not a load
    const double size = std::max(next_.abs().maxCoeff(), nothing * greatest);
    if ((next_ - guess_).abs().maxCoeff() <= near_enough(tolerance_ * size, off)) {
      // Slipping elements must lie exactly on their discs, which the last iterate, slightly off the
      // solution, may not satisfy.
      const auto mark = [&](const auto& force, Eigen::ArrayXd& on_disc) {
        constexpr double rounding = 1e-12;
        on_disc = (force.square().rowwise().sum() >= (1.0 - rounding) * limit.square() && limit > 0.0).template cast<double>();
      };
      mark(next_, slides_);
      mark(q, residual_);
      if ((slides_ != residual_).any()) {
        apply(next_, at_next_);
        q = next_;
        u = at_next_;
      }
      gain() += q;
      gain_way() += u;
      return;
    }
    apply(next_, at_next_);
    const double curved = ((next_ - guess_) * (at_next_ - at_guess_)).sum(), flat = (next_ - guess_).square().sum();
    if (curved * step > flat) {  // step too long: shorten it, from the best point so far
      step *= 0.5;
      momentum = 1.0;
      guess_ = q;
      at_guess_ = u;
      continue;
    }
    if (((guess_ - next_) * (next_ - q)).sum() > 0.0) momentum = 1.0;  // uphill
    const double faster = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * momentum * momentum)), carry = (momentum - 1.0) / faster;
    momentum = faster;
    guess_ = next_ + carry * (next_ - q);
    at_guess_ = at_next_ + carry * (at_next_ - u);
    q = next_;
    u = at_next_;
  }
  fail("the friction");
}

}  // namespace slipbench
