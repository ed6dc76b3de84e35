#include "tools/scene/run/element_volumes.h"

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <vector>

#include "lib/session/fem/motion_step.h"
#include "volumes/base/csv.h"
#include "volumes/base/error.h"
#include "volumes/base/files.h"
#include "volumes/base/text.h"
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

/// Ways of handles in LPS mm so far, by their names: the sum over all steps that moved them.
class HandleWays {
 public:
  explicit HandleWays(const Geometry& geometry) : m_axes(geometry.direction()) {}

  /// `step`: its number, from 1.
  void add(const StepRecord& record, int step) {
    for (const HandleReaction& held : record.reactions) {
      if (held.step != step || std::size_t(held.handle) > record.drags.size()) continue;
      const Vec3d by = way_done(record, record.drags[std::size_t(held.handle - 1)].by_mm);
      Vec3d& way = m_ways.emplace(held.name, Vec3d(0)).first->second;
      way += m_axes[0] * by.x + m_axes[1] * by.y + m_axes[2] * by.z;
    }
  }
  Vec3d of(const std::string& name) const {
    const auto found = m_ways.find(name);
    return found == m_ways.end() ? Vec3d(0) : found->second;
  }

 private:
  std::array<Vec3d, 3> m_axes;
  std::map<std::string, Vec3d> m_ways;
};

std::string csv_vector(const Vec3d& v) {
  return "," + to_text(v);
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

void write_force_table(const std::string& path, const Session& session) {
  std::string text =
      "step,holder,name,way_x_mm,way_y_mm,way_z_mm,force_x_n,force_y_n,force_z_n,moment_x_nmm,"
      "moment_y_nmm,moment_z_nmm\n";
  HandleWays ways(session.geometry());
  int step = 0;
  for (const StepRecord& record : session.records()) {
    const std::string number = std::to_string(++step) + ",";
    ways.add(record, step);
    for (const HandleReaction& held : record.reactions) {
      text += number + "handle " + std::to_string(held.step) + "_" + std::to_string(held.handle) +
              "," + csv_field(held.name) + csv_vector(ways.of(held.name)) +
              csv_vector(held.reaction.force_n) +
              (held.moment_nmm ? csv_vector(*held.moment_nmm) : ",,,") + "\n";
    }
    const std::vector<Vec3d>& shapes = record.sprung.collider_forces_n;
    for (std::size_t n = 0; record.springs && n < shapes.size(); ++n) {
      text += number + "contact " + std::to_string(n + 1) + ",," +
              csv_vector(record.springs->motion.colliders[n].by_mm).substr(1) +
              csv_vector(shapes[n]) + ",,,\n";
    }
  }
  replace_text_file(path, text);
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
