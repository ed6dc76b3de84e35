#include "tools/lab/bench/elastic/fem_problems.h"

#include <algorithm>

#include "lib/body/slot_set.h"
#include "tools/lab/bench/bodies/ecm_bodies.h"

namespace supple::tools {

namespace {

constexpr double kStiffPoisson = 0.3;
/// Classes of noise (1 to 255) up to here are 30 % of it.
constexpr int kLastStiffNoise = 76;
constexpr int kSoft = 0, kStiff = 1;  // classes of a shell
constexpr double kBoneHu = 250;

HeldElements plate(const Body& body, const Vec3d& moved_mm, bool is_upper) {
  HeldElements held;
  const IndexBox& bounds = body.elements.active_bounds();
  IndexBox layer = bounds;
  (is_upper ? layer.lo.z : layer.hi.z) = is_upper ? bounds.hi.z : bounds.lo.z;
  held.elements = slots_in_box(body.elements, layer);
  // Voxels are 1 mm wide and the first one lies at 0.
  const double height = is_upper ? bounds.hi.z : bounds.lo.z;
  held.holds_node = [=](const Vec3d& rest_mm) {
    return is_upper ? rest_mm.z > height : rest_mm.z < height;
  };
  held.displacement_mm = [=](const Vec3d&) { return moved_mm; };
  return held;
}

/// Glued below and pulled above.
void pull_plates(FemProblem& problem, int size) {
  problem.loads.held.push_back(plate(problem.body, Vec3d(0.005 * size, 0, 0.01 * size), true));
  problem.loads.held.push_back(plate(problem.body, Vec3d(0.0), false));
}

Body block_of_one_class(int size) {
  Body body = block_body("noise", Vec3i(size));
  std::fill(body.classes.begin(), body.classes.end(), std::uint8_t(kSoft));
  return body;
}

void make_stiff(ElasticTable& elastic, int of, double contrast) {
  elastic.young_kpa[std::size_t(of)] *= contrast;
  elastic.poisson[std::size_t(of)] = kStiffPoisson;
}

FemProblem random_problem(const FemSubject& subject) {
  FemProblem problem{
      block_body("noise", Vec3i(subject.size)), ElasticTable::uniform(1, subject.poisson), {}};
  for (int of = 0; of <= kLastStiffNoise; ++of) make_stiff(problem.elastic, of, subject.contrast);
  pull_plates(problem, subject.size);
  return problem;
}

FemProblem shell_problem(const FemSubject& subject) {
  FemProblem problem{tissue_ball_body(subject.size), ElasticTable::uniform(1, subject.poisson), {}};
  Body& body = problem.body;
  const double radius = 0.5 * subject.size;
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3d from_middle =
        Vec3d(voxel_of(body.elements, slot)) - Vec3d((subject.size - 1) / 2.0);
    body.classes[slot] = std::uint8_t(from_middle.length() > 0.8 * radius ? kStiff : kSoft);
  });
  make_stiff(problem.elastic, kStiff, subject.contrast);
  problem.loads.held.push_back(plate(body, Vec3d(0.0), false));
  const int middle = subject.size / 2, half = std::max(1, subject.size / 16);
  problem.loads.forces.push_back(
      {slots_in_box(body.elements, {Vec3i(middle - half), Vec3i(middle + half - 1)}),
       {0, 1e-3, 0}});
  return problem;
}

FemProblem head_problem(const std::string& head) {
  FemProblem problem{ct_head_body(head), ElasticTable::uniform(6, 0.45), {}};
  const Body& body = problem.body;
  for (int of = body.material.class_of(kBoneHu); of <= kLastClass; ++of) {
    problem.elastic.young_kpa[std::size_t(of)] = 10e3;
    problem.elastic.poisson[std::size_t(of)] = kStiffPoisson;
  }
  const auto hold = [&](const Vec3i& wanted, const Vec3d& moved_mm) {
    Vec3i voxel;
    nearest_element(body, wanted, voxel);
    HeldElements& held = problem.loads.held.emplace_back();
    held.elements = slots_in_box(body.elements, {voxel, voxel});
    held.displacement_mm = [=](const Vec3d&) { return moved_mm; };
  };
  hold({128, 211, 12}, body.geometry.axes_mm()[1].normalized() * 2.0);
  hold({128, 33, 80}, Vec3d(0.0));  // bone, at the back of the skull
  return problem;
}

}  // namespace

FemProblem fem_problem(const FemSubject& subject, const std::string& head) {
  if (subject.field == "head") return head_problem(head);
  if (subject.field == "shell") return shell_problem(subject);
  if (subject.field == "random") return random_problem(subject);
  FemProblem problem{
      subject.field == "ball" ? tissue_ball_body(subject.size) : block_of_one_class(subject.size),
      ElasticTable::uniform(1, subject.poisson),
      {}};
  pull_plates(problem, subject.size);
  return problem;
}

}  // namespace supple::tools
