#include "tools/scene/run/element_volumes.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "volumes/base/text_file.h"
#include "volumes/io/volume_writer.h"

namespace supple::tools {

namespace {

const ElementValues& last_values(const Session& session, FemQuantity quantity) {
  const std::vector<StepRecord>& records = session.records();
  for (auto record = records.rbegin(); record != records.rend(); ++record) {
    for (const ElementValues& values : record->equilibrium.values) {
      if (values.quantity == quantity) return values;
    }
  }
  throw std::logic_error("no step was asked for these values");
}

}  // namespace

void write_element_values(const std::string& path, const Geometry& geometry,
                          const BrickTopology& elements, const std::vector<float>& of_element,
                          Progress* progress) {
  std::vector<std::size_t> first;  // value of each brick
  std::size_t count = 0;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    first.push_back(count);
    count += std::size_t(mask_count(elements.mask(b)));
  }
  const std::size_t row = std::size_t(geometry.dims().x);
  const std::size_t slice = row * std::size_t(geometry.dims().y);
  const auto write_slice = [&](int k, float* out) {
    std::fill(out, out + slice, 0.0f);
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      const Vec3i& origin = elements.origin(b);
      if (k < origin.z || k >= origin.z + kBrickDim) continue;
      const float* value = &of_element[first[b]];
      for_each_active(elements.mask(b), [&](int offset) {
        const Vec3i voxel = origin + brick_local(offset);
        if (voxel.z == k) out[std::size_t(voxel.y) * row + std::size_t(voxel.x)] = *value;
        ++value;
      });
    }
  };
  for (const std::string& line :
       write_volume(path, geometry, ValueType::float32, write_slice, progress)) {
    warn(progress, line);
  }
}

void write_element_volume(const std::string& path, const Session& session, FemQuantity quantity,
                          Progress* progress) {
  const ElementValues& values = last_values(session, quantity);
  write_element_values(path, session.geometry(), values.elements, values.of_element, progress);
}

void write_motion_table(const std::string& path, const Session& session) {
  const std::vector<StepRecord>& records = session.records();
  const auto record = std::find_if(records.rbegin(), records.rend(), [](const StepRecord& one) {
    return one.equilibrium.motion.has_value();
  });
  if (record == records.rend()) throw std::logic_error("no motion for a table");
  std::vector<std::string> handles;
  for (const HandleReaction& reaction : record->reactions) {
    handles.push_back(std::to_string(reaction.step) + "_" + std::to_string(reaction.handle));
  }
  replace_text_file(path, motion_csv(*record->equilibrium.motion, handles));
}

}  // namespace supple::tools
