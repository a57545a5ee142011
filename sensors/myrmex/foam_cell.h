// What a cell of piezoresistive foam between two electrodes reads.
#pragma once

namespace slipbench::myrmex {

// Rest of a converter of 12 bits: the reading falls with the force.
inline constexpr double full_scale = 4095.0;  // counts

// The foam's memory is rate-independent: generalised plays (Visintin, Differential Models of Hysteresis, 1994, ch. III), summed as by Prandtl and
// Ishlinskii. A play follows the force F from below as (1 - w) F and from above as (1 + w) F, and stands in between:
//   p <- min(max(p, (1 - w) F), (1 + w) F)
// The cell feels f = (F + p_1 + p_2)/3 with w_1 = h, w_2 = 2 h. So it feels (1 - h) F while the force grows from nothing, and (1 + h) F once it has
// fallen by more than 4 h/(1 + 2 h) of its greatest value M; loops close at both ends, and an unloaded cell is as it was. Below the last turn the
// loop is widest where p_2 begins to follow, F = M (1 - 2h)/(1 + 2h), and there 2 h F wide.
//
// Its resistance is R = 2 Rs/f + R0, and the divider with its reference resistance reads
//   full_scale (1 - reference/R),  not below 0
struct FoamCell {
  double hysteresis;  // h
  double softness;    // 2 Rs/reference [N]
  double contact;     // R0/reference

  // `Real`: double, or several at once.

  // The force that the cell feels [N] under F >= 0 [N]; p_1 and p_2 are moved to F.
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
