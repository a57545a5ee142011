// The declarations of a scene's own values, those that belong to no entry of a catalogue: for scene_reader.cc.
#pragma once

#include "sim/core/parameters.h"

namespace slipbench {

// Of a coefficient and of its scale: far beyond any dry pair, so likely a slip of the pen.
inline constexpr double max_friction = 100.0;

inline const ParameterSpec duration_spec{.name = "duration",
                                         .quantity = Quantity::time,
                                         .default_text = "4 s",
                                         .range = {0.0, 86400.0, true},
                                         .choices = {},
                                         .doc = "length of a trial",
                                         .source = "the published sequences"};
inline const ParameterSpec time_step_spec{.name = "time_step",
                                          .quantity = Quantity::time,
                                          .default_text = "1 ms",
                                          .range = positive,
                                          .choices = {},
                                          .doc = "step of the simulation",
                                          .source = "assumed"};
inline const ParameterSpec fidelity_spec{.name = "fidelity",
                                         .type = ParameterType::choice,
                                         .default_text = "field",
                                         .choices = {"field", "articulated"},
                                         .doc = "model of the pad",
                                         .source = "assumed"};
inline const ParameterSpec coefficient_spec{.name = "coefficient",
                                            .default_text = "0.5",
                                            .range = {0.0, max_friction},
                                            .choices = {},
                                            .doc = "friction coefficient",
                                            .source = "the material's"};
inline const ParameterSpec scale_spec{.name = "scale",
                                      .default_text = "1",
                                      .range = {0.0, max_friction, true},
                                      .choices = {},
                                      .doc = "multiplies both coefficients",
                                      .source = "assumed"};

inline const ParameterSpec gravity_spec{.name = "gravity",
                                        .quantity = Quantity::acceleration,
                                        .default_text = "9.81 m/s2",
                                        .range = {0.0, 1000.0},
                                        .choices = {},
                                        .doc = "weight of a unit of mass, downwards",
                                        .source = "the Earth's"};
inline const ParameterSpec field_solver_spec{.name = "field_solver",
                                             .type = ParameterType::choice,
                                             .default_text = "explicit",
                                             .choices = {"explicit", "implicit"},
                                             .doc = "how the pads' springs enter a step",
                                             .source = "free"};
inline const ParameterSpec damping_spec{.name = "damping",
                                        .quantity = Quantity::time,
                                        .default_text = "1 ms",
                                        .range = non_negative,
                                        .choices = {},
                                        .doc = "time of a dashpot beside each spring",
                                        .source = "assumed"};
inline const ParameterSpec control_time_spec{.name = "time",
                                             .quantity = Quantity::time,
                                             .default_text = "0 s",
                                             .range = non_negative,
                                             .choices = {},
                                             .doc = "when a control has a value",
                                             .source = "free"};

inline const ParameterSpec confidence_spec{.name = "confidence",
                                           .default_text = "0.95",
                                           .range = {0.5, 0.999999},
                                           .choices = {},
                                           .doc = "of the interval of the rate of trials that keep an expectation",
                                           .source = "free"};
inline const ParameterSpec control_spec{.name = "control",
                                        .type = ParameterType::choice,
                                        .default_text = "hold_preset",
                                        .choices = {"hold_preset", "none"},
                                        .doc = "controller that must not meet all expectations",
                                        .source = "free"};

}  // namespace slipbench
