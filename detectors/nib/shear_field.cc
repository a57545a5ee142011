#include "detectors/nib/shear_field.h"

namespace slipbench::nib {

double ShearField::total_normal() const {
  double sum = 0.0;
  for (const double value : normal) sum += value;
  return sum;
}

Eigen::Vector2d ShearField::total_shear() const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& vector : shear) sum += vector;
  return sum;
}

ShearField shear_field(std::span<const double, taxels * electrodes> change) {
  ShearField field;
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    const std::span<const double> read = change.subspan(electrodes * taxel, electrodes);
    const double west = read[0], north = read[1], east = read[2], south = read[3];
    field.normal[taxel] = west + north + east + south;
    field.shear[taxel] = {east - west, north - south};
  }
  return field;
}

double curl(const ShearField& field) {
  // Over x = -1, 0, 1 in three rows the slope is sum x F / 6.
  double sum = 0.0;
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    const std::size_t column = taxel % 3, row = taxel / 3;
    const double x = static_cast<double>(column) - 1.0, y = 1.0 - static_cast<double>(row);
    sum += x * field.shear[taxel].y() - y * field.shear[taxel].x();
  }
  return sum / 6.0;
}

double normalised_curl(const ShearField& field) {
  double length = 0.0;
  for (const Eigen::Vector2d& vector : field.shear) length += vector.norm();
  return length > 0.0 ? curl(field) * static_cast<double>(taxels) / length : 0.0;
}

}  // namespace slipbench::nib
