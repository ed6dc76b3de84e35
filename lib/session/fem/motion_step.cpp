#include "lib/session/fem/motion_step.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "lib/body/node_offsets.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

MotionFrames::MotionFrames() : m_path(m_folder / "frames") {}

void MotionFrames::add(const std::vector<Vec3f>& displacement_mm) {
  std::ofstream file(m_path, std::ios::binary | std::ios::app);
  file.write(reinterpret_cast<const char*>(displacement_mm.data()),
             std::streamsize(displacement_mm.size() * sizeof(Vec3f)));
  file.close();
  if (!file) throw SystemError(m_path + ": cannot write frame " + std::to_string(m_count));
  m_elements = displacement_mm.size();
  ++m_count;
}

std::vector<Vec3f> MotionFrames::at(std::size_t frame) const {
  if (frame >= m_count) throw std::out_of_range("frame " + std::to_string(frame));
  std::vector<Vec3f> displacement_mm(m_elements);
  const std::size_t bytes = m_elements * sizeof(Vec3f);
  std::ifstream file(m_path, std::ios::binary);
  file.seekg(std::streamoff(frame * bytes));
  file.read(reinterpret_cast<char*>(displacement_mm.data()), std::streamsize(bytes));
  if (!file) throw SystemError(m_path + ": cannot read frame " + std::to_string(frame));
  return displacement_mm;
}

namespace {

constexpr double kDefaultSteps = 100;
/// A larger number of steps is taken for a mistake.
constexpr int kMostSteps = 1000000;
constexpr double kLongestRamp = 1e9;
/// Outside of these nothing but rounding is left of a step.
constexpr double kLeastTime_s = 1e-9, kMostTime_s = 1e6;

/// The elements of voxels in the mesh of a body.
std::vector<std::int32_t> elements_at(const std::vector<Vec3i>& voxels, const Body& body) {
  std::vector<std::int32_t> found;
  for (const Vec3i& voxel : voxels) {
    Slot wanted;
    if (!slot_of(body.elements, voxel, wanted)) {
      Vec3i nearest;
      const bool has_some = nearest_element(body, voxel, nearest);
      throw InputError(
          {"", "watch", "voxel " + voxel_text(voxel),
           "an element" + (has_some ? ", the nearest is " + voxel_text(nearest) : "")});
    }
    std::int32_t number = 0;
    for_each_element(body.elements, [&](Slot slot) { number += slot < wanted; });
    found.push_back(number);
  }
  return found;
}

double largest_length(const std::vector<double>& u_mm) {
  double most = 0;
  for (std::size_t n = 0; n < u_mm.size(); n += 3) {
    most = std::max(most, Vec3d(u_mm[n], u_mm[n + 1], u_mm[n + 2]).length());
  }
  return most;
}

std::vector<Vec3f> centres(const HexMesh& mesh, const std::vector<double>& u_mm) {
  std::vector<Vec3f> found;
  found.reserve(std::size_t(mesh.element_count()));
  for (std::int32_t e = 0; e < mesh.element_count(); ++e) {
    found.push_back(Vec3f(centre_displacement(mesh, u_mm, e)));
  }
  return found;
}

double stored_mj(const MotionEnergy& energy) {
  return energy.elastic_mj + energy.kinetic_mj;
}

double energy_error(const std::vector<MotionSample>& samples) {
  double off = 0, most = 0;
  for (const MotionSample& sample : samples) {
    const MotionEnergy& now = sample.energy;
    off = std::max(off, std::abs(stored_mj(now) + now.dissipated_mj - now.work_mj -
                                 stored_mj(samples.front().energy)));
    most = std::max(most, stored_mj(now) + now.dissipated_mj);
  }
  return most > 0 ? off / most : 0;
}

}  // namespace

int MotionStep::steps() const {
  const double wanted_s = step_s.value_or(time_s / kDefaultSteps);
  return int(std::clamp(std::ceil(time_s / wanted_s * (1 - 1e-9)), 1.0, double(kMostSteps)));
}

int MotionStep::ramp_steps() const {
  return int(std::lround(std::min(ramp_s.value_or(time_s) / step_length_s(), kLongestRamp)));
}

void MotionStep::validate() const {
  if (!step_s || time_s / *step_s <= kMostSteps) return;
  throw InputError({"", "step", number_text(*step_s) + " s for " + number_text(time_s) + " s",
                    "at most " + std::to_string(kMostSteps) + " steps"});
}

MotionRecord run_motion(const MotionStep& step, VoxelFemMotion& model, const Body& body,
                        const std::vector<Handle>& handles, const std::vector<SlotSet>& gripped,
                        Progress* progress) {
  const HexMesh& mesh = model.solid().mesh();
  const std::vector<std::int32_t> watched = elements_at(step.watch, body);
  MotionRecord record;
  record.steps = step.steps();
  record.step_s = step.step_length_s();
  record.watched = step.watch;
  model.move(handles, step.ramp_steps(), progress);
  auto frame_time = step.frame_times_s.begin();
  if (!step.frame_times_s.empty()) record.frames = std::make_shared<MotionFrames>();
  const auto take_sample = [&] {
    const std::vector<double>& u = model.motion().u_mm();
    MotionSample& sample = record.samples.emplace_back();
    sample.time_s = model.motion().time_s();
    sample.energy = model.motion().energy();
    sample.largest_mm = largest_length(u);
    const LargestMotion largest = largest_motion(mesh, model.solid().material(), u);
    record.largest.take(largest);
    for (const std::int32_t e : watched)
      sample.watched_mm.push_back(centre_displacement(mesh, u, e));
    for (const FemReaction& reaction : model.reactions(gripped)) {
      sample.reactions_n.push_back(reaction.force_n);
    }
    for (; frame_time != step.frame_times_s.end(); ++frame_time) {
      if (*frame_time > sample.time_s + record.step_s / 2) break;
      record.frames->add(centres(mesh, u));
    }
  };
  take_sample();
  stage(progress, "moving in time");
  for (int n = 0; n < record.steps; ++n) {
    report(progress, double(n) / record.steps);
    model.step(progress);
    take_sample();
  }
  for (; frame_time != step.frame_times_s.end(); ++frame_time) {
    record.frames->add(centres(mesh, model.motion().u_mm()));
  }
  record.energy_error = energy_error(record.samples);
  model.store();
  return record;
}

void take_frame(const MotionRecord& record, std::size_t frame, Body& body) {
  if (record.frames == nullptr) throw std::out_of_range("a motion without frames");
  const std::vector<Vec3f> displacement = record.frames->at(frame);
  NodeOffsets offsets(body);
  std::size_t element = 0;
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3d offset = body.geometry.index_vector_from_world(Vec3d(displacement[element++]));
    for (int c = 0; c < 3; ++c) {
      offsets.set_offset(c, slot, offset[c]);
      offsets.set_velocity(c, slot, 0);
    }
  });
  offsets.give(body);
}

std::string motion_csv(const MotionRecord& record, const std::vector<std::string>& handles) {
  std::string text = "time_s,elastic_mj,kinetic_mj,work_mj,dissipated_mj,largest_mm";
  const auto add_columns = [&](const std::string& name, const char* unit) {
    for (const char* axis : {"x", "y", "z"}) text += "," + name + "_" + axis + "_" + unit;
  };
  for (const Vec3i& voxel : record.watched) {
    add_columns("u_" + std::to_string(voxel.x) + "_" + std::to_string(voxel.y) + "_" +
                    std::to_string(voxel.z),
                "mm");
  }
  for (const std::string& handle : handles) add_columns("force_" + handle, "n");
  text += "\n";
  for (const MotionSample& sample : record.samples) {
    const MotionEnergy& energy = sample.energy;
    text += number_text(sample.time_s, 9);
    for (const double value : {energy.elastic_mj, energy.kinetic_mj, energy.work_mj,
                               energy.dissipated_mj, sample.largest_mm}) {
      text += "," + number_text(value, 9);
    }
    for (const auto* vectors : {&sample.watched_mm, &sample.reactions_n}) {
      for (const Vec3d& vector : *vectors) {
        for (int c = 0; c < 3; ++c) text += "," + number_text(vector[c], 9);
      }
    }
    text += "\n";
  }
  return text;
}

Fields fields(MotionStep& step) {
  Fields all = {
      Field("time", step.time_s, "Length of the motion")
          .unit("s")
          .required()
          .range(kLeastTime_s, kMostTime_s),
      Field("step", step.step_s, "Longest step of time")
          .unit("s")
          .range(kLeastTime_s, kMostTime_s)
          .otherwise("a hundredth of the time"),
      Field("ramp", step.ramp_s, "In which handles go their way, smoothly; 0: at once")
          .unit("s")
          .range(0, kMostTime_s)
          .otherwise("the whole time"),
      Field("mass_damping", step.mass_damping_per_s, "Rayleigh damping by the mass, α")
          .unit("1/s")
          .at_least(0)
          .recorded_as("mass_damping_per_s"),
  };
  for (Field& field : all) field.only_in_scenes();
  return all;
}

}  // namespace supple
