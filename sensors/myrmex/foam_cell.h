// Reading of a cell of piezoresistive foam between two electrodes.
#pragma once

namespace slipbench::myrmex {

// Unloaded reading of a 12-bit converter; the reading falls with the force.
inline constexpr double full_scale = 4095.0;  // counts

// The foam's memory is rate-independent: generalised plays ([visintin1994], ch. III), summed as by
// Prandtl and Ishlinskii. A play follows the force F from below as (1 - w) F and from above as
// (1 + w) F, and is constant in between:
//   p <- min(max(p, (1 - w) F), (1 + w) F)
// The cell feels f = (F + p_1 + p_2)/3 with w_1 = h, w_2 = 2 h. So it feels (1 - h) F while the
// force grows from zero, and (1 + h) F once the force has fallen by more than 4 h/(1 + 2 h) of its
// maximum M. Loops close at both ends, and unloading resets the cell. Below the last reversal the
// loop is widest where p_2 begins to follow, F = M (1 - 2h)/(1 + 2h); its width there is 2 h F.
//
// The cell's resistance is R = 2 Rs/f + R0, and the divider with its reference resistance reads
//   full_scale (1 - reference/R),  not below 0
struct FoamCell {
  double hysteresis;  // h
  double softness;    // 2 Rs/reference [N]
  double contact;     // R0/reference

  // `Real`: double, or a vector of them.

  // Returns the force that the cell feels [N] under F >= 0 [N]; updates p_1 and p_2.
  template <class Real>
  [[nodiscard, gnu::always_inline]] inline Real felt(const Real& force, Real& p_1, Real& p_2) const {
    p_1 = between(p_1, (1.0 - hysteresis) * force, (1.0 + hysteresis) * force);
    p_2 = between(p_2, (1.0 - 2.0 * hysteresis) * force, (1.0 + 2.0 * hysteresis) * force);
    return (force + p_1 + p_2) * (1.0 / 3.0);
  }
  // Counts under a felt force [N].
  template <class Real>
  [[nodiscard, gnu::always_inline]] inline Real reading(const Real& force) const {
    const Real counts = full_scale - full_scale * force / (softness + contact * force), none{};
    return counts > 0.0 ? counts : none;
  }

 private:
  template <class Real>
  [[gnu::always_inline]] static inline Real between(const Real& x, const Real& lowest, const Real& highest) {
    const Real raised = x < lowest ? lowest : x;
    return highest < raised ? highest : raised;
  }
};

}  // namespace slipbench::myrmex
