#include "sensors/biotac_sp/transduction.h"

#include <cmath>

namespace slipbench::biotac_sp {

Dents::Dents(const Skin& skin, const Kernel& kernel) {
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
  const auto scaled = [&](const Eigen::ArrayXXd& felt, double share) {
    const Eigen::ArrayXXd weighted = felt.colwise() * area;
    return Eigen::ArrayXXd(share / weighted.colwise().sum().maxCoeff() * weighted);
  };
  const Eigen::ArrayXXd near = scaled((-0.5 * (distance / kernel.near).square()).exp(), 1.0 - kernel.far_share);
  const Eigen::ArrayXXd far = scaled((-distance / kernel.far).exp(), kernel.far_share);
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
