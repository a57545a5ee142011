// Numpy arrays that own C++ values.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

namespace slipbench::python {

// An array of this shape, in C order. The product of `shape` must be the number of values.
template <class T>
nanobind::ndarray<nanobind::numpy, T> array_of(std::vector<T> values, const std::vector<std::size_t>& shape) {
  auto held = std::make_unique<std::vector<T>>(std::move(values));
  T* const first = held->data();
  const nanobind::capsule owner(held.release(), [](void* all) noexcept { delete static_cast<std::vector<T>*>(all); });
  return nanobind::ndarray<nanobind::numpy, T>(first, shape.size(), shape.data(), owner);
}

// A one-dimensional array.
template <class T>
nanobind::ndarray<nanobind::numpy, T> array_of(std::vector<T> values) {
  const std::size_t size = values.size();
  return array_of(std::move(values), {size});
}

}  // namespace slipbench::python
