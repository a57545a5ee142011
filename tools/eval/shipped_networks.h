// The networks that slipbench contains.
#pragma once

#include <array>

namespace slipbench::eval {

struct ShippedNetwork {
  const char* name;    // "papillarray_slip"
  const char* path;    // of its file in the project
  const char* sensor;  // type of the sensor that it reads
  // A recording of the sensor with this channel is evaluated with the network first; null: with
  // another detector.
  const char* first_choice = nullptr;
};

inline constexpr std::array<ShippedNetwork, 15> shipped_networks{
    {{"papillarray_slip", "scenes/learn/papillarray_slip.onnx", "papillarray", "displacement"},
     {"papillarray_grasp", "scenes/learn/papillarray_grasp.onnx", "papillarray"},
     {"piezo_slip", "scenes/learn/piezo_slip.onnx", "piezo_skin", "signal"},
     {"piezo_grasp", "scenes/learn/piezo_grasp.onnx", "piezo_skin"},
     {"nib_slip", "scenes/learn/nib_slip.onnx", "nib_pad", "si"},
     {"nib_grasp", "scenes/learn/nib_grasp.onnx", "nib_pad"},
     {"biotac_slip", "scenes/learn/biotac_slip.onnx", "biotac_sp"},
     {"biotac_grasp", "scenes/learn/biotac_grasp.onnx", "biotac_sp"},
     {"taxels_slip", "scenes/learn/taxels_slip.onnx", "taxels"},
     {"taxels_grasp", "scenes/learn/taxels_grasp.onnx", "taxels"},
     {"magnetic_skin_slip", "scenes/learn/magnetic_skin_slip.onnx", "magnetic_skin", "field"},
     {"magnetic_skin_grasp", "scenes/learn/magnetic_skin_grasp.onnx", "magnetic_skin"},
     {"magnetic_skin_carried", "scenes/learn/magnetic_skin_carried.onnx", "magnetic_skin"},
     {"gel_slip", "scenes/learn/gel_slip.onnx", "gel_markers", "displacement"},
     {"gel_grasp", "scenes/learn/gel_grasp.onnx", "gel_markers"}}};

}  // namespace slipbench::eval
