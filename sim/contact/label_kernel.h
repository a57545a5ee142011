// The vectorised passes from the elements of a field to the labels of its units.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/api/effect.h"
#include "sim/contact/kernel.h"

namespace slipbench::kernel {

// Sums over the elements of a unit, each column added in the order of the elements.
struct UnitSum {
  static constexpr std::size_t vector_columns = 12;
  // The columns that are summed: `vectors` directly, the others as members of UnitSum.
  struct Summed {
    std::array<const double*, vector_columns> vectors;
    const double *path, *limit, *f_normal, *mode;
  };
  std::array<double, vector_columns> vectors;
  double path, limit;
  double normal_force;        // N, of the elements that touch
  double touching, slipping;  // numbers of elements
};
UnitSum sum_unit(const UnitSum::Summed& columns, std::size_t first, std::size_t count);

// Input of the labels, one entry per unit: sums over its elements, vectors by component.
struct UnitColumns {
  // columns pad.force, pad.deflection and pad.slip
  std::array<const double*, 3> force, deflection, slip;
  std::array<const double*, 3> tangential, normal;  // columns force and normal
  const double *path, *limit;
  const double* touching;  // 0: no element of the unit touches
  const double* share;     // 1/elements of the unit
};

// Fills force, and displacement if asked for, of a frame's units from `first` to before `end`:
// FramePart::felt.
void label_felt(const UnitColumns& units, std::size_t first, std::size_t end, bool displacement, ContactFrame& frame);
// Fills the columns of `frame` (contact_frame.h), except the states, for units from `first` to
// before `end`. `turn`: rotation into the contact plane, null if that is the pad's own; `rate`:
// 1/step [1/s]; `cone`: replaces the circular cone, or null.
void label_units(const UnitColumns& units, const Eigen::Matrix3d* turn, double rate, const ConeEffect* cone, std::size_t first,
                 std::size_t end, ContactFrame& frame);
// The same for groups of one-element units, each with its own normal. `to_pad`: rotation of the
// surface in the pad.
void label_groups(const UnitColumns& units, const Eigen::Matrix3d& to_pad, double rate, const Groups& groups, std::size_t count,
                  ContactFrame& frame);
// The same, or its felt part, for `count` >= lanes one-element units on a plane whose normal is
// exactly the pad's Z, without a preceding view_from_pad(), and their states. `rotation`,
// `transmitted`: as there.
void label_level_elements(const Columns& columns, const Eigen::Matrix3d& rotation, const VectorColumns& transmitted, double rate,
                          std::size_t count, FramePart part, ContactFrame& frame);

}  // namespace slipbench::kernel
