#include "tools/base/hdf5/hdf5_place.h"

#include <algorithm>

namespace slipbench::hdf5 {
namespace {

// One serves all attributes: to make a type takes HDF5 as long as to write an attribute.
const Handle& text_type() {
  static const Handle made = [] {
    Handle type(H5Tcopy(H5T_C_S1), &H5Tclose);
    check(H5Tset_size(type.get(), H5T_VARIABLE));
    check(H5Tset_cset(type.get(), H5T_CSET_UTF8));
    return type;
  }();
  return made;
}

void write(hid_t object, const std::string& name, hid_t type, const std::vector<std::size_t>& shape, const void* values) {
  const Handle space = space_of(shape);
  Handle attribute(H5Acreate2(object, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT), &H5Aclose);
  check(H5Awrite(attribute.get(), type, values));
  attribute.close();
}

}  // namespace

Handle untimed(hid_t kind) {
  Handle properties(H5Pcreate(kind), &H5Pclose);
  check(H5Pset_obj_track_times(properties.get(), 0));
  return properties;
}

Handle space_of(const std::vector<std::size_t>& shape) {
  if (shape.empty()) return {H5Screate(H5S_SCALAR), &H5Sclose};
  const std::vector<hsize_t> extents(shape.begin(), shape.end());
  return {H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), &H5Sclose};
}

void write_attribute(hid_t object, const std::string& name, std::uint64_t value) {
  write(object, name, H5T_STD_U64LE, {}, &value);
}

void write_attribute(hid_t object, const std::string& name, std::int64_t value) {
  write(object, name, H5T_STD_I64LE, {}, &value);
}

void write_attribute(hid_t object, const std::string& name, double value) { write(object, name, H5T_IEEE_F64LE, {}, &value); }

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
  const char* text = value.c_str();
  write(object, name, text_type().get(), {}, &text);
}

void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& values) {
  std::vector<const char*> texts;
  for (const std::string& value : values) texts.push_back(value.c_str());
  write(object, name, text_type().get(), {values.size()}, texts.data());
}

void write_attribute(hid_t object, const std::string& name, const std::vector<double>& values,
                     const std::vector<std::size_t>& shape) {
  write(object, name, H5T_IEEE_F64LE, shape, values.data());
}

void write_texts(hid_t group, const char* name, const std::vector<std::string>& texts) {
  std::size_t width = 1;
  for (const std::string& text : texts) width = std::max(width, text.size());
  std::string padded;
  for (const std::string& text : texts) padded += text + std::string(width - text.size(), '\0');
  Handle type(H5Tcopy(H5T_C_S1), &H5Tclose);
  check(H5Tset_size(type.get(), width));
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD));
  const Handle space = space_of({texts.size()}), properties = untimed(H5P_DATASET_CREATE);
  Handle array(H5Dcreate2(group, name, type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), &H5Dclose);
  if (!texts.empty()) check(H5Dwrite(array.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()));
  array.close();
}

}  // namespace slipbench::hdf5
