// Declarations of a scene's own values, which belong to no catalogue entry: for scene_reader.cc.
#pragma once

#include "sim/core/parameters.h"

namespace slipbench {

// Limit of a coefficient and of its scale: far beyond any dry pair, so a likely typing error.
inline constexpr double max_friction = 100.0;

inline const ParameterSpec duration_spec =
    number_spec("duration", Quantity::time, "4 s", positive_up_to(86400.0), "Length of a trial.", "the published sequences");
inline const ParameterSpec time_step_spec =
    number_spec("time_step", Quantity::time, "1 ms", positive, "Step of the simulation.", "assumed");
inline const ParameterSpec fidelity_spec =
    choice_spec("fidelity", "field", {"field", "articulated", "mujoco_contact"}, "Model of the pad.", "assumed");
inline const ParameterSpec coefficient_spec =
    number_spec("coefficient", Quantity::none, "0.5", {0.0, max_friction}, "Friction coefficient.", "the material's");
inline const ParameterSpec scale_spec =
    number_spec("scale", Quantity::none, "1", positive_up_to(max_friction), "Factor on both coefficients.", "assumed");

inline const ParameterSpec gravity_spec = number_spec("gravity", Quantity::acceleration, "9.81 m/s2", {0.0, 1000.0},
                                                      "Acceleration of gravity, downwards.", "the Earth's");
inline const ParameterSpec field_solver_spec = choice_spec(
    "field_solver", "auto", {"auto", "explicit", "implicit"},
    "How the time step treats the pads' springs; auto: explicit, or in a grasp the cheaper of the two.", "set for each scene");
inline const ParameterSpec integrator_spec =
    choice_spec("integrator", "auto", {"auto", "Euler", "implicit", "implicitfast", "discrete", "RK4"},
                "Integrator of the bodies; auto: the one of the model or of the simulation.", "set for each scene");
inline const ParameterSpec damping_spec = number_spec("damping", Quantity::time, "1 ms", non_negative,
                                                      "Time constant of a dashpot in parallel with each spring.", "assumed");
inline const ParameterSpec ahead_spec =
    number_spec("ahead", Quantity::length, "0 mm", {0.0, 0.01}, "Offset of a sensor in front of the pad that it follows.",
                "set for each scene");
inline const ParameterSpec control_time_spec =
    number_spec("time", Quantity::time, "0 s", non_negative, "Time of a value of a control.", "set for each scene");

inline constexpr double mujoco_min_value = 1e-15;  // mjMINVAL

// The scene's key `contact`: MuJoCo's own contact between tips and touched geoms, with fidelity
// mujoco_contact. Names and defaults are MuJoCo's unless the source says otherwise; numbers are
// bare, as in MuJoCo. A value that MuJoCo would clip is refused.
inline const Entry contact_entry{
    .name = "contact",
    .summary = "MuJoCo's own contact friction, with fidelity: mujoco_contact.",
    .law = "",
    .source = "MuJoCo 4.0.1",
    .parameters = {
        choice_spec("integrator", "implicitfast", {"Euler", "implicit", "implicitfast", "discrete", "RK4"},
                    "Integrator of bodies and tips.", "what MuJoCo's documentation recommends; its default is Euler"),
        choice_spec("cone", "pyramidal", {"elliptic", "pyramidal"}, "Type of friction cone.", "MuJoCo"),
        choice_spec("solver", "Newton", {"Newton", "CG", "PGS"}, "Solver of the constraints.", "MuJoCo"),
        number_spec("impratio", Quantity::none, "1", {mujoco_min_value}, "Ratio of the frictional to the normal impedance.",
                    "MuJoCo"),
        integer_spec("noslip", "0", {0.0, 100000.0}, "Largest number of iterations of the noslip solver.", "MuJoCo"),
        integer_spec("iterations", "100", {1.0, 100000.0}, "Largest number of iterations of the solver.", "MuJoCo"),
        number_spec("tolerance", Quantity::none, "1e-8", non_negative, "Tolerance at which the solver stops.", "MuJoCo"),
        number_spec("noslip_tolerance", Quantity::none, "1e-6", non_negative, "Tolerance at which the noslip solver stops.",
                    "MuJoCo"),
        vector_spec(
            2, "solref", Quantity::none, "[0.02, 1]", any_value,
            "Time constant [s] and damping ratio of a contact, both above 0; or -stiffness [1/s2] and -damping [1/s], both below 0.",
            "MuJoCo"),
        vector_spec(2, "solreffriction", Quantity::none, "[0, 0]", any_value,
                    "The same for a tip's friction under elliptic cones; 0, 0: as solref.", "MuJoCo"),
        vector_spec(3, "solimp", Quantity::none, "[0.9, 0.95, 0.001]", non_negative,
                    "Impedance at the surface and at depth, 1e-4 to 0.9999 each, and that depth [m], above 0.", "MuJoCo"),
        flag_spec("refsafe", "true", "True: MuJoCo lengthens time constants below two steps.", "MuJoCo"),
        number_spec("tip_mass", Quantity::mass, "0.1 g", positive, "Mass of one element's tip.", "assumed"),
        number_spec("tip_damping", Quantity::none, "0.3", non_negative, "Damping ratio of a free tip on its springs.",
                    "assumed")}};

inline const Entry split_entry{"split",
                               "How a dataset's trials are divided into /mask/train, valid and test.",
                               "",
                               "set for each scene",
                               {choice_spec("by", "material", {"material", "object", "speed", "trial"},
                                            "Property whose values are not shared between the parts.", "set for each scene"),
                                vector_spec(3, "shares", Quantity::none, "[0.7, 0.15, 0.15]", fraction,
                                            "Shares of train, valid and test; they sum to 1.", "set for each scene")}};

inline const ParameterSpec hold_from_spec =
    number_spec("from", Quantity::time, "0 s", non_negative, "Time from which on the body must not move relative to `against`.",
                "set for each scene");
inline const ParameterSpec hold_within_spec =
    number_spec("within", Quantity::length, "10 mm", positive, "Largest motion with which the body still counts as held.",
                "10 mm: more than a finger's rolling and a skin's give, less than a fall");

inline const ParameterSpec confidence_spec =
    number_spec("confidence", Quantity::none, "0.95", {0.5, 0.999999},
                "Confidence level of the interval for the rate of trials that meet an expectation.", "set for each scene");
inline const ParameterSpec control_spec = choice_spec("control", "hold_preset", {"hold_preset", "none"},
                                                      "Controller that must not meet all expectations.", "set for each scene");

}  // namespace slipbench
