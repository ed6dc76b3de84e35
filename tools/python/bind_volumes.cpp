// Grids, volumes and pictures in files.
#include "raycast/pictures/image.h"
#include "tools/python/attended.h"
#include "tools/python/bindings.h"
#include "tools/python/python_arrays.h"
#include "tools/python/python_values.h"
#include "tools/python/sent_through.h"
#include "volumes/field/centreline/straight_grid.h"
#include "volumes/io/filter/filters.h"
#include "volumes/io/filter/on_grid.h"
#include "volumes/io/format/dense_writer.h"

namespace py = pybind11;

namespace supple::python {

namespace {

ReadOptions read_options(const Value& keys) {
  ReadOptions options;
  read_keys(keys, fields(options));
  return options;
}

WriteOptions write_options(const Value& keys) {
  WriteOptions options;
  Fields all = fields(options);
  for (const Field& field : vector_fields(options)) all.push_back(field);
  read_keys(keys, all);
  return options;
}

/// Facts of a file beside its values.
Value facts_of(const VolumeHeader& header) {
  Value facts = {{"format", header.format},
                 {"type", numpy_name(header.type)},
                 {"modality", header.modality},
                 {"labels", Value::Entries()}};
  for (const auto& [number, name] : header.label_names) facts["labels"][name] = number;
  return facts;
}

std::unique_ptr<VolumeFile> volume_file_of(const std::string& path, const Value& keys,
                                           const py::object& callback) {
  return attended(callback, [&](Progress& progress) {
    return open_volume(path, read_options(keys), &progress);
  });
}

py::array read_volume(const std::string& path, const Value& keys, const py::object& callback) {
  return values_of(*volume_file_of(path, keys, callback), callback);
}

py::tuple open_header(const std::string& path, const Value& keys) {
  const auto file = volume_file_of(path, keys, py::none());
  return py::make_tuple(file->header().geometry, facts_of(file->header()));
}

/// Writes [k, j, i], or [k, j, i, 3] in mm LPS with their direction.
void write_array(const std::string& path, const py::array& given, const Geometry& grid,
                 const std::string& direction, const std::string& certificate, const Value& options,
                 const py::object& callback) {
  const py::array array = py::array::ensure(given, py::array::c_style);
  const bool is_warp = !direction.empty();
  DenseImage image;
  image.geometry = grid;
  image.type = type_of(array);
  image.components = is_warp ? 3 : 1;
  image.direction = direction;
  image.certificate = certificate;
  const Vec3i& dims = grid.dims();
  const bool fits = array.ndim() == (is_warp ? 4 : 3) && array.shape(0) == dims.z &&
                    array.shape(1) == dims.y && array.shape(2) == dims.x &&
                    (!is_warp || array.shape(3) == 3);
  if (!fits) throw InputError({path, "array", "one that does not fit its grid", "[k, j, i]"});
  const char* data = static_cast<const char*>(array.data());
  const std::size_t bytes = std::size_t(dims.x) * std::size_t(dims.y) *
                            std::size_t(image.components) * std::size_t(bytes_of(image.type));
  attend(callback, [&](Progress& progress) {
    progress.stage("writing");
    const auto writer = create_dense(path, image, write_options(options));
    for (int k = 0; k < dims.z; ++k) {
      writer->write_slice(data + std::size_t(k) * bytes);
      report(&progress, double(k + 1) / dims.z);
    }
    writer->complete(&progress);
    writer->commit();
    warn_of_all(path, writer->warnings(), &progress);
  });
}

ResampleKernel kernel_of(const std::string& name) {
  if (name == "linear") return ResampleKernel::linear;
  if (name == "nearest") return ResampleKernel::nearest;
  if (name == "cubic") return ResampleKernel::cubic;
  throw InputError(
      {"", "interpolation", "\"" + name + "\"", "\"linear\", \"nearest\" or \"cubic\""});
}

/// On a grid, or where there is none with this spacing.
py::tuple resample_file(const std::string& path, const Value& keys,
                        const std::optional<Geometry>& grid,
                        const std::optional<std::array<double, 3>>& spacing,
                        const std::string& interpolation, const py::object& callback) {
  const ResampleKernel kernel = kernel_of(interpolation);
  auto file = volume_file_of(path, keys, callback);
  if (grid) {
    file = attended(callback, [&](Progress& progress) {
      return on_grid(std::move(file), *grid, kernel, &progress);
    });
  } else {
    const auto& mm = spacing.value();
    file = with_spacing(std::move(file), Vec3d(mm[0], mm[1], mm[2]), kernel);
  }
  return py::make_tuple(values_of(*file, callback), grid.value_or(file->header().geometry));
}

/// Values, vectors, grid and report of `supple straighten`.
py::tuple straighten(const std::string& path, const Value& keys, const PointArray& along,
                     const Value& box_keys, const std::string& interpolation,
                     const py::object& callback) {
  Straightening box;
  read_keys(box_keys, fields(box));
  auto file = open_volume(path, read_options(keys));
  const Vec3d mm = file->header().geometry.spacing_mm();
  const StraightGrid straight(places_of(along), box, std::min({mm.x, mm.y, mm.z}));
  const VectorSliceSource slices = straight.slices();
  GridFolds folds(straight.grid());
  const py::array vectors = vectors_of(straight.grid(), counted(slices, folds), callback);
  const auto seen = attended(callback, [&](Progress& progress) {
    return on_grid(std::move(file), straight.grid(), slices, kernel_of(interpolation), &progress);
  });
  return py::make_tuple(values_of(*seen, callback), vectors, straight.grid(),
                        to_value(straight, folds));
}

/// The pixels of a file, rows from the top, which the array keeps without a copy.
py::array pixels_of(const std::string& path) {
  const Image image = read_png(path);
  return py::array_t<std::uint8_t>({image.height, image.width, 4}, image.rgba.data());
}

}  // namespace

void bind_volumes(py::module_& module) {
  py::class_<Geometry>(module, "Grid",
                       "Regular grid of voxels: shape (k, j, i) and a 4 x 4 affine that takes\n"
                       "(i, j, k, 1) to LPS millimetres (x left, y posterior, z superior).")
      .def(py::init(&make_grid), py::arg("shape"), py::arg("affine"))
      .def_property_readonly("shape", &shape_of, "Voxels along k, j and i, as arrays have them.")
      .def_property_readonly("affine", &affine_of, "4 x 4: (i, j, k, 1) to LPS mm.")
      .def_property_readonly(
          "spacing",
          [](const Geometry& grid) {
            const Vec3d mm = grid.spacing_mm();
            return py::make_tuple(mm.x, mm.y, mm.z);
          },
          "Millimetres between voxels along i, j and k.")
      .def("__eq__", [](const Geometry& a, const Geometry& b) { return a == b; })
      .def("__hash__", [](const Geometry& grid) { return py::hash(shape_of(grid)); })
      .def("__repr__", [](const Geometry& grid) {
        const Vec3d mm = grid.spacing_mm();
        return "Grid(shape=" + std::string(py::str(shape_of(grid))) + ", spacing=(" +
               number_text(mm.x) + ", " + number_text(mm.y) + ", " + number_text(mm.z) + ") mm)";
      });
  module.def("read_volume", &read_volume);
  module.def("open_header", &open_header);
  module.def("write_array", &write_array);
  module.def("resample", &resample_file);
  module.def("straighten", &straighten);
  module.def("pixels_of", &pixels_of);
}

}  // namespace supple::python
