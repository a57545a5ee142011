#include "sim/mujoco/articulated/pillar_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/mujoco/articulated/articulated.h"

namespace slipbench {
namespace {

// The state rule for a contact set by the user: see user_pillars().
constexpr double cone_share = 1e-6;
constexpr double least_speed = 1e-6;  // m/s
constexpr double creep_speed = 1e-3;  // m/s
constexpr double creep_time = 1e-2;   // s

constexpr double tip_radius = 1e-4;  // m, as in the recipe

// Time constants of the contact in which tips come to rest: e^-10. One counts for at least two
// steps, the least that MuJoCo calls safe: a faster contact overshoots, and comes to rest no
// sooner.
constexpr double settling_times = 10.0;
constexpr double least_time_constant = 2.0;  // steps
constexpr double most_settling_steps = 100'000.0;

// Returns the time constant of a contact with `solref` [s]: its own, or 2/b if given directly as
// [-k, -b].
double time_constant(const std::array<mjtNum, mjNREF>& solref) { return solref[0] > 0.0 ? solref[0] : -2.0 / solref[1]; }

}  // namespace

mjtIntegrator integrator_named(std::string_view name) {
  using Name = std::pair<std::string_view, mjtIntegrator>;
  for (const auto& [known, integrator] :
       {Name{"Euler", mjINT_EULER}, Name{"implicit", mjINT_IMPLICIT}, Name{"implicitfast", mjINT_IMPLICITFAST},
        Name{"discrete", mjINT_DISCRETE}, Name{"RK4", mjINT_RK4}}) {
    if (known == name) return integrator;
  }
  throw std::logic_error("unknown integrator " + std::string(name));
}

PillarSettings articulated_pillars(const ArticulatedSettings& recipe, double dt) {
  // A tiny excess over the longest step is rounding of a divided step.
  if (!(dt > 0.0 && dt <= recipe.longest_step * (1.0 + 1e-9))) {
    throw std::invalid_argument("the articulated recipe is valid for steps of at most " + format_number(recipe.longest_step) +
                                " s");
  }
  mjsPair usual;
  mjs_defaultPair(&usual);
  mjOption options;
  mj_defaultOption(&options);
  PillarSettings pillars;
  pillars.dt = dt;
  pillars.impratio = recipe.impratio;
  pillars.iterations = options.iterations;
  pillars.noslip_iterations = recipe.noslip_iterations;
  pillars.tolerance = pillars.noslip_tolerance = recipe.tolerance;
  pillars.tip_mass = recipe.tip_mass;
  pillars.tip_radius = recipe.tip_radius;
  pillars.damping_ratio = recipe.damping_ratio;
  pillars.solref = {-recipe.contact_stiffness / (dt * dt), -2.0 * std::sqrt(recipe.contact_stiffness) / dt};
  // A time constant, given directly: refsafe, which the rest of the model may need, would lengthen
  // one under 2 dt. Friction has no position, so the stiffness has no effect; its negative sign
  // marks direct values.
  pillars.solreffriction = {-1.0, -2.0 / (recipe.friction_time * dt)};
  pillars.solimp = std::to_array(usual.solimp);
  pillars.solimp[0] = pillars.solimp[1] = recipe.impedance;  // at any penetration
  pillars.contact_ratio = recipe.contact_stiffness / (1.0 - recipe.impedance);
  pillars.carrier_in_scale = true;
  pillars.settling_steps = recipe.settling_steps;
  pillars.cone_share = recipe.cone_share;
  pillars.least_speed = recipe.least_speed;
  return pillars;
}

PillarSettings user_pillars(const Parameters& contact, double dt) {
  mjsPair usual;
  mjs_defaultPair(&usual);
  PillarSettings pillars;
  pillars.dt = dt;
  pillars.integrator = integrator_named(contact.choice("integrator"));
  pillars.cone = contact.choice("cone") == "elliptic" ? mjCONE_ELLIPTIC : mjCONE_PYRAMIDAL;
  const std::string& solver = contact.choice("solver");
  pillars.solver = solver == "PGS" ? mjSOL_PGS : solver == "CG" ? mjSOL_CG : mjSOL_NEWTON;
  pillars.impratio = contact.number("impratio");
  pillars.iterations = static_cast<int>(contact.integer("iterations"));
  pillars.noslip_iterations = static_cast<int>(contact.integer("noslip"));
  pillars.tolerance = contact.number("tolerance");
  pillars.noslip_tolerance = contact.number("noslip_tolerance");
  pillars.refsafe = contact.flag("refsafe");
  pillars.tip_mass = contact.number("tip_mass");
  pillars.tip_radius = tip_radius;
  // MuJoCo accepts no moving body below this mass or inertia; the tip is a ball.
  const double least_mass = mjMINVAL / (0.4 * tip_radius * tip_radius);
  if (!(pillars.tip_mass > least_mass)) {
    throw SceneValueError("contact.tip_mass", format_quantity(pillars.tip_mass, Quantity::mass) +
                                                  " is too little for MuJoCo; allowed: more than " +
                                                  format_quantity(least_mass, Quantity::mass));
  }
  pillars.damping_ratio = contact.number("tip_damping");
  std::ranges::copy(contact.vector("solref"), pillars.solref.begin());
  std::ranges::copy(contact.vector("solreffriction"), pillars.solreffriction.begin());
  pillars.solimp = std::to_array(usual.solimp);
  std::ranges::copy(contact.vector("solimp"), pillars.solimp.begin());
  const double steps = settling_times * std::max(least_time_constant, time_constant(pillars.solref) / dt);
  // a tiny excess over a whole number is rounding of a divided step
  pillars.settling_steps = std::ceil(steps * (1.0 - 1e-9));
  pillars.cone_share = cone_share;
  pillars.least_speed = least_speed;
  pillars.creep_speed = creep_speed;
  pillars.creep_time = creep_time;
  pillars.counts_creep = true;
  return pillars;
}

PillarSettings pillars_of_scene(const Scene& scene, double dt) {
  return scene.contact ? user_pillars(*scene.contact, dt) : articulated_pillars(ArticulatedSettings{}, dt);
}

int steps_to_settle(const PillarSettings& settings, bool indented) {
  if (settings.settling_steps <= most_settling_steps) return static_cast<int>(settings.settling_steps);
  if (!indented) return 1;
  const double longest = most_settling_steps / settling_times * settings.dt;
  const auto [time, damping] = settings.solref;
  const bool direct = damping < 0.0;
  throw SceneValueError(
      "contact.solref",
      fmt::format(
          "with {} tips that start pressed in need {:.0f} steps of {} to come to rest before the run; allowed: up to {:.0f} steps; use {}, or longer steps",
          direct ? fmt::format("a damping of {} /s", format_number(-damping))
                 : "a time constant of " + format_quantity(time, Quantity::time),
          settings.settling_steps, format_quantity(settings.dt, Quantity::time), most_settling_steps,
          direct ? fmt::format("a damping of at least {} /s", format_number(2.0 / longest))
                 : "a time constant of at most " + format_quantity(longest, Quantity::time)));
}

void set_pillar_options(mjSpec* spec, const PillarSettings& settings) {
  mjOption usual;
  mj_defaultOption(&usual);
  mjOption& option = spec->option;
  option.iterations = settings.iterations;
  option.ls_iterations = usual.ls_iterations;
  option.ls_tolerance = usual.ls_tolerance;
  option.timestep = settings.dt;
  option.integrator = settings.integrator;
  option.cone = settings.cone;
  option.solver = settings.solver;
  option.impratio = settings.impratio;
  option.noslip_iterations = settings.noslip_iterations;
  option.tolerance = settings.tolerance;
  option.noslip_tolerance = settings.noslip_tolerance;
  option.disableflags |= mjDSBL_AUTORESET;
  if (!settings.refsafe) return;
  option.disableflags &= ~mjDSBL_REFSAFE;
  if (!*settings.refsafe) option.disableflags |= mjDSBL_REFSAFE;
}

double longest_articulated_step(const PadLayout& layout, std::span<const InverseMass> inverse_mass,
                                const ArticulatedSettings& recipe) {
  double longest = recipe.longest_step;
  for (std::size_t i = 0; i < layout.elements.size(); ++i) {
    const auto [most, least] = inverse_mass[i];
    const double r = recipe.contact_stiffness / (1.0 - recipe.impedance), k_n = layout.elements[i].k_normal;
    // Compliance of the contact by an inverse mass w: w dt^2/r (normal_slide()). Without one any
    // step will do.
    longest = std::min({longest, std::sqrt(recipe.compliance_share * r / (k_n * most)),
                        std::sqrt(recipe.force_share * r / (k_n * (most - least)))});
  }
  return longest;
}

}  // namespace slipbench
