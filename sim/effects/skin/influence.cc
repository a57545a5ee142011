#include "sim/effects/skin/influence.h"

#include <fftw3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <mutex>
#include <new>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/fftw_planner.h"
#include "sim/core/math.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"
#include "sim/effects/skin/bessel.h"

namespace slipbench {
namespace {

using std::numbers::pi;

// Displacements of a point under a unit force on a cell: normal and tangential [m/N].
struct Kernel {
  double normal, xx, yy, xy;
};

// Half-space, rectangle [x1, x2] x [y1, y2] around the point, loaded by 1 N/m^2: the integrals of
// 1/r, x^2/r^3, y^2/r^3 and x y/r^3 from corner to corner [love1929].
Kernel rectangle(double x1, double x2, double y1, double y2, double shear_modulus) {
  double along_x = 0.0, along_y = 0.0, mixed = 0.0;
  const auto corner = [&](double x, double y, double sign) {
    const double r = math::hypot(x, y);
    // ln(a + length), in the form that does not cancel for a < 0.
    const auto log_of = [](double a, double b, double length) {
      return a >= 0.0 ? math::log(a + length) : 2.0 * math::log(std::abs(b)) - math::log(length - a);
    };
    along_x += sign * (y == 0.0 ? 0.0 : y * log_of(x, y, r));
    along_y += sign * (x == 0.0 ? 0.0 : x * log_of(y, x, r));
    mixed -= sign * r;
  };
  corner(x2, y2, 1.0);
  corner(x1, y2, -1.0);
  corner(x2, y1, -1.0);
  corner(x1, y1, 1.0);
  const double c = 1.0 / (4.0 * pi * shear_modulus), inverse = along_x + along_y;
  return {c * inverse, c * (inverse + along_x), c * (inverse + along_y), c * mixed};
}

// Eight-point Gauss-Legendre rule on [-1, 1]: calls visit(x, weight).
template <class Visit>
void gauss_legendre(Visit&& visit) {
  constexpr std::array node{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  constexpr std::array weight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
  for (std::size_t k = 0; k < node.size(); ++k) {
    visit(node[k], weight[k]);
    visit(-node[k], weight[k]);
  }
}

// Reduction of the displacement at distance r by the rigid back: the inverse transforms of the
// layer's compliance less the half-space's,
//   (1/4 pi G t) Int (N(u) - 1) J0(u r/t) du  and alike.
// They are smooth over a thickness, and are read from a table by cubic interpolation.
class RigidBack {
 public:
  // `reach`: the largest distance needed [m].
  RigidBack(const ElasticBody& body, double reach) : body_(body), spacing_(body.thickness / 16.0) {
    for (std::size_t k = 0; static_cast<double>(k) * spacing_ < reach + 3.0 * spacing_; ++k) {
      rows_.push_back(integrals(static_cast<double>(k) / 16.0));
    }
  }

  [[nodiscard]] Kernel at(double x, double y) const {
    const double r = math::hypot(x, y);
    const double place = r / spacing_;
    // The functions are even in r: the row before the first equals the second.
    const auto k = static_cast<std::ptrdiff_t>(place);
    const double f = place - static_cast<double>(k);
    const std::array share{-f * (f - 1.0) * (f - 2.0) / 6.0, (f + 1.0) * (f - 1.0) * (f - 2.0) / 2.0,
                           -(f + 1.0) * f * (f - 2.0) / 2.0, (f + 1.0) * f * (f - 1.0) / 6.0};
    std::array<double, 3> read{};
    for (std::ptrdiff_t i = 0; i < 4; ++i) {
      const auto& row = rows_[static_cast<std::size_t>(std::abs(k - 1 + i))];
      for (std::size_t c = 0; c < 3; ++c) read[c] += share[static_cast<std::size_t>(i)] * row[c];
    }
    const double scale = 1.0 / (4.0 * pi * body_.shear_modulus * body_.thickness);
    const double cos2 = r > 0.0 ? (x * x - y * y) / (r * r) : 0.0, sin2 = r > 0.0 ? 2.0 * x * y / (r * r) : 0.0;
    const auto [normal, alike, turning] = read;
    return {scale * normal, scale * (alike - turning * cos2), scale * (alike + turning * cos2), -scale * turning * sin2};
  }

 private:
  // At r = rho t: the integrals of the normal part, of the isotropic tangential part and of the
  // tangential part that varies with direction.
  static std::array<double, 3> integrals(double rho) {
    constexpr double far = 20.0;  // where exp(-2 u) is below rounding error
    // short compared with the waves of J
    const auto pieces = static_cast<int>(std::ceil(far * std::max(0.5, rho / pi)));
    const double half = 0.5 * far / pieces;
    std::array<double, 3> sum{};
    for (int piece = 0; piece < pieces; ++piece) {
      gauss_legendre([&](double x, double weight) {
        const double u = half * (2.0 * piece + 1.0 + x), w = half * weight;
        const auto [j0, j2] = bessel(u * rho);
        const LayerCompliance c = layer_compliance(u);
        const double along = c.along - 1.0, across = 2.0 * (c.across - 1.0);
        sum[0] += w * (c.normal - 1.0) * j0;
        sum[1] += w * 0.5 * (along + across) * j0;
        sum[2] += w * 0.5 * (along - across) * j2;
      });
    }
    return sum;
  }

  ElasticBody body_;
  double spacing_;                           // m
  std::vector<std::array<double, 3>> rows_;  // at k spacings
};

// Returns the mean displacement of a cell of a x b [m] under a unit force on another one, (x, y)
// [m] from centre to centre.
Kernel cell_on_cell(double x, double y, double a, double b, const ElasticBody& body, const std::optional<RigidBack>& back) {
  Kernel sum{};
  const auto add = [&](double w, const Kernel& k) {
    sum.normal += w * k.normal;
    sum.xx += w * k.xx;
    sum.yy += w * k.yy;
    sum.xy += w * k.xy;
  };
  gauss_legendre([&](double across, double w_across) {
    gauss_legendre([&](double up, double w_up) {
      const double px = x + 0.5 * a * across, py = y + 0.5 * b * up;
      add(0.25 * w_across * w_up / (a * b),
          rectangle(px - 0.5 * a, px + 0.5 * a, py - 0.5 * b, py + 0.5 * b, body.shear_modulus));
    });
  });
  if (back) {  // distances between points of two cells have the same variance as these four
    for (const double right : {-1.0, 1.0}) {
      for (const double up : {-1.0, 1.0}) add(0.25, back->at(x + right * a / std::sqrt(6.0), y + up * b / std::sqrt(6.0)));
    }
  }
  // Rounded to float, so that differences in the last bits do not show.
  const auto rounded = [](double value) { return static_cast<double>(static_cast<float>(value)); };
  return {rounded(sum.normal), rounded(sum.xx), rounded(sum.yy), rounded(sum.xy)};
}

// A full grid of elements, all along -Z.
struct Grid {
  std::size_t columns, rows;
  double a, b;                       // m, edges of a cell along x and y
  std::vector<std::uint32_t> place;  // [n] index in the grid, row * columns + column
};

constexpr double rounding = 1e-6;  // of a cell

std::optional<Grid> grid_of(const PadLayout& layout) {
  std::array<std::vector<double>, 2> at;
  for (const Element& e : layout.elements) {
    if (e.axis != Eigen::Vector3d(0.0, 0.0, -1.0)) return std::nullopt;
    for (const int k : {0, 1}) at[static_cast<std::size_t>(k)].push_back(e.tip[k]);
  }
  std::array<double, 2> first{}, edge{};
  std::array<std::size_t, 2> count{};
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<double> sorted = at[k];
    std::ranges::sort(sorted);
    const double span = sorted.back() - sorted.front();
    std::vector<double> lines{sorted.front()};
    for (const double x : sorted) {
      if (x - lines.back() > rounding * span) lines.push_back(x);
    }
    first[k] = lines.front();
    count[k] = lines.size();
    edge[k] = lines.size() > 1 ? span / static_cast<double>(lines.size() - 1) : 0.0;
  }
  if (count[0] * count[1] != layout.elements.size() || layout.elements.size() == 1) return std::nullopt;
  if (edge[0] == 0.0) edge[0] = edge[1];
  if (edge[1] == 0.0) edge[1] = edge[0];
  Grid grid{count[0], count[1], edge[0], edge[1], {}};
  std::vector<bool> taken(layout.elements.size());
  for (std::size_t i = 0; i < layout.elements.size(); ++i) {
    const double column = (at[0][i] - first[0]) / edge[0], row = (at[1][i] - first[1]) / edge[1];
    const double c = std::round(column), r = std::round(row);
    if (std::abs(column - c) > rounding || std::abs(row - r) > rounding) return std::nullopt;
    const std::size_t place = static_cast<std::size_t>(r) * grid.columns + static_cast<std::size_t>(c);
    if (taken[place]) return std::nullopt;
    taken[place] = true;
    grid.place.push_back(static_cast<std::uint32_t>(place));
  }
  return grid;
}

// A convolution on a grid with twice the rows and columns. The added halves carry no load: their
// rows need no transform.
class GridInfluence final : public Influence {
 public:
  GridInfluence(const Grid& grid, const ElasticBody& body)
      : loaded_(grid.rows), columns_(2 * grid.columns), rows_(2 * grid.rows), waves_(columns_ / 2 + 1) {
    for (const std::uint32_t place : grid.place) {
      place_.push_back(static_cast<std::uint32_t>(place / grid.columns * columns_ + place % grid.columns));
    }
    field_.reset(fftw_alloc_real(loaded_ * columns_));
    std::fill_n(field_.get(), loaded_ * columns_, 0.0);
    way_.reset(fftw_alloc_real(loaded_ * columns_));
    by_rows_.reset(fftw_alloc_complex(rows_ * waves_));
    std::fill_n(&by_rows_.get()[0][0], 2 * rows_ * waves_, 0.0);
    for (auto& spectrum : spectrum_) spectrum.reset(fftw_alloc_complex(rows_ * waves_));
    make_plans();
    tabulate(grid, body);
  }

  void press(const double* force, double* way) override {
    load(force, 0);
    for (std::size_t k = 0; k < rows_ * waves_; ++k) {
      spectrum_[0].get()[k][0] *= normal_[k];
      spectrum_[0].get()[k][1] *= normal_[k];
    }
    unload(0, way);
  }

  void shear(const double* force_x, const double* force_y, double* way_x, double* way_y) override {
    load(force_x, 0);
    load(force_y, 1);
    fftw_complex *const x = spectrum_[0].get(), *const y = spectrum_[1].get();
    for (std::size_t k = 0; k < rows_ * waves_; ++k) {
      for (const int part : {0, 1}) {
        const double qx = x[k][part], qy = y[k][part];
        x[k][part] = xx_[k] * qx + xy_[k] * qy;
        y[k][part] = xy_[k] * qx + yy_[k] * qy;
      }
    }
    unload(0, way_x);
    unload(1, way_y);
  }

 private:
  struct Free {
    void operator()(void* block) const { fftw_free(block); }
  };
  struct Destroy {
    void operator()(fftw_plan plan) const {
      const std::lock_guard lock(fftw_planner());
      fftw_destroy_plan(plan);
    }
  };
  using Plan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, Destroy>;

  // Plans for the loaded rows, real numbers to spectra and back, and for the columns of spectra.
  void make_plans() {
    const std::lock_guard lock(fftw_planner());
    const int length = static_cast<int>(columns_), height = static_cast<int>(rows_), waves = static_cast<int>(waves_),
              loaded = static_cast<int>(loaded_);
    fftw_complex *const by_rows = by_rows_.get(), *const spectrum = spectrum_[0].get();
    rows_forward_.reset(fftw_plan_many_dft_r2c(1, &length, loaded, field_.get(), nullptr, 1, length, by_rows, nullptr, 1, waves,
                                               fftw_plan_flags | FFTW_PRESERVE_INPUT));
    rows_back_.reset(
        fftw_plan_many_dft_c2r(1, &length, loaded, spectrum, nullptr, 1, waves, way_.get(), nullptr, 1, length, fftw_plan_flags));
    const auto columns = [&](fftw_complex* from, int sign, unsigned flags) {
      return fftw_plan_many_dft(1, &height, waves, from, nullptr, waves, 1, spectrum, nullptr, waves, 1, sign,
                                fftw_plan_flags | flags);
    };
    columns_forward_.reset(columns(by_rows, FFTW_FORWARD, FFTW_PRESERVE_INPUT));
    columns_back_.reset(columns(spectrum, FFTW_BACKWARD, 0));
    if (!rows_forward_ || !rows_back_ || !columns_forward_ || !columns_back_) throw std::bad_alloc();
  }

  // Cells outside the pad stay 0 from the constructor on, in field_ and in by_rows_.
  void load(const double* force, std::size_t k) {
    for (std::size_t i = 0; i < place_.size(); ++i) field_.get()[place_[i]] = force[i];
    fftw_execute_dft_r2c(rows_forward_.get(), field_.get(), by_rows_.get());
    fftw_execute_dft(columns_forward_.get(), by_rows_.get(), spectrum_[k].get());
  }
  void unload(std::size_t k, double* way) {
    fftw_complex* const spectrum = spectrum_[k].get();
    fftw_execute_dft(columns_back_.get(), spectrum, spectrum);
    fftw_execute_dft_c2r(rows_back_.get(), spectrum, way_.get());
    for (std::size_t i = 0; i < place_.size(); ++i) way[i] = way_.get()[place_[i]];
  }

  // Tabulates the kernels' transforms. All are real: the kernels are even in x and in y, or odd in
  // both.
  void tabulate(const Grid& grid, const ElasticBody& body) {
    std::vector<Kernel> quarter(grid.rows * grid.columns);
    std::optional<RigidBack> back;
    if (std::isfinite(body.thickness)) {
      back.emplace(body, math::hypot(static_cast<double>(grid.columns) * grid.a, static_cast<double>(grid.rows) * grid.b));
    }
    for (std::size_t row = 0; row < grid.rows; ++row) {
      for (std::size_t column = 0; column < grid.columns; ++column) {
        quarter[row * grid.columns + column] =
            cell_on_cell(static_cast<double>(column) * grid.a, static_cast<double>(row) * grid.b, grid.a, grid.b, body, back);
      }
    }
    own_normal_ = quarter.front().normal;
    own_tangential_ = 0.5 * (quarter.front().xx + quarter.front().yy);
    std::vector<double> field(rows_ * columns_);
    std::vector<std::complex<double>> whole(rows_ * waves_);
    Plan plan;
    {
      const std::lock_guard lock(fftw_planner());
      plan.reset(fftw_plan_dft_r2c_2d(static_cast<int>(rows_), static_cast<int>(columns_), field.data(),
                                      reinterpret_cast<fftw_complex*>(whole.data()), fftw_plan_flags));
    }
    if (!plan) throw std::bad_alloc();
    const auto transform = [&](double Kernel::*component, bool odd, std::vector<double>& spectrum) {
      std::ranges::fill(field, 0.0);
      for (std::size_t row = 0; row < grid.rows; ++row) {
        for (std::size_t column = 0; column < grid.columns; ++column) {
          const double value = quarter[row * grid.columns + column].*component;
          const std::size_t below = (rows_ - row) % rows_, left = (columns_ - column) % columns_;
          field[row * columns_ + column] = field[below * columns_ + left] = value;
          field[row * columns_ + left] = field[below * columns_ + column] = odd ? -value : value;
        }
      }
      fftw_execute(plan.get());
      const double scale = 1.0 / static_cast<double>(rows_ * columns_);
      for (const std::complex<double>& wave : whole) spectrum.push_back(scale * wave.real());
    };
    transform(&Kernel::normal, false, normal_);
    transform(&Kernel::xx, false, xx_);
    transform(&Kernel::yy, false, yy_);
    transform(&Kernel::xy, true, xy_);
  }

  std::size_t loaded_;                           // rows of the pad
  std::size_t columns_, rows_, waves_;           // of the doubled grid
  std::vector<std::uint32_t> place_;             // [n] index in the doubled grid
  std::unique_ptr<double, Free> field_, way_;    // rows of the pad: forces, and displacements
  std::unique_ptr<fftw_complex, Free> by_rows_;  // their transforms, row by row
  // of both directions
  std::array<std::unique_ptr<fftw_complex, Free>, 2> spectrum_;
  Plan rows_forward_, rows_back_, columns_forward_, columns_back_;
  std::vector<double> normal_, xx_, yy_, xy_;  // [rows, waves] m/N
};

// Returns the mean distance from each element to its nearest neighbour [m].
double mean_distance(const PadLayout& layout) {
  if (layout.elements.size() < 2) {
    throw SceneValueError("effects", "elastic_skin: a single element has no distance to others; set patch above 0");
  }
  double sum = 0.0;
  for (const Element& here : layout.elements) {
    double least = std::numeric_limits<double>::infinity();
    for (const Element& there : layout.elements) {
      if (&here != &there) least = std::min(least, (here.tip - there.tip).norm());
    }
    sum += least;
  }
  return sum / static_cast<double>(layout.elements.size());
}

// Elements at any positions on a curved skin, whose patches are small compared with its radii. In
// three dimensions both laws are one tensor, (1/4 pi G)(1/r + r r'/r^3), of which each element uses
// its own axis and tangents.
class MeshInfluence final : public Influence {
 public:
  MeshInfluence(const PadLayout& layout, const ElasticBody& body, double patch) {
    const auto n = static_cast<Eigen::Index>(layout.elements.size());
    for (Eigen::MatrixXd* m : {&normal_, &xx_, &yy_, &xy_}) m->resize(n, n);
    const double c = 1.0 / (4.0 * pi * body.shear_modulus), radius = patch / std::sqrt(pi);
    // A round patch under a uniform load: its mean displacement equals that at a distance of 3
    // pi/16 radii from a point load ([johnson1985], sec. 3.4).
    own_normal_ = c * 16.0 / (3.0 * pi * radius);
    own_tangential_ = 1.5 * own_normal_;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Element& to = layout.elements[static_cast<std::size_t>(i)];
      const Eigen::Matrix3d here = element_frame(to.axis);
      for (Eigen::Index j = 0; j < n; ++j) {
        const Element& from = layout.elements[static_cast<std::size_t>(j)];
        const Eigen::Vector3d d = to.tip - from.tip;
        const double r = d.norm();
        if (i != j && r == 0.0) {
          throw SceneValueError(
              "effects",
              fmt::format(
                  "elastic_skin: elements {} and {} are at the same position; use one element for each position (bristles: 1)", j,
                  i));
        }
        const Eigen::Matrix3d tensor = c / r * (Eigen::Matrix3d::Identity() + d * d.transpose() / (r * r));
        const Eigen::Matrix3d seen = here.transpose() * tensor * element_frame(from.axis);
        if (i != j && c / r >= own_normal_) {
          throw SceneValueError(
              "effects",
              fmt::format("elastic_skin: patch {} is too wide for the elements {} and {}, which are {} apart; allowed: up to {}",
                          readable_quantity(patch, Quantity::length), j, i, readable_quantity(r, Quantity::length),
                          readable_quantity(16.0 / (3.0 * std::sqrt(pi)) * r, Quantity::length)));
        }
        normal_(i, j) = i == j ? own_normal_ : c / r;
        xx_(i, j) = i == j ? own_tangential_ : seen(0, 0);
        yy_(i, j) = i == j ? own_tangential_ : seen(1, 1);
        xy_(i, j) = i == j ? 0.0 : seen(0, 1);
      }
    }
  }

  void press(const double* force, double* way) override { map(way).noalias() = normal_ * map(force); }
  void shear(const double* force_x, const double* force_y, double* way_x, double* way_y) override {
    map(way_x).noalias() = xx_ * map(force_x);
    map(way_x).noalias() += xy_ * map(force_y);
    map(way_y).noalias() = yy_ * map(force_y);
    map(way_y).noalias() += xy_.transpose() * map(force_x);
  }

 private:
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> map(const double* v) const { return {v, normal_.rows()}; }
  [[nodiscard]] Eigen::Map<Eigen::VectorXd> map(double* v) const { return {v, normal_.rows()}; }

  Eigen::MatrixXd normal_, xx_, yy_, xy_;
};

}  // namespace

LayerCompliance layer_compliance(double s) {
  if (s > 20.0) return {1.0, 1.0, 1.0};  // exact to rounding
  const double bottom = math::cosh(2.0 * s) + 1.0 + 2.0 * s * s;
  // sinh 2s - 2s by its series where the difference would cancel.
  const double s2 = s * s;
  const double difference =
      s < 0.1 ? s * s2 * (4.0 / 3.0 + s2 * (4.0 / 15.0 + s2 * (8.0 / 315.0 + s2 * 4.0 / 2835.0))) : math::sinh(2.0 * s) - 2.0 * s;
  return {difference / bottom, (math::sinh(2.0 * s) + 2.0 * s) / bottom, math::tanh(s)};
}

std::unique_ptr<Influence> make_influence(const PadLayout& layout, const ElasticBody& body, double patch) {
  if (const std::optional<Grid> grid = grid_of(layout)) {
    if (std::max(grid->a, grid->b) > (1.0 + rounding) * body.thickness) {
      throw SceneValueError(
          "effects",
          fmt::format("elastic_skin: the cells are {} wide, more than the thickness of the layer, {}; use a smaller pitch",
                      readable_quantity(std::max(grid->a, grid->b), Quantity::length),
                      readable_quantity(body.thickness, Quantity::length)));
    }
    if (patch != 0.0) {
      throw SceneValueError(
          "effects",
          "elastic_skin: patch applies only to elements that are not on a regular grid; this sensor has a grid, so set patch to 0");
    }
    return std::make_unique<GridInfluence>(*grid, body);
  }
  constexpr std::size_t most = 1024;
  if (layout.elements.size() > most) {
    throw SceneValueError("effects", fmt::format("elastic_skin: {} elements that are not on a regular grid; allowed: up to {}",
                                                 layout.elements.size(), most));
  }
  if (std::isfinite(body.thickness)) {
    throw SceneValueError(
        "effects", "elastic_skin: a layer needs elements on a regular grid that all face the same way; set thickness to inf");
  }
  return std::make_unique<MeshInfluence>(layout, body, patch > 0.0 ? patch : mean_distance(layout));
}

}  // namespace slipbench
