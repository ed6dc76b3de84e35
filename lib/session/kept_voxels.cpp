#include "lib/session/kept_voxels.h"

#include <utility>

#include "lib/session/fem_task.h"
#include "volumes/base/value.h"

namespace supple {

namespace {

/// Cosine of the widest angle between `facing` and the normal of a face.
constexpr double kFacingCosine = 0.5;

void add(const BrickMask& mask, ContentHash& hash) {
  hash.add_bytes(mask.data(), sizeof mask);
}

ContentHash hash_of(const BrickTopology& elements) {
  ContentHash hash;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for (int c = 0; c < 3; ++c) hash.add(elements.origin(b)[c]);
    add(elements.mask(b), hash);
  }
  return hash;
}

ContentHash hash_of(const LinkCuts& cuts) {
  ContentHash hash;
  for (std::size_t b = 0; b < cuts.brick_end(); ++b) {
    const LinkCuts::BrickCuts* const of_brick = cuts.brick(b);
    if (of_brick == nullptr) continue;
    hash.add(b);
    for (const BrickMask& mask : *of_brick) add(mask, hash);
  }
  return hash;
}

ContentHash hash_of(const RigidPieces& pieces) {
  ContentHash hash;
  for (const RigidPiece& piece : pieces.list) {
    hash.add(piece.elements->bricks().size());
    for (const SlotSet::Brick& brick : piece.elements->bricks()) {
      hash.add(brick.brick);
      add(brick.mask, hash);
    }
  }
  return hash;
}

}  // namespace

KeptVoxels::KeptVoxels(ResponseKey of, const FemStep& step, const FemTask& task, Progress* progress)
    : key(std::move(of)),
      solid(fem_solid(task.held.body, task.cuts, step.rigid_young_kpa, step.rigid_poisson)),
      model(task.held, solid.elastic, {}, step.params, solid.body ? &*solid.body : nullptr,
            step.halvings, progress) {}

std::size_t FemResponses::bytes_beyond(const FemResponses* other) const {
  if (other == nullptr) return known.bytes() + voxels->model.solid().bytes();
  const bool is_shared = other->voxels == voxels;
  return known.bytes_beyond(other->known) + (is_shared ? 0 : voxels->model.solid().bytes());
}

std::string why_no_sum(const FemParams& params) {
  if (params.strain == StrainTheory::finite) return "finite strain, which is not linear";
  if (params.solver != EquationSolver::multigrid) return "another program, which solves each step";
  if (params.doublings > 0) return "elements of several voxels";
  if (params.accuracy == FemAccuracy::picture) return "a picture";
  return {};
}

Value as_value(const ResponseReport& report) {
  Value value = {{"used", report.used}, {"solved", report.solved}};
  if (!report.changed.empty()) value["anew_for"] = report.changed;
  return value;
}

ResponseKey solid_key(const FemStep& step, const FemTask& task) {
  const Body& body = task.held.body;
  ContentHash material, kind;
  const ElasticTable elastic = material_elasticity(body.material);
  material.add_bytes(elastic.young_kpa.data(), sizeof elastic.young_kpa);
  material.add_bytes(elastic.poisson.data(), sizeof elastic.poisson);
  material.add(body.classes);
  material.add(step.rigid_young_kpa.value_or(0));
  material.add(step.rigid_poisson);
  kind.add(step.params.elements.dilatation);
  kind.add(step.params.elements.touching);
  kind.add(step.halvings);
  ResponseKey key;
  key.add("elements", hash_of(body.elements));
  key.add("cuts", hash_of(task.cuts));
  key.add("rigid pieces", hash_of(body.rigid));
  key.add("material", std::move(material));
  key.add("kinds of elements", std::move(kind));
  return key;
}

FemLoads loads_of(const FemStep& step, const FemTask& task, const FemSolid& solid) {
  FemLoads loads;
  loads.gravity_m_s2 = step.gravity_m_s2;
  loads.mass_density = solid.mass_density;
  for (const FemLoad& load : step.loads) {
    SlotSet elements =
        elements_of(load.part, task.held.body, task.density, task.labels, name_of(load.kind));
    if (load.kind == LoadKind::force) {
      loads.forces.push_back({std::move(elements), load.force_n});
    } else if (load.kind == LoadKind::swelling) {
      loads.inner_pressures.push_back({std::move(elements), load.pressure_kpa});
    } else {
      loads.face_pressures.push_back({std::move(elements), load.pressure_kpa, {}});
      if (!load.facing) continue;
      const Vec3d direction = *load.facing / load.facing->length();
      loads.face_pressures.back().includes = [direction](const Vec3d&, const Vec3d& normal) {
        return normal.dot(direction) >= kFacingCosine;
      };
    }
  }
  return loads;
}

}  // namespace supple
