#include <algorithm>
#include <array>
#include <vector>

#include "sim/api/pad_layout.h"
#include "sim/contact/dashpot.h"

namespace slipbench {
namespace {

class Dashpots final : public RheologyEffect {
 public:
  explicit Dashpots(const PadLayout& layout) : elements_(layout.elements), before_(deflections * layout.elements.size()) {}

  void prepare(const ElementColumns& columns, const AffineForce& force) override {
    if (columns.dt <= 0.0) return;
    for (std::size_t i = 0; i < columns.count; ++i) {
      const double normal_rate = elements_[i].c_normal / columns.dt;
      const double tangential_rate = elements_[i].c_tangential / columns.dt;
      force.k_normal[i] += normal_rate;
      force.h_normal[i] -= normal_rate * before_[deflections * i];
      force.k_tangential[i] += tangential_rate;
      force.h_x[i] -= tangential_rate * before_[deflections * i + 1];
      force.h_y[i] -= tangential_rate * before_[deflections * i + 2];
      force.h_z[i] -= tangential_rate * before_[deflections * i + 3];
    }
  }

  void commit(const ElementColumns& columns, const double* ux, const double* uy, const double* uz) override {
    for (std::size_t i = 0; i < columns.count; ++i) {
      const std::array<double, deflections> now{columns.penetration[i], ux[i], uy[i], uz[i]};
      std::copy(now.begin(), now.end(), before_.begin() + static_cast<std::ptrdiff_t>(deflections * i));
    }
  }

  [[nodiscard]] std::span<double> memory() override { return before_; }
  void pass_on(std::size_t i, Effect& next, const Eigen::Matrix3d& turn) override {
    double *const from = before_.data() + deflections * i, *const to =
                                                               static_cast<Dashpots&>(next).before_.data() + deflections * i;
    to[0] = from[0];
    Eigen::Map<Eigen::Vector3d>(to + 1) = turn * Eigen::Map<const Eigen::Vector3d>(from + 1);
    std::fill_n(from, deflections, 0.0);
  }

 private:
  static constexpr std::size_t deflections = 4;

  std::vector<Element> elements_;
  std::vector<double> before_;  // [elements][4] penetration and stretch at the end of the last step
};

}  // namespace

std::unique_ptr<RheologyEffect> make_dashpots(const PadLayout& layout) {
  const bool any = std::any_of(layout.elements.begin(), layout.elements.end(),
                               [](const Element& e) { return e.c_normal > 0.0 || e.c_tangential > 0.0; });
  return any ? std::make_unique<Dashpots>(layout) : nullptr;
}

}  // namespace slipbench
