// Blocks of arrays larger than memory. Boxes are pairs of (k, j, i), the second past the end.
#include "tools/python/bindings.h"
#include "tools/python/python_arrays.h"
#include "volumes/base/error.h"
#include "volumes/field/dense/block_warp.h"

namespace py = pybind11;

namespace supple::python {

namespace {

using Corner = std::array<int, 3>;
using BlockBox = std::pair<Corner, Corner>;

IndexBox to_index_box(const BlockBox& box) {
  const auto& [lo, hi] = box;
  return {Vec3i(lo[2], lo[1], lo[0]), Vec3i(hi[2], hi[1], hi[0]) - Vec3i(1)};
}

BlockBox to_box(const IndexBox& box) {
  if (box.empty()) return {};
  return {{box.lo.z, box.lo.y, box.lo.x}, {box.hi.z + 1, box.hi.y + 1, box.hi.x + 1}};
}

/// The box of an array whose first voxel is `first`.
IndexBox box_of(const py::array& array, const Corner& first, const char* name, int components) {
  if (array.ndim() != (components == 1 ? 3 : 4) ||
      (components != 1 && array.shape(3) != components)) {
    throw InputError({"", name, "an array of another shape",
                      components == 1 ? "[k, j, i]" : "[k, j, i, 3] in mm LPS"});
  }
  Corner end;
  py::ssize_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    end[a] = first[a] + int(array.shape(py::ssize_t(a)));
    count *= array.shape(py::ssize_t(a));
  }
  if (count > std::numeric_limits<std::int32_t>::max()) {
    throw InputError({"", name, std::to_string(count) + " voxels", "at most 2^31 in one block"});
  }
  return to_index_box({first, end});
}

BlockOf<Vec3f> vectors_in(const VectorArray& vectors, const Corner& first) {
  return {box_of(vectors, first, "field", 3), reinterpret_cast<const Vec3f*>(vectors.data())};
}

struct Blocks {
  BlockWarp warp;

  BlockBox nodes_of(const BlockBox& box) const { return to_box(warp.nodes_of(to_index_box(box))); }

  BlockBox voxels_of(const BlockBox& box, const VectorArray& vectors, const Corner& first) const {
    const BlockOf<Vec3f> nodes = vectors_in(vectors, first);
    const py::gil_scoped_release others_run;
    return to_box(warp.voxels_of(to_index_box(box), nodes));
  }

  template <class T>
  void resample_as(const BlockBox& box, const BlockOf<Vec3f>& vectors, const py::array& source,
                   const Corner& first, bool is_nearest, double fill, py::array& out) const {
    const py::array_t<T, py::array::c_style> values(source);
    const BlockOf<T> held = {box_of(values, first, "source", 1), values.data()};
    const IndexBox target = to_index_box(box);
    const bool fits = box_of(out, box.first, "out", 1) == target &&
                      py::isinstance<py::array_t<T, py::array::c_style>>(out);
    if (!fits) throw InputError({"", "out", "an array that does not fit", "that of the box"});
    T* const first_value = static_cast<T*>(out.mutable_data());
    const py::gil_scoped_release others_run;
    warp.resample(target, vectors, held, is_nearest, fill, first_value);
  }

  void resample(const BlockBox& box, const VectorArray& vectors, const Corner& first_node,
                const py::array& source, const Corner& first_voxel,
                const std::string& interpolation, double fill, py::array out) const {
    if (interpolation != "linear" && interpolation != "nearest") {
      throw InputError(
          {"", "interpolation", "\"" + interpolation + "\"", "\"linear\" or \"nearest\""});
    }
    const BlockOf<Vec3f> nodes = vectors_in(vectors, first_node);
    const auto as = [&](auto type) {
      resample_as<decltype(type)>(box, nodes, source, first_voxel, interpolation == "nearest", fill,
                                  out);
    };
    switch (type_of(source)) {
      case ValueType::int8:
        return as(std::int8_t());
      case ValueType::uint8:
        return as(std::uint8_t());
      case ValueType::int16:
        return as(std::int16_t());
      case ValueType::uint16:
        return as(std::uint16_t());
      case ValueType::int32:
        return as(std::int32_t());
      case ValueType::uint32:
        return as(std::uint32_t());
      case ValueType::int64:
        return as(std::int64_t());
      case ValueType::uint64:
        return as(std::uint64_t());
      case ValueType::float32:
        return as(float());
      default:
        return as(double());
    }
  }
};

}  // namespace

void bind_blocks(py::module_& module) {
  py::class_<Blocks>(module, "Blocks")
      .def(py::init(
          [](const Geometry& volume, const Geometry& target, const std::optional<Geometry>& field) {
            return Blocks{BlockWarp(volume, target, field)};
          }))
      .def("nodes_of", &Blocks::nodes_of)
      .def("voxels_of", &Blocks::voxels_of)
      .def("resample", &Blocks::resample);
}

}  // namespace supple::python
