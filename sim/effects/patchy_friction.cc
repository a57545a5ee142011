#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

using QuadBits __attribute__((vector_size(quad * sizeof(std::uint64_t)))) = std::uint64_t;

// A smooth random map g(x, y) with mean 0 and variance 1: random plane waves, tabulated once on a
// grid that repeats.
class RandomMap {
 public:
  RandomMap(double shortest, double longest, RandomStream stream) : cell_(shortest / cells_per_wave), table_(cells * cells) {
    // Whole numbers of waves fit into the repeated square, so that the map has no seam.
    const double side = cell_ * static_cast<double>(cells);
    // On the grid a wave's phase has only `cells` values: that of (row, column) is nx column + ny
    // row steps past the first.
    constexpr double step = 2.0 * std::numbers::pi / static_cast<double>(cells);
    struct Wave {
      std::size_t nx, ny;  // modulo cells
      std::array<double, cells> values;
    };
    const auto wrapped = [](double waves_on_a_side) {
      return static_cast<std::size_t>(waves_on_a_side < 0.0 ? waves_on_a_side + static_cast<double>(cells) : waves_on_a_side);
    };
    std::vector<Wave> drawn;
    while (drawn.size() < waves) {
      const double wavelength = stream.uniform(shortest, longest), angle = stream.uniform(0.0, 2.0 * std::numbers::pi);
      const double nx = std::round(side / wavelength * math::cos(angle)), ny = std::round(side / wavelength * math::sin(angle));
      const double phase = stream.uniform(0.0, 2.0 * std::numbers::pi);
      if (nx == 0.0 && ny == 0.0) continue;
      Wave& wave = drawn.emplace_back(Wave{wrapped(nx), wrapped(ny), {}});
      for (std::size_t k = 0; k < cells; ++k) wave.values[k] = math::cos(step * static_cast<double>(k) + phase);
    }
    const double amplitude = std::sqrt(2.0 / static_cast<double>(waves));
    for (std::size_t row = 0; row < cells; ++row) {
      for (std::size_t column = 0; column < cells; ++column) {
        double sum = 0.0;
        for (const Wave& wave : drawn) sum += wave.values[(wave.nx * column + wave.ny * row) % cells];
        table_[row * cells + column] = amplitude * sum;
      }
    }
  }

  // The map's period along either axis [m].
  [[nodiscard]] double period() const { return cell_ * static_cast<double>(cells); }

  // Bilinear interpolation between the grid's points.
  [[nodiscard, gnu::always_inline]] Quad at(const Quad& x, const Quad& y) const {
    const Quad u = x / cell_, v = y / cell_, column = floor_of(u), row = floor_of(v), du = u - column, dv = v - row;
    const QuadBits i = whole_of(column) % cells, j = whole_of(row) % cells * cells;
    const QuadBits i1 = (i + 1) % cells, j1 = (j + cells) % (cells * cells);
    Quad near, right, up, far;
    for (std::size_t k = 0; k < quad; ++k) {
      near[k] = table_[j[k] + i[k]], right[k] = table_[j[k] + i1[k]];
      up[k] = table_[j1[k] + i[k]], far[k] = table_[j1[k] + i1[k]];
    }
    return (1.0 - dv) * ((1.0 - du) * near + du * right) + dv * ((1.0 - du) * up + du * far);
  }

 private:
  // a power of two, which at() needs for negative coordinates
  static constexpr std::size_t cells = 128;
  static constexpr std::size_t waves = 24;
  static constexpr double cells_per_wave = 8.0;

  // Adding 1.5 2^52 rounds a double to a whole number in its last bits, a negative one in two's
  // complement. No surface has 2^51 cells.
  static constexpr double shift = 0x1.8p52;
  SLIPBENCH_INLINE static Quad floor_of(const Quad& value) {
    const Quad nearest = value + shift - shift;
    return nearest > value ? nearest - 1.0 : nearest;
  }
  SLIPBENCH_INLINE static QuadBits whole_of(const Quad& value) { return reinterpret_cast<QuadBits>(value + shift); }

  double cell_;  // m
  std::vector<double> table_;
};

// Each face of a box has its own two coordinates and its own offset in the repeating map; the top
// face has that of a plane. The offsets are no simple fractions of the period, so that no two faces
// use the same piece of the map.
SLIPBENCH_DISPATCHED void scale_all(const RandomMap& map, double sd, const ElementColumns& e, double* mu_s, double* mu_k) {
  for (std::size_t i = 0; i < e.count; i += quad) {
    const auto at = [i](const double* column) SLIPBENCH_INLINE_BODY { return vector_at<Quad>(column + i); };
    const auto pressed = at(e.normal_force) != 0.0;
    if (!any(pressed)) continue;
    const Quad x = at(e.x), y = at(e.y), z = at(e.z), nx = at(e.nx), ny = at(e.ny), nz = at(e.nz), none{};
    const auto on_x = nx * nx >= ny * ny, on_z = (nz * nz >= nx * nx) & (nz * nz >= ny * ny);
    const Quad beside = on_x ? (nx > 0.0 ? none + 2.0 : none + 3.0) : (ny > 0.0 ? none + 4.0 : none + 5.0);
    const Quad face = on_z ? (nz > 0.0 ? none : none + 1.0) : beside;
    const Quad u = (on_z | ~on_x ? x : y) + face * 0.3819660113 * map.period(), v = (on_z ? y : z) + face * 0.1459 * map.period();
    // The argument is below 512: a map's values are below 7, sd 2 at most.
    const Quad factor = pressed ? math::exp(sd * map.at(u, v) - 0.5 * sd * sd) : none + 1.0;
    put_vector(mu_s + i, at(mu_s) * factor);
    put_vector(mu_k + i, at(mu_k) * factor);
  }
}

class PatchyFriction final : public FrictionEffect {
 public:
  PatchyFriction(const Parameters& p, const EffectContext& context)
      : sd_(p.number("sd")), shortest_(p.number("shortest")), map_(map_of(shortest_, p.number("longest"), context)) {}

  void scale(const ElementColumns& elements, double* mu_s, double* mu_k) override { scale_all(*map_, sd_, elements, mu_s, mu_k); }

  [[nodiscard]] bool by_speed() const override { return false; }
  [[nodiscard]] double longest_step(double speed) const override { return step_per_wave(shortest_, speed); }

 private:
  // A trial makes its fields a dozen times: to get their size, to get their step, and to run. So a
  // thread keeps the map that it drew last.
  static std::shared_ptr<const RandomMap> map_of(double shortest, double longest, const EffectContext& context) {
    std::tuple key(context.seed, context.trial, shortest, longest);
    thread_local std::pair<decltype(key), std::shared_ptr<const RandomMap>> last;
    if (!last.second || last.first != key) {
      last = {key, std::make_shared<const RandomMap>(shortest, longest, context.stream("patchy_friction"))};
    }
    return last.second;
  }

  double sd_, shortest_;
  std::shared_ptr<const RandomMap> map_;
};

}  // namespace

EffectKind patchy_friction() {
  return {{"patchy_friction",
           "Friction varies over the surface in patches that are fixed to it.",
           "mu(x, y) = mu exp(sd g(x, y) - sd^2/2): the mean of mu is kept\n"
           "g: 24 random plane waves with wavelengths from `shortest` to `longest`, mean 0, variance 1\n"
           "x, y: coordinates along the touched face; each face of a box has its own g",
           "assumed: patches of 2 to 5 mm give a pad in slow slip the published energy below 8 Hz",
           {number_spec("sd", Quantity::none, "0.2", {0.0, 2.0}, "Standard deviation of ln mu.", "assumed"),
            number_spec("shortest", Quantity::length, "2 mm", positive, "Shortest wavelength.", "assumed"),
            number_spec("longest", Quantity::length, "5 mm", positive, "Longest wavelength, at most ten times `shortest`.",
                        "assumed")}},
          {Change::static_friction, Change::kinetic_friction},
          [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
            if (!context.flat_surface)
              throw SceneValueError("effects", "patchy_friction needs a flat surface; allowed shapes: plane, box");
            const double shortest = p.number("shortest"), longest = p.number("longest");
            if (longest < shortest || longest > 10.0 * shortest) {
              throw SceneValueError("effects", "the longest wavelength of patchy_friction is " +
                                                   format_quantity(longest, Quantity::length) + "; allowed: `shortest` (" +
                                                   format_quantity(shortest, Quantity::length) + ") to ten times `shortest`");
            }
            effects.friction.push_back(std::make_unique<PatchyFriction>(p, context));
          }};
}

}  // namespace slipbench
