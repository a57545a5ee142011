#include "sim/mujoco/pads/geom_surface.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "sim/contact/surface/mesh_distance.h"
#include "sim/core/error.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {
namespace {

std::string type_name(int type) {
  switch (type) {
    case mj::hfield_geom: return "height field";
    case mj::sdf_geom: return "sdf";
    default: return "of type " + std::to_string(type);
  }
}

std::string name_of(ModelView model, int geom) {
  const char* name = model.name_of(mj::geom, geom);
  std::string text = name != nullptr ? "geom " + quote(name) : "geom " + std::to_string(geom) + " (without a name)";
  if (model.geom_type()[geom] != mj::mesh_geom) return text;
  const char* mesh = model.name_of(mj::mesh, model.geom_dataid()[geom]);
  return mesh != nullptr ? text + " of the mesh " + quote(mesh) : text;
}

// A compiled mesh and its data as bytes.
struct Mesh {
  const float* vertices;
  std::size_t vertex_count;
  const int* faces;
  std::size_t face_count;

  [[nodiscard]] std::string bytes() const {
    std::string result(3 * (vertex_count * sizeof(float) + face_count * sizeof(int)), '\0');
    std::memcpy(result.data(), vertices, 3 * vertex_count * sizeof(float));
    std::memcpy(result.data() + 3 * vertex_count * sizeof(float), faces, 3 * face_count * sizeof(int));
    return result;
  }

  [[nodiscard]] MeshDistance distance() const {
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < 3 * vertex_count; i += 3) points.emplace_back(vertices[i], vertices[i + 1], vertices[i + 2]);
    std::vector<MeshDistance::Face> corners;
    for (std::size_t i = 0; i < 3 * face_count; i += 3) {
      corners.push_back({static_cast<std::uint32_t>(faces[i]), static_cast<std::uint32_t>(faces[i + 1]),
                         static_cast<std::uint32_t>(faces[i + 2])});
    }
    return MeshDistance(points, corners);
  }
};

// A simulation makes its surfaces anew with every mjData; the grid, a second's work, is computed
// once.
DistanceGrid grid_of(const Mesh& mesh) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const DistanceGrid::Samples>> known;
  const std::lock_guard lock(mutex);
  std::erase_if(known, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<const DistanceGrid::Samples>& kept = known[mesh.bytes()];
  if (auto samples = kept.lock()) return DistanceGrid(std::move(samples));
  DistanceGrid grid = mesh.distance().on_grid(mesh_grid_nodes);
  kept = grid.samples();
  return grid;
}

// Number of sizes that a geom of this type has.
std::size_t size_count(int type) {
  switch (type) {
    case mj::sphere_geom: return 1;
    case mj::cylinder_geom:
    case mj::capsule_geom: return 2;
    case mj::box_geom:
    case mj::ellipsoid_geom: return 3;
    default: return 0;
  }
}

Surface surface_of(ModelView model, const ShapeValues& shape) {
  const auto& size = shape.size;
  for (std::size_t k = 0; k < size_count(shape.type); ++k) {
    if (!(size[k] > 0.0) || !std::isfinite(size[k])) {
      throw InputError(fmt::format("its size {} is {:.9g} m; expected a positive length", k, size[k]));
    }
  }
  switch (shape.type) {
    case mj::plane_geom: return Plane{};
    case mj::box_geom: return Box{{size[0], size[1], size[2]}};
    case mj::sphere_geom: return Sphere{size[0]};
    case mj::cylinder_geom: return Cylinder{size[0], size[1]};
    case mj::capsule_geom: return Capsule{size[0], size[1]};
    case mj::ellipsoid_geom: return Ellipsoid{{size[0], size[1], size[2]}};
    case mj::mesh_geom: {
      const int mesh = shape.mesh;
      return grid_of({model.mesh_vert() + 3 * model.mesh_vertadr()[mesh], static_cast<std::size_t>(model.mesh_vertnum()[mesh]),
                      model.mesh_face() + 3 * model.mesh_faceadr()[mesh], static_cast<std::size_t>(model.mesh_facenum()[mesh])});
    }
    default:
      throw InputError("it is " + type_name(shape.type) + "; allowed: plane, box, sphere, cylinder, capsule, ellipsoid, mesh");
  }
}

}  // namespace

ShapeValues shape_values(ModelView model, int geom) {
  const int type = model.geom_type()[geom];
  ShapeValues shape{type, type == mj::mesh_geom ? model.geom_dataid()[geom] : -1, {}};
  std::copy_n(model.geom_size() + 3 * static_cast<std::ptrdiff_t>(geom), size_count(type), shape.size.begin());
  return shape;
}

GeomSurface surface_of_geom(ModelView model, int geom) {
  if (geom < 0 || geom >= model.ngeom()) throw std::invalid_argument("geom " + std::to_string(geom) + " is not in the model");
  try {
    // MuJoCo's shapes have the same pose in their geom's frame as ours in theirs; the compiler has
    // transformed meshes accordingly.
    return {surface_of(model, shape_values(model, geom)), Pose{}};
  } catch (const InputError& error) {
    throw InputError(name_of(model, geom) + " cannot be touched by a pad: " + error.what());
  }
}

}  // namespace slipbench
