// ITK transform files: /TransformGroup/N/{TransformType, TransformFixedParameters,
// TransformParameters}, as itk::HDF5TransformIO writes them, of old ITK also "Tranform...".
//
// A CompositeTransform applies its LAST transform first: x -> T0(T1(... Tn(x))). With one
// displacement field D(p) = p + d(p) among linear maps this is y = B(D(A(x))), A being all behind
// the field and B all before it. On the grid A^-1(G), G being the field's, the vectors
// B(p + d(p)) - A^-1(p) say exactly that, between the voxels too, as all but d is affine.
// Outside the field's grid ITK goes on with d = 0, while a warp ends there.
//
// Memory: a slice of vectors, or as hdf5_slices.h. B-splines and other fields are refused.
#include "volumes/io/hdf5/plugin/itk_transform.h"

#include <cmath>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/hdf5/plugin/hdf5_slices.h"
#include "volumes/io/transform/linear_transform.h"

namespace supple {

namespace {

using hdf5::Dataset;
using hdf5::Hdf5File;

constexpr int kMaxTransforms = 64;
constexpr std::size_t kMaxParameters = 32;  // of a linear transform

/// The first name that exists; the second one is old ITK's misspelling.
std::string parameters_path(const Hdf5File& file, const std::string& group,
                            const std::string& name) {
  const std::string path = group + "/Transform" + name, misspelt = group + "/Tranform" + name;
  return !file.has(path) && file.has(misspelt) ? misspelt : path;
}

/// "DisplacementFieldTransform" of "DisplacementFieldTransform_double_3_3".
std::string transform_name(const Hdf5File& file, const std::string& group) {
  const std::string type = file.text(group + "/TransformType");
  const std::size_t at = type.find('_');
  const std::string suffix = at == std::string::npos ? "" : type.substr(at);
  if (suffix != "_double_3_3" && suffix != "_float_3_3") {
    file.fail(group + "/TransformType", printable(type), "a transform from 3 to 3 dimensions");
  }
  return type.substr(0, at);
}

bool is_field(const std::string& name) {
  return name == "DisplacementFieldTransform" ||
         name == "GaussianSmoothingOnUpdateDisplacementFieldTransform";
}

/// The field's group, and what is applied before and after it.
struct Chain {
  std::string field;
  bool is_composite = false;
  AffineMap before, after;
  bool is_plain = true;  // nothing is
};

void add_linear(const Hdf5File& file, const std::string& group, const std::string& name,
                Chain& chain) {
  const ItkTransform transform{
      file.shown(), group, name,
      file.numbers(parameters_path(file, group, "FixedParameters"), kMaxParameters),
      file.numbers(parameters_path(file, group, "Parameters"), kMaxParameters)};
  const AffineMap map = linear_map(transform);
  AffineMap& side = chain.field.empty() ? chain.after : chain.before;
  side = composed(side, map);
  chain.is_plain = false;
}

/// Names what it refuses before it reads numbers, of which B-splines have many.
void require_linear(const Hdf5File& file, const std::string& group, const std::string& name) {
  for (const char* known :
       {"IdentityTransform", "TranslationTransform", "AffineTransform", "MatrixOffsetTransformBase",
        "Euler3DTransform", "VersorRigid3DTransform", "Similarity3DTransform"}) {
    if (name == known) return;
  }
  linear_map({file.shown(), group, name, {}, {}});
}

Chain read_chain(const Hdf5File& file) {
  Chain chain;
  int count = 0;
  for (;; ++count) {
    const std::string group = "/TransformGroup/" + std::to_string(count);
    if (!file.has(group)) break;
    if (count == kMaxTransforms) file.fail("/TransformGroup", "more transforms", "at most 64");
    const std::string name = transform_name(file, group);
    if (count == 0 && name == "CompositeTransform") {
      chain.is_composite = true;
    } else if (is_field(name)) {
      if (!chain.field.empty()) file.fail(group, "a second displacement field", "one");
      chain.field = group;
    } else {
      require_linear(file, group, name);
      add_linear(file, group, name, chain);
    }
  }
  if (chain.field.empty()) {
    file.fail("/TransformGroup", "no displacement field", "a DisplacementFieldTransform");
  }
  if (count > 1 && !chain.is_composite) {
    file.fail("/TransformGroup", std::to_string(count) + " transforms without a CompositeTransform",
              "one transform, or a CompositeTransform first");
  }
  return chain;
}

/// Size, origin, spacing, direction row-major.
Geometry field_grid(const Hdf5File& file, const std::string& group) {
  const std::string path = parameters_path(file, group, "FixedParameters");
  const std::vector<double> fixed = file.numbers(path, 64);
  if (fixed.size() != 18) file.fail(path, std::to_string(fixed.size()) + " numbers", "18 numbers");
  std::vector<std::int64_t> sizes;
  std::array<Vec3d, 3> axes;
  for (std::size_t a = 0; a < 3; ++a) {
    const double size = fixed[a], spacing = fixed[6 + a];
    if (!(size >= 1 && size < 2147483648.0) || size != std::floor(size)) {
      file.fail(path, "size " + number_text(size), "whole numbers from 1 to 2147483647");
    }
    if (!(spacing > 0)) file.fail(path, "spacing " + number_text(spacing), "lengths above 0");
    sizes.push_back(std::int64_t(size));
    axes[a] = Vec3d(fixed[9 + a], fixed[12 + a], fixed[15 + a]) * spacing;
  }
  return make_geometry(file.shown(), {int(sizes[0]), int(sizes[1]), int(sizes[2])},
                       {fixed[3], fixed[4], fixed[5]}, axes);
}

class TransformVolume : public VolumeFile {
 public:
  TransformVolume(const std::shared_ptr<const Hdf5File>& file, const Chain& chain)
      : m_chain(chain) {
    m_field = field_grid(*file, chain.field);
    Dataset dataset = file->open_dataset(parameters_path(*file, chain.field, "Parameters"));
    m_stored = stored_type(*file, dataset);
    const Vec3i& dims = m_field.dims();
    m_slice = std::size_t(dims.x) * dims.y;
    hdf5::SliceSelection selection{{0}, dataset.dims, 0, 3 * m_slice, dims.z};
    m_slices = std::make_unique<hdf5::SliceReader>(file, std::move(dataset), m_stored,
                                                   std::move(selection));
    m_header.path = file->shown();
    m_header.format = "hdf5";
    m_header.type = chain.is_plain ? m_stored : ValueType::float64;
    m_header.components = 3;
    m_header.geometry = moved_grid();
    m_header.warp_direction = file->attribute_text(chain.field, "supple_direction").value_or("");
    m_header.certificate = file->attribute_text(chain.field, "supple_certificate").value_or("");
  }

  void read_slice(void* out) override {
    m_slices->read(out);
    if (!m_chain.is_plain) compose(static_cast<double*>(out));
    ++m_slices_read;
  }

 private:
  ValueType stored_type(const Hdf5File& file, const Dataset& dataset) const {
    std::string refused;
    const auto type = file.numeric_type(dataset, refused);
    if (!type || (*type != ValueType::float32 && *type != ValueType::float64)) {
      file.fail(dataset.path, type ? numpy_name(*type) : refused, "floats");
    }
    const double expected = 3.0 * double(m_field.voxel_count());
    if (dataset.dims.size() != 1 || double(dataset.dims[0]) != expected) {
      file.fail(dataset.path, "another count of numbers", number_text(expected) + " in one axis");
    }
    return m_chain.is_plain ? *type : ValueType::float64;
  }

  Geometry moved_grid() const {
    if (m_chain.is_plain) return m_field;
    std::array<Vec3d, 3> axes = m_field.axes_mm();
    for (Vec3d& axis : axes) axis = m_chain.before.index_vector_from_world(axis);
    return make_geometry(m_header.path, m_field.dims(),
                         m_chain.before.index_from_world(m_field.origin_lps_mm()), axes);
  }

  /// d becomes B(p + d) - A^-1(p).
  void compose(double* vectors) const {
    const Vec3i& dims = m_field.dims();
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i, vectors += 3) {
        const Vec3d index(i, j, m_slices_read), d(vectors[0], vectors[1], vectors[2]);
        const Vec3d y = m_chain.after.world_from_index(m_field.world_from_index(index) + d);
        const Vec3d offset = y - m_header.geometry.world_from_index(index);
        for (int c = 0; c < 3; ++c) vectors[c] = offset[c];
      }
    }
  }

  Chain m_chain;
  Geometry m_field;
  ValueType m_stored = ValueType::float64;  // as it is read
  std::size_t m_slice = 0;
  std::unique_ptr<hdf5::SliceReader> m_slices;
  int m_slices_read = 0;
};

}  // namespace

std::unique_ptr<VolumeFile> open_itk_transform(std::shared_ptr<const Hdf5File> file,
                                               const ReadOptions& options) {
  chosen_frame(options, 1, file->shown(), "frames");
  return std::make_unique<TransformVolume>(file, read_chain(*file));
}

}  // namespace supple
