// From elements to units: the truth about one pad, as sensors read it and datasets keep it.
#pragma once

#include <vector>

#include "sim/core/contact_frame.h"
#include "sim/field/field.h"

namespace slipbench {

// Sums a field's elements into units and tells what each unit and the pad do (contact_frame.h). Unit states are those of the model's
// elements; nothing is thresholded. The translation, centre and angle of the slip are the rigid motion that fits the slipping units'
// velocities best (least squares, equal weights).
class ContactLabels {
 public:
  explicit ContactLabels(const Field& field);

  // Reads the field after a step of `dt` that ended at `time` [s]. Must be called once after every step.
  const ContactFrame& update(Field& field, double time, double dt);

  [[nodiscard]] const ContactFrame& frame() const { return frame_; }

 private:
  struct UnitCount {
    std::uint32_t touching = 0;
    std::uint32_t slipping = 0;
  };

  // The shortest turn that brings the surface's normal onto +Z. Units that meet the same normal share it.
  class ContactPlane {
   public:
    void face(const Eigen::Vector3d& normal);
    [[nodiscard]] Eigen::Vector3d turned(const Eigen::Vector3d& v) const { return level_ ? v : turn_ * v; }
    [[nodiscard]] Eigen::Vector3d turned_back(const Eigen::Vector3d& v) const { return level_ ? v : turn_.transpose() * v; }

   private:
    Eigen::Vector3d normal_ = Eigen::Vector3d::UnitZ();
    Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
    bool level_ = true;
  };

  void sum_units(Field& field, double dt);
  void judge_pad();
  void fit_slip_motion(bool on_plane, double dt);
  void collect_events(const Field& field, double time, double dt);

  std::vector<UnitRange> units_;
  std::vector<double> shares_;  // 1/elements of the unit
  std::vector<std::uint32_t> unit_of_element_;
  Eigen::Array3Xd undeformed_;     // [3,N] m, mean of a unit's undeformed tips in P
  std::vector<UnitCount> counts_;  // as of the last event
  std::vector<ElementEvent> in_order_;
  ContactPlane contact_plane_;
  std::size_t touching_elements_ = 0;
  std::size_t sticking_elements_ = 0;
  ContactFrame frame_;
};

}  // namespace slipbench
