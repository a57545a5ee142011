// Closed triangle meshes of known shapes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace slipbench::oracle {

struct Mesh {
  std::vector<Eigen::Vector3d> vertices;            // m
  std::vector<std::array<std::uint32_t, 3>> faces;  // counter-clockwise from outside
};

// A box of two triangles per side. Vertex k has the signs of k's bits.
inline Mesh box_mesh(const Eigen::Vector3d& half) {
  Mesh mesh;
  for (unsigned k = 0; k < 8; ++k) {
    mesh.vertices.push_back(Eigen::Vector3d(k & 1U ? 1.0 : -1.0, k & 2U ? 1.0 : -1.0, k & 4U ? 1.0 : -1.0).cwiseProduct(half));
  }
  mesh.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// The mesh with separate corners for each face, each moved randomly by up to `rounding` [m] along
// each axis.
inline Mesh unwelded(const Mesh& mesh, double rounding) {
  Mesh loose;
  unsigned turn = 0;
  for (const auto& face : mesh.faces) {
    const auto first = static_cast<std::uint32_t>(loose.vertices.size());
    for (const std::uint32_t corner : face) {
      ++turn;
      loose.vertices.push_back(mesh.vertices[corner] +
                               rounding * Eigen::Vector3d(turn % 3 - 1.0, turn % 5 / 2.0 - 1.0, turn % 7 / 3.0 - 1.0));
    }
    loose.faces.push_back({first, first + 1, first + 2});
  }
  return loose;
}

// Combines two meshes, the second moved by `shift` [m].
inline Mesh both(Mesh a, const Mesh& b, const Eigen::Vector3d& shift) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  for (const Eigen::Vector3d& vertex : b.vertices) a.vertices.push_back(vertex + shift);
  for (const auto& [i, j, k] : b.faces) a.faces.push_back({first + i, first + j, first + k});
  return a;
}

// An L, extruded from y = -unit to y = unit: in x and z the square from -2 to 2 units without the
// quarter x > 0, z > 0.
inline Mesh l_mesh(double unit) {
  Mesh mesh;
  const std::array<std::pair<double, double>, 6> outline{{{-2, -2}, {2, -2}, {2, 0}, {0, 0}, {0, 2}, {-2, 2}}};
  for (const double y : {-1.0, 1.0}) {
    for (const auto& [x, z] : outline) mesh.vertices.push_back(unit * Eigen::Vector3d(x, y, z));
  }
  // Seen from y = -infinity, with x to the right and z up, the outline runs counter-clockwise.
  for (const auto& [a, b, c] : {std::array<std::uint32_t, 3>{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({6 + a, 6 + c, 6 + b});
  }
  for (std::uint32_t k = 0; k < 6; ++k) {
    const std::uint32_t next = (k + 1) % 6;
    mesh.faces.push_back({k, 6 + k, next});
    mesh.faces.push_back({next, 6 + k, 6 + next});
  }
  return mesh;
}

// A solid cylinder on the plane z = 0: `sides` facets around z, whose corners have the radius
// `radius`. With a wall it is a mug, open at the top: the hollow has the same corners, `wall` nearer
// to the axis, and the bottom is as thick as the wall.
inline Mesh can_mesh(double radius, double height, std::uint32_t sides, double wall = 0.0) {
  Mesh mesh;
  const auto add_ring = [&](double r, double z) {
    for (std::uint32_t k = 0; k < sides; ++k) {
      const double angle = 2.0 * M_PI * k / sides;
      mesh.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  };
  const bool hollow = wall > 0.0;
  add_ring(radius, 0.0);
  add_ring(radius, height);
  if (hollow) {
    add_ring(radius - wall, height);
    add_ring(radius - wall, wall);
  }
  const std::uint32_t rings = hollow ? 4 : 2, below = rings * sides, above = below + 1;
  mesh.vertices.emplace_back(0.0, 0.0, 0.0);
  mesh.vertices.emplace_back(0.0, 0.0, hollow ? wall : height);
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t next = (k + 1) % sides, last = (rings - 1) * sides;
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
      const std::uint32_t low = ring * sides, high = low + sides;
      mesh.faces.push_back({low + k, low + next, high + next});
      mesh.faces.push_back({low + k, high + next, high + k});
    }
    mesh.faces.push_back({below, next, k});
    mesh.faces.push_back({above, last + k, last + next});
  }
  return mesh;
}

// An icosahedron whose triangles are split into four `splits` times, with all vertices on the
// sphere.
inline Mesh ball_mesh(double radius, int splits) {
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  Mesh mesh;
  for (const auto& [x, y, z] : {std::array<double, 3>{-1, golden, 0},
                                {1, golden, 0},
                                {-1, -golden, 0},
                                {1, -golden, 0},
                                {0, -1, golden},
                                {0, 1, golden},
                                {0, -1, -golden},
                                {0, 1, -golden},
                                {golden, 0, -1},
                                {golden, 0, 1},
                                {-golden, 0, -1},
                                {-golden, 0, 1}}) {
    mesh.vertices.push_back(radius * Eigen::Vector3d(x, y, z).normalized());
  }
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int k = 0; k < splits; ++k) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(radius * (mesh.vertices[a] + mesh.vertices[b]).normalized());
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.faces) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.faces = std::move(finer);
  }
  return mesh;
}

}  // namespace slipbench::oracle
