// Scenes with bodies that move by forces, from text.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>
#include <unistd.h>

#include "sim/mujoco/bodies/dynamic_simulation.h"
#include "sim/mujoco/pads/register_plugin.h"
#include "tests/scenes.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {

inline void register_plugin_once() {
  [[maybe_unused]] static const bool registered = (register_bench_plugin({pad_catalogues(), &make_sensor}), true);
}

inline const BodyState& body_of(const Simulation& bench, const std::string& name) {
  return std::ranges::find(bench.bodies(), name, &NamedBody::name)->state;
}

// A temporary folder for model files.
class ModelFolder {
 public:
  ModelFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("slipbench_" + std::to_string(getpid()) + "_" + std::to_string(next()++))) {
    std::filesystem::create_directories(path_);
  }
  ~ModelFolder() { std::filesystem::remove_all(path_); }
  ModelFolder(const ModelFolder&) = delete;
  ModelFolder& operator=(const ModelFolder&) = delete;

  void write(const std::string& name, const std::string& text) const { std::ofstream(path_ / name) << text; }
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  static int& next() {
    static int count = 0;
    return count;
  }
  std::filesystem::path path_;
};

// A bench with its scene and sensors.
class DynamicRig {
 public:
  // `text`: a scene without its first line; `name`: path of the scene, for relative paths in
  // it; `layout`: replaces every sensor's own.
  explicit DynamicRig(const std::string& text, const std::string& name = "scene.yaml",
                      const DynamicSimulationOptions& options = {}, const PadLayout* layout = nullptr)
      : scene_(parsed(SceneFile::from_text("slipbench: 1\n" + text, name))) {
    register_plugin_once();
    std::vector<const PadLayout*> pads;
    std::vector<double> rates;
    for (const SensorScene& sensor : scene_.sensors) {
      sensors_.push_back(make_sensor(sensor, scene_.seed, 0));
      pads.push_back(layout != nullptr ? layout : &sensors_.back()->layout());
      rates.push_back(sensors_.back()->rate());
    }
    simulation_ = std::make_unique<DynamicSimulation>(scene_, pads, rates, 0, options);
  }

  DynamicSimulation* operator->() { return simulation_.get(); }
  DynamicSimulation& operator*() { return *simulation_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }

  // Steps until the tick at `time` [s] has been computed.
  void run_to(double time) {
    while (static_cast<double>(done_) * simulation_->time_step(0) <= time + 1e-9) {
      simulation_->step();
      ++done_;
    }
  }
  void run() {
    for (; done_ < simulation_->ticks(0); ++done_) simulation_->step();
  }

  [[nodiscard]] const BodyState& body(const std::string& name) const { return body_of(*simulation_, name); }

 private:
  Scene scene_;
  std::vector<std::unique_ptr<Sensor>> sensors_;
  std::unique_ptr<DynamicSimulation> simulation_;
  std::size_t done_ = 0;
};

}  // namespace slipbench
