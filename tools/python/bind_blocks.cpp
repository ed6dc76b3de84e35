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
  void resample(const BlockBox& box, const VectorArray& vectors, const Corner& first_node,
                const py::array_t<T, py::array::c_style>& source, const Corner& first_voxel,
                const std::string& interpolation, double fill,
                py::array_t<T, py::array::c_style>& out) const {
    if (interpolation != "linear" && interpolation != "nearest") {
      throw InputError(
          {"", "interpolation", "\"" + interpolation + "\"", "\"linear\" or \"nearest\""});
    }
    const BlockOf<Vec3f> nodes = vectors_in(vectors, first_node);
    const BlockOf<T> held = {box_of(source, first_voxel, "source", 1), source.data()};
    const IndexBox target = to_index_box(box);
    if (!(box_of(out, box.first, "out", 1) == target)) {
      throw InputError({"", "out", "an array that does not fit", "that of the box"});
    }
    T* const first_value = out.mutable_data();
    const py::gil_scoped_release others_run;
    warp.resample(target, nodes, held, interpolation == "nearest", fill, first_value);
  }
};

/// The type is that of `out`.
template <class... Types>
void bind_resample(py::class_<Blocks>& blocks) {
  using py::arg;
  (blocks.def("resample", &Blocks::resample<Types>, arg("box"), arg("vectors"), arg("first_node"),
              arg("source"), arg("first_voxel"), arg("interpolation"), arg("fill"),
              arg("out").noconvert()),
   ...);
}

}  // namespace

void bind_blocks(py::module_& module) {
  py::class_<Blocks> blocks(module, "Blocks");
  blocks
      .def(py::init(
          [](const Geometry& volume, const Geometry& target, const std::optional<Geometry>& field) {
            return Blocks{BlockWarp(volume, target, field)};
          }))
      .def("nodes_of", &Blocks::nodes_of)
      .def("voxels_of", &Blocks::voxels_of);
  bind_resample<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t, std::uint32_t,
                std::int64_t, std::uint64_t, float, double>(blocks);
}

}  // namespace supple::python
