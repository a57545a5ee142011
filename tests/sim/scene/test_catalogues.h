// A small set of catalogues for tests of the parser, independent of the program's sensors, effects
// and motions.
#pragma once

#include "sim/scene/catalogues.h"
#include "sim/scene/materials.h"

namespace slipbench {

inline ParameterSpec spec(std::string name, ParameterType type, Quantity quantity, std::string default_text,
                          Range range = any_value, std::vector<std::string> choices = {}, std::size_t size = 1) {
  return {std::move(name), type, quantity, std::move(default_text), range, std::move(choices), size, {}, "doc", "assumed"};
}

// Names and defaults of the program's stage, PapillArray and plane; two effects and two parts of
// electronics for the lists; two detectors, one with a path.
inline Catalogues test_catalogues() {
  using enum ParameterType;
  Catalogues catalogues;
  catalogues.materials = material_table();
  catalogues.surfaces = {{"plane", "a plane", "", "", {}},
                         {"cylinder", "a cylinder", "", "", {spec("radius", number, Quantity::length, "50 mm", positive)}}};
  catalogues.motions = {
      {"stage",
       "a stage",
       "",
       "",
       {spec("compression", number, Quantity::length, "1 mm", positive),
        spec("gap", number, Quantity::length, "0.5 mm", non_negative),
        spec("approach_speed", number, Quantity::speed, "4 mm/s", positive),
        spec("start", number, Quantity::time, "2 s", non_negative),
        spec("speed", number, Quantity::speed, "4 mm/s", non_negative), spec("direction", number, Quantity::angle, "0 deg"),
        spec("rotation", number, Quantity::angular_speed, "0 deg/s"),
        spec("pivot", vector, Quantity::length, "[0 mm, 0 mm]", any_value, {}, 2),
        spec("tilt", vector, Quantity::angle, "[0 deg, 0 deg]", {-0.5, 0.5}, {}, 2),
        spec("acceleration", number, Quantity::acceleration, "50 mm/s2", positive_or_infinite),
        spec("angular_acceleration", number, Quantity::angular_acceleration, "500 deg/s2", positive_or_infinite),
        spec("stop", number, Quantity::time, "inf", positive), spec("reverse", number, Quantity::time, "inf", positive),
        spec("retract", number, Quantity::time, "inf", positive)}}};
  catalogues.sensors = {
      {"papillarray",
       "nine pillars",
       "",
       "",
       {spec("rate", number, Quantity::frequency, "1 kHz", positive), spec("bristles", integer, Quantity::none, "1", {1.0, 64.0}),
        spec("bristle_spread", number, Quantity::none, "0.4", fraction),
        spec("edge_drop", number, Quantity::length, "0.2 mm", non_negative),
        spec("corner_drop", number, Quantity::length, "0.45 mm", non_negative),
        spec("profile", choice, Quantity::none, "gripper", any_value, {"gripper", "hexapod"}),
        spec("bias", flag, Quantity::none, "true")}}};
  catalogues.electronics["papillarray"] = {
      {"noise", "noise", "", "", {spec("scale", number, Quantity::none, "1", non_negative)}},
      {"drift", "drift", "", "", {spec("slope", number, Quantity::force, "1 mN")}},
      {"low_pass", "low-pass", "", "", {}},
      {"coupling", "coupling", "", "", {spec("scale", number, Quantity::none, "1", non_negative)}},
      {"gain", "gain", "", "", {}},
      {"offset", "offset", "", "", {}},
      {"valid_range", "valid range", "", "", {}}};
  catalogues.effects = {{"ageing", "ageing", "", "", {spec("rate", number, Quantity::none, "0.03", non_negative)}},
                        {"stribeck", "stribeck", "", "", {spec("speed", number, Quantity::speed, "1 mm/s", positive)}}};
  catalogues.bodies = {
      {"box",
       "a box",
       "",
       "",
       {spec("size", vector, Quantity::length, "[40 mm, 40 mm, 60 mm]", positive, {}, 3),
        spec("mass", number, Quantity::mass, "100 g", positive),
        spec("position", vector, Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value, {}, 3),
        spec("free", flag, Quantity::none, "true"), spec("friction", number, Quantity::none, "0.5", {0.0, 100.0})}},
      {"plane",
       "a plane",
       "",
       "",
       {spec("position", vector, Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value, {}, 3),
        spec("friction", number, Quantity::none, "0.5", {0.0, 100.0})}}};
  catalogues.detectors = {{"ratio", "a threshold", "", "", {spec("threshold", number, Quantity::none, "0.4", positive)}},
                          {"trained", "a classifier", "", "", {spec("memories", path, Quantity::none, "own")}}};
  catalogues.expectations = {
      {{"gross_slip_by", "all slip", "", "", {spec("limit", number, Quantity::time, "1 s", non_negative)}}}};
  return catalogues;
}

}  // namespace slipbench
