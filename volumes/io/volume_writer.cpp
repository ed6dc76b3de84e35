#include "volumes/io/volume_writer.h"

#include <cstring>
#include <stdexcept>

#include "volumes/base/parallel.h"
#include "volumes/io/bytes/value_type.h"

namespace supple {

namespace {

/// Does `work` beside the tasks of a group, which have ended when it returns or throws.
template <class Work>
void finishing(TaskGroup& tasks, const Work& work) {
  try {
    work();
  } catch (...) {
    tasks.wait();
    throw;
  }
  tasks.wait();
}

/// Writes slice after slice, each filled while the one before is written; `fill(k, out)` makes the
/// bytes of slice k. Returns the writer's warnings.
template <class Fill>
std::vector<std::string> write_image(const std::string& path, const DenseImage& image,
                                     const WriteOptions& options, const Fill& fill,
                                     Progress* progress) {
  if (progress != nullptr) progress->stage("writing");
  const std::unique_ptr<DenseWriter> writer = create_dense(path, image, options);
  const Vec3i& dims = image.geometry.dims();
  std::vector<char> slice(std::size_t(dims.x) * dims.y * image.components * bytes_of(image.type));
  std::vector<char> next(slice.size());
  fill(0, slice.data());
  for (int k = 0; k < dims.z; ++k) {
    TaskGroup ahead;
    if (k + 1 < dims.z) ahead.run([&] { fill(k + 1, next.data()); });
    finishing(ahead, [&] {
      writer->write_slice(slice.data());
      report(progress, double(k + 1) / dims.z);
    });
    slice.swap(next);
  }
  writer->complete(progress);
  writer->commit();
  return writer->warnings();
}

DenseImage image_of(const WarpFacts& facts) {
  DenseImage image;
  image.geometry = facts.geometry;
  image.components = 3;
  image.direction = facts.direction == WarpDirection::resample ? "resample" : "material";
  image.certificate = facts.certificate;
  return image;
}

}  // namespace

std::vector<std::string> write_volume(const std::string& path, const Geometry& geometry,
                                      ValueType type, const ScalarSliceSource& slices,
                                      Progress* progress, const WriteOptions& options) {
  std::vector<float> values(std::size_t(geometry.dims().x) * geometry.dims().y);
  const auto fill = [&](int k, char* out) {
    slices(k, values.data());
    store_values(type, values.data(), values.size(), out);
  };
  DenseImage image;
  image.geometry = geometry;
  image.type = type;
  return write_image(path, image, options, fill, progress);
}

std::vector<std::string> write_warp(const std::string& path, const WarpFacts& facts,
                                    const VectorSliceSource& slices, Progress* progress,
                                    const WriteOptions& options) {
  std::vector<Vec3f> vectors(std::size_t(facts.geometry.dims().x) * facts.geometry.dims().y);
  const auto fill = [&](int k, char* out) {
    slices(k, vectors.data());
    std::memcpy(out, vectors.data(), vectors.size() * sizeof(Vec3f));
  };
  return write_image(path, image_of(facts), options, fill, progress);
}

std::vector<std::string> write_warp(const std::string& path, const WarpFacts& facts,
                                    const VectorBricks& vectors_mm, Progress* progress,
                                    const WriteOptions& options) {
  if (progress != nullptr) progress->stage("writing");
  const std::unique_ptr<DenseWriter> writer = create_dense(path, image_of(facts), options);
  if (!writer->write_bricks(vectors_mm)) throw std::logic_error(path + ": a dense format");
  writer->complete(progress);
  writer->commit();
  return writer->warnings();
}

}  // namespace supple
