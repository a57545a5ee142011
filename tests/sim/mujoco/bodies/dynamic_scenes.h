// Base scenes for tests of the dynamic bench.
#pragma once

#include <string>

namespace slipbench {

inline constexpr double weight_of_100_g = 0.1 * 9.81;  // N

// Two fingers on sliders around x = 0, like scenes/bodies/two_fingers.xml; `options`: attributes of
// <option>.
inline std::string two_fingers(const std::string& options) {
  return "<mujoco><option " + options +
         "/><worldbody><body name='left_finger' pos='-0.01973 0 0.1'><joint name='left' type='slide' axis='1 0 0' damping='5'/><geom type='box' pos='-0.01 0 0' size='0.005 0.012 0.012' mass='0.05'/><site name='left_pad' zaxis='-1 0 0'/></body><body name='right_finger' pos='0.01973 0 0.1'><joint name='right' type='slide' axis='-1 0 0' damping='5'/><geom type='box' pos='0.01 0 0' size='0.005 0.012 0.012' mass='0.05'/><site name='right_pad' zaxis='1 0 0'/></body></worldbody><actuator><motor name='left' joint='left' ctrlrange='0 20'/><motor name='right' joint='right' ctrlrange='0 20'/></actuator></mujoco>";
}

// The fingers hold a box with 4 N; `more`: further lines of the scene.
inline std::string held_box(const std::string& more) {
  return "friction: {static: 0.5, kinetic: 0.5}\n"
         "model: fingers.xml\n"
         "bodies: {box: {shape: box, size: [40 mm, 40 mm, 60 mm], mass: 100 g, position: [0, 0, 0.1]}}\n"
         "sensors:\n"
         "  left: {type: papillarray, site: left_pad, touches: [box]}\n"
         "  right: {type: papillarray, site: right_pad, touches: [box]}\n" +
         more;
}

// A block of 1 kg on vertical and horizontal guides, with a pad under it on the plane z = 0.
// Gravity is the model's.
inline std::string guided_block(const std::string& options) {
  return "<mujoco><option " + options +
         "/><worldbody><body name='block'><joint name='height' type='slide' axis='0 0 1'/><joint name='travel' type='slide' axis='1 0 0'/><geom type='box' pos='0 0 0.01' size='0.02 0.02 0.01' mass='1'/><site name='sole'/></body></worldbody><actuator><motor name='push' joint='travel'/></actuator></mujoco>";
}

inline std::string block_on_table(const std::string& more) {
  return "model: block.xml\n"
         "bodies: {table: {shape: plane}}\n"
         "sensors: {sole: {type: papillarray, site: sole, touches: [table]}}\n" +
         more;
}

// The stage over a box of 20 mm on a table, both faces at z = 0.
inline std::string pressed_box(const std::string& more) {
  return "friction: {static: 0.6, kinetic: 0.6}\n"
         "bodies:\n"
         "  table: {shape: plane, position: [0, 0, -0.02], friction: 0.3}\n"
         "  box: {shape: box, size: [40 mm, 40 mm, 20 mm], mass: 100 g, position: [0, 0, -0.01], friction: 0.3}\n"
         "sensors: {pad: {type: papillarray, touches: [box]}}\n" +
         more;
}

}  // namespace slipbench
