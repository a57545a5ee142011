#include "sensors/biotac_sp/transduction.h"

#include <cmath>

#include "sim/core/error.h"
#include "sim/core/quantity.h"

namespace slipbench::biotac_sp {

Dents::Dents(const Skin& skin, const Kernel& kernel, const std::string& sensor) {
  const std::vector<Element>& elements = skin.layout.elements;
  const auto n = static_cast<Eigen::Index>(elements.size());
  const Eigen::Map<const Eigen::ArrayXd> area(skin.area.data(), n);
  const auto columns = static_cast<Eigen::Index>(electrodes);
  Eigen::ArrayXXd distance(n, columns);
  for (Eigen::Index e = 0; e < columns; ++e) {
    for (Eigen::Index i = 0; i < n; ++i) {
      distance(i, e) = (elements[static_cast<std::size_t>(i)].tip - skin.above[static_cast<std::size_t>(e)]).norm();
    }
  }
  // Of what an electrode would feel of an element right over it. Below, its sum over the skin is the rounding of exp, and scaled no kernel.
  constexpr double nothing = 1e-12;
  const auto scaled = [&](const Eigen::ArrayXXd& felt, double share, const char* parameter, double reach) {
    const Eigen::ArrayXXd weighted = felt.colwise() * area;
    if (felt.colwise().maxCoeff().minCoeff() < nothing) {
      throw SceneValueError(
          sensor + "." + parameter,
          format_quantity(reach, Quantity::length) +
              " is so short that an electrode feels nothing of the element nearest to it; allowed: lengths not far below the distance of two elements, some " +
              format_quantity(std::round(1e4 * std::sqrt(area.mean())) / 1e4, Quantity::length));
    }
    return Eigen::ArrayXXd(share / weighted.colwise().sum().maxCoeff() * weighted);
  };
  const Eigen::ArrayXXd near =
      scaled((-0.5 * (distance / kernel.near).square()).exp(), 1.0 - kernel.far_share, "near", kernel.near);
  const Eigen::ArrayXXd far = scaled((-distance / kernel.far).exp(), kernel.far_share, "far", kernel.far);
  depth_ = (near + far).colwise() - kernel.swell / area.sum() * area;
  if (kernel.stretch == 0.0) return;

  // dG/dr along the skin's tangent at the element, away from the electrode. Over an electrode a dent of the far kernel goes as fast whichever
  // way it is dragged: no direction, no term.
  const Eigen::ArrayXXd slope = -(near * distance / (kernel.near * kernel.near) + far / kernel.far);
  drag_.setZero(3 * n, columns);
  for (Eigen::Index e = 0; e < columns; ++e) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (distance(i, e) == 0.0) continue;
      const Element& element = elements[static_cast<std::size_t>(i)];
      const Eigen::Vector3d away = (element.tip - skin.above[static_cast<std::size_t>(e)]) / distance(i, e);
      const Eigen::Vector3d along = away - element.axis * element.axis.dot(away);
      for (Eigen::Index k = 0; k < 3; ++k) drag_(k * n + i, e) = kernel.stretch * slope(i, e) * along[k];
    }
  }
}

}  // namespace slipbench::biotac_sp
