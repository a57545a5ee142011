#include "sim/contact/contact_labels.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace slipbench {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Columns of summed units: up to `summed` sums over all surfaces, then values on the surface with
// the greatest normal force.
namespace unit {
enum Column : std::size_t {
  force,  // kernel::UnitColumns
  deflection = force + 3,
  slip = deflection + 3,
  path = slip + 3,
  touching,
  slipping,
  summed,
  tangential = summed,
  normal = tangential + 3,
  limit = normal + 3,
  normal_force,  // [N]
  columns
};
}  // namespace unit

}  // namespace

ContactLabels::ContactLabels(const PadLayout& layout) : units_(layout.units), felt_(static_cast<std::size_t>(layout.unit_truth)) {
  const auto n = static_cast<Eigen::Index>(units_.size());
  unit_of_element_.resize(layout.elements.size());
  undeformed_.resize(3, n);
  for (std::size_t u = 0; u < units_.size(); ++u) {
    Eigen::Array3d sum(0.0, 0.0, 0.0);
    for (std::size_t i = 0; i < units_[u].count; ++i) sum += layout.elements[units_[u].first + i].tip.array();
    shares_.push_back(1.0 / static_cast<double>(units_[u].count));
    undeformed_.col(static_cast<Eigen::Index>(u)) = shares_[u] * sum;
    for (std::size_t i = 0; i < units_[u].count; ++i) unit_of_element_[units_[u].first + i] = static_cast<std::uint32_t>(u);
  }
  single_ = units_.size() == layout.elements.size();
  frame_.force.setZero(3, n);
  frame_.contact_force.setZero(3, n);
  frame_.displacement.setZero(3, n);
  frame_.slip_velocity.setZero(2, n);
  frame_.slip_distance.setZero(n);
  frame_.margin.setConstant(n, nan);
  frame_.unit_state.assign(units_.size(), UnitState::detached);
  if (layout.element_truth) {
    const auto elements = static_cast<Eigen::Index>(layout.elements.size());
    frame_.element_depth.setZero(elements);
    frame_.element_shear.setZero(elements, 3);
  }
  changes_.reserve(layout.elements.size());
  frame_.events.reserve(3 * layout.elements.size());
}

const ContactFrame& ContactLabels::update(std::span<Field> fields, double time, double dt) {
  judge(fields, time, dt);
  fill(fields, FramePart::all);
  settle(fields, dt);
  return frame_;
}

void ContactLabels::judge(std::span<Field> fields, double time, double dt) {
  frame_.time = time;
  rate_ = 1.0 / dt;
  slip_rate_ = 0.0;
  filled_ = FramePart::states;
  elements_ = {};
  for (const Field& field : fields) {
    elements_.touching += static_cast<std::uint32_t>(field.touching());
    elements_.slipping += static_cast<std::uint32_t>(field.slipping());
  }
  if (single_ && fields.size() == 1) {
    unit_rules::judge_pad_of_elements(frame_, elements_);
  } else {
    std::uint64_t changes = 0;
    for (const Field& field : fields) changes += field.changes();
    if (counts_.empty() || changes != counted_) count_units(fields);
    counted_ = changes;
    unit_rules::judge_pad(frame_, elements_);
  }
  // In a sparse field zeros of separating elements keep the sign that they are rotated to.
  if (keeps_angle_ && (elements_.slipping > 0 || fields.front().sparse())) fill(fields, FramePart::all);
}

void ContactLabels::count_units(std::span<Field> fields) {
  counts_.assign(units_.size(), {});
  for (const Field& field : fields) {
    for_each_in(field.active(), [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) counts_[unit_of_element_[i]].add(field.state(i));
    });
  }
  std::ranges::transform(counts_, frame_.unit_state.begin(), unit_rules::unit_state);
}

const ContactFrame& ContactLabels::fill(std::span<Field> fields, FramePart part) {
  if (filled_ >= part) return frame_;
  // whoever reads the angle reads all values at each sample
  filled_ = keeps_angle_ ? FramePart::all : part;
  label_units(fields, filled_);
  if (frame_.element_depth.size() > 0) label_elements(fields);
  if (filled_ == FramePart::all || felt_ > 0) {
    shaken_ = shaking_ != 0.0;
    if (shaken_) frame_.force.row(2) += shaking_;
  }
  if (filled_ != FramePart::all) return frame_;
  const bool one_plane = fields.size() == 1 && fields.front().on_plane();
  slip_rate_ = unit_rules::fit_slip_motion(frame_, undeformed_, one_plane ? contact_plane_ : unit_rules::ContactPlane{});
  return frame_;
}

void ContactLabels::settle(std::span<const Field> fields, double dt) {
  frame_.slip_angle += slip_rate_ * dt;
  frame_.events.clear();
  changes_.clear();
  const double begun = std::exchange(settled_, frame_.time);
  for (const Field& field : fields) {
    for (const ElementEvent& event : field.events()) changes_.push_back({event, unit_of_element_[event.element]});
  }
  if (changes_.empty()) return;
  const auto before = [&](std::uint32_t unit) { return count_before(fields, unit); };
  unit_rules::report_unit_events(changes_, before, begun, frame_.time, dt, frame_.events);
}

void ContactLabels::label_units(std::span<Field> fields, FramePart part) {
  const bool all = part == FramePart::all;
  if (single_ && fields.size() == 1 && fields.front().level()) {
    if (all) contact_plane_.face(Eigen::Vector3d::UnitZ());
    fields.front().label_level(rate_, part, frame_);
    return;
  }
  const std::size_t vectors = all ? 3 : felt_;
  for (std::vector<std::uint64_t>& seen : seen_) seen.resize(fields.size());
  for (std::size_t k = 0; k < fields.size(); ++k) {
    Field& field = fields[k];
    // All groups, if the field is another one or has not stepped.
    const std::uint64_t seen = seen_[all ? 1 : 0][k];
    viewed_ = field.active_since(field.steps() > seen ? seen : 0);
    seen_[0][k] = field.steps();
    if (all) seen_[1][k] = field.steps();
    if (vectors > 0) field.view_from_pad(viewed_, vectors);
  }
  if (vectors == 0) return;
  const bool one_field = fields.size() == 1;
  if (!all && !(one_field && single_)) return feel(fields, vectors);
  const kernel::UnitColumns units = one_field && single_ ? elements_as_units(fields.front()) : sum_fields(fields);
  const std::size_t count = units_.size();
  const Field& front = fields.front();
  if (shaken_ && front.sparse()) frame_.force.row(2).setZero();  // also of units that touch nothing
  if (!all) {
    for_each_in(viewed_, [&](std::size_t first, std::size_t end) { kernel::label_felt(units, first, end, vectors > 1, frame_); });
    return;
  }
  if (one_field && single_) {
    const double* const mode = front.columns().mode;
    for_each_in(viewed_, [&](std::size_t first, std::size_t end) {
      for (std::size_t u = first; u < end; ++u) frame_.unit_state[u] = static_cast<UnitState>(static_cast<int>(mode[u]));
    });
  }
  // Units with individual normals. Pads other than skins are rotated run by run, and their zeros
  // may have another sign.
  const bool apiece = front.sparse() || (front.has_skin() && !front.on_plane());
  if (one_field && single_ && apiece) {
    kernel::label_groups(units, front.pad_in_surface().rotation.transpose(), rate_, viewed_, count, frame_);
    return;
  }
  const auto most_loaded = [&](std::size_t u) { return one_field ? &fields.front() : most_loaded_[u]; };
  const auto normal = [&](std::size_t u) { return Eigen::Vector3d(units.normal[0][u], units.normal[1][u], units.normal[2][u]); };
  // Units with the same normal are rotated together, and so are units without contact: all their
  // values are 0 unless their tips ring.
  const bool rings = std::ranges::any_of(fields, &Field::has_tips);
  const auto apart = [&](std::size_t u) { return !rings && units.touching[u] == 0.0; };
  for (std::size_t first = 0, end = 0; first < count; first = end) {
    while (end + 1 < count && apart(end)) ++end;
    const Field& field = *most_loaded(end);
    const Eigen::Vector3d met = normal(end);
    end = one_field && field.on_plane() ? count : end + 1;
    while (end < count && (apart(end) || (most_loaded(end) == &field && normal(end) == met))) ++end;
    contact_plane_.face(field.pad_in_surface().rotation.transpose() * met);
    kernel::label_units(units, contact_plane_.turn(), rate_, field.effect_cone(), first, end, frame_);
  }
}

// Force and displacement of units of several elements, or on several surfaces, bit-identical to
// sum_fields().
void ContactLabels::feel(std::span<const Field> fields, std::size_t vectors) {
  for (std::size_t u = 0; u < units_.size(); ++u) {
    // `of`: a vector of the pad frame; `k`: its component.
    const auto sum = [&](const auto& of, std::size_t k) {
      double total = 0.0;
      for (const Field& field : fields) {
        const double* const values = of(field).components()[k] + units_[u].first;
        double of_unit = values[0];
        for (std::size_t i = 1; i < units_[u].count; ++i) of_unit += values[i];
        total = fields.size() == 1 ? of_unit : total + of_unit;
      }
      return total;
    };
    const auto force = [](const Field& field) -> const kernel::VectorColumns& { return field.columns().pad.force; };
    const auto deflection = [](const Field& field) -> const kernel::VectorColumns& { return field.columns().pad.deflection; };
    const auto column = static_cast<Eigen::Index>(u);
    for (std::size_t k = 0; k < 3; ++k) {
      frame_.force(static_cast<Eigen::Index>(k), column) = sum(force, k);
      if (vectors > 1) frame_.displacement(static_cast<Eigen::Index>(k), column) = shares_[u] * sum(deflection, k);
    }
  }
}

void ContactLabels::label_elements(std::span<const Field> fields) {
  double* const depth = frame_.element_depth.data();
  const std::array<double*, 3> shear{frame_.element_shear.col(0).data(), frame_.element_shear.col(1).data(),
                                     frame_.element_shear.col(2).data()};
  const bool sparse = fields.size() == 1 && fields.front().sparse();
  if (sparse) {
    for_each_in(viewed_, [&](std::size_t first, std::size_t end) {
      for (double* const column : {depth, shear[0], shear[1], shear[2]}) std::fill(column + first, column + end, 0.0);
    });
  } else {
    frame_.element_depth.setZero();
    frame_.element_shear.setZero();
  }
  for (const Field& field : fields) field.add_elements(sparse ? viewed_ : field.all(), depth, shear);
}

// Calls visit(first, end) for the elements of each group, or once for all elements.
template <class Visit>
void ContactLabels::for_each_in(const kernel::Groups& groups, Visit&& visit) const {
  if (groups.first == nullptr) return visit(std::size_t{0}, unit_of_element_.size());
  for (std::size_t k = 0; k < groups.count; ++k) {
    visit(groups[k], std::min(unit_of_element_.size(), groups[k] + kernel::lanes));
  }
}

// Returns the elements' columns as those of units of one element on one surface.
kernel::UnitColumns ContactLabels::elements_as_units(const Field& field) {
  const kernel::Columns& c = field.columns();
  const auto vector = [](const kernel::VectorColumns& v) { return std::array<const double*, 3>{v.x, v.y, v.z}; };
  return {vector(c.pad.force),
          vector(c.pad.deflection),
          vector(c.pad.slip),
          vector(c.force),
          vector(c.normal),
          c.path,
          c.limit,
          c.mode,
          shares_.data()};
}

// Sums the elements of units of several elements, or on several surfaces.
kernel::UnitColumns ContactLabels::sum_fields(std::span<Field> fields) {
  const auto count = static_cast<Eigen::Index>(units_.size());
  sums_.resize(count, unit::columns);
  const auto column = [this](std::size_t c) { return sums_.col(static_cast<Eigen::Index>(c)).data(); };
  if (fields.size() == 1 && fields.front().sparse()) {
    sum_viewed(fields.front());
  } else if (fields.size() == 1) {
    sum_elements(fields.front(), 0, units_.size(), sums_);
  } else {
    const auto own = static_cast<Eigen::Index>(unit::columns - unit::summed);
    most_loaded_.assign(units_.size(), &fields.front());
    sums_.setZero();
    sums_.col(unit::normal + 2).setOnes();
    on_one_.resize(count, unit::columns);
    for (const Field& field : fields) {
      sum_elements(field, 0, units_.size(), on_one_);
      sums_.leftCols(unit::summed) += on_one_.leftCols(unit::summed);
      for (Eigen::Index u = 0; u < count; ++u) {
        if (!(on_one_(u, unit::normal_force) > sums_(u, unit::normal_force))) continue;
        sums_.row(u).tail(own) = on_one_.row(u).tail(own);
        most_loaded_[static_cast<std::size_t>(u)] = &field;
      }
    }
  }
  const auto vector = [&](std::size_t x) { return std::array<const double*, 3>{column(x), column(x + 1), column(x + 2)}; };
  return {vector(unit::force),      vector(unit::deflection), vector(unit::slip),
          vector(unit::tangential), vector(unit::normal),     column(unit::path),
          column(unit::limit),      column(unit::touching),   shares_.data()};
}

// Recomputes the sums of units of which an element has been viewed; all others are unchanged. The
// normal is the exception: it only counts if nothing touches, and then the last unit's normal
// stands for all (label_units).
void ContactLabels::sum_viewed(Field& field) {
  std::size_t next = 0;  // first unit that has not been summed
  for_each_in(viewed_, [&](std::size_t first, std::size_t end) {
    const std::size_t last = unit_of_element_[end - 1] + std::size_t{1};
    next = std::max(next, std::size_t{unit_of_element_[first]});
    if (next < last) sum_elements(field, next, last, sums_);
    next = std::max(next, last);
  });
  if (sums_(sums_.rows() - 1, unit::touching) != 0.0) return;
  const std::size_t last = units_.back().first;
  field.update_contact_point(last);
  sums_.row(sums_.rows() - 1).segment<3>(unit::normal) = field.normal(last).transpose();
}

// Sums the elements of the units from `begin` to before `end_unit` on one surface. Values are in
// the pad frame, but the tangential force and the normal are in the surface's. The normal is that
// of the element with the greatest normal force, since an element beside the surface has the normal
// of another face.
void ContactLabels::sum_elements(const Field& field, std::size_t begin, std::size_t end_unit, Eigen::ArrayXXd& sums) const {
  const kernel::Columns& c = field.columns();
  // The vectors among the columns, and their position in `sums`.
  const std::array<std::pair<const kernel::VectorColumns&, std::size_t>, 4> summed{
      {{c.pad.force, unit::force}, {c.pad.deflection, unit::deflection}, {c.pad.slip, unit::slip}, {c.force, unit::tangential}}};
  kernel::UnitSum::Summed from{{}, c.path, c.limit, c.f_normal, c.mode};
  for (std::size_t v = 0; v < from.vectors.size(); ++v) from.vectors[v] = summed[v / 3].first.components()[v % 3];
  const bool curved = !field.on_plane();
  for (std::size_t u = begin; u < end_unit; ++u) {
    const std::size_t first = units_[u].first, end = first + units_[u].count;
    const kernel::UnitSum sum = kernel::sum_unit(from, first, units_[u].count);
    std::size_t most_loaded = first;
    if (curved && sum.normal_force > 0.0) {
      double most = std::max(0.0, from.f_normal[first]);
      for (std::size_t i = first + 1; i < end; ++i) {
        if (from.f_normal[i] > most) most = from.f_normal[most_loaded = i];
      }
    }
    const auto row = static_cast<Eigen::Index>(u);
    const auto set = [&](std::size_t column, double value) { sums(row, static_cast<Eigen::Index>(column)) = value; };
    for (std::size_t v = 0; v < from.vectors.size(); ++v) set(summed[v / 3].second + v % 3, sum.vectors[v]);
    set(unit::path, sum.path);
    set(unit::limit, sum.limit);
    set(unit::touching, sum.touching);
    set(unit::slipping, sum.slipping);
    set(unit::normal_force, sum.normal_force);
    for (const std::size_t k : {0U, 1U, 2U}) set(unit::normal + k, c.normal.components()[k][most_loaded]);
  }
}

unit_rules::Count ContactLabels::count_before(std::span<const Field> fields, std::uint32_t unit) const {
  unit_rules::Count count;
  for (const Field& field : fields) {
    for (std::size_t i = 0; i < units_[unit].count; ++i) count.add(field.state_before(units_[unit].first + i));
  }
  return count;
}

}  // namespace slipbench
