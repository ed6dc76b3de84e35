#include "lib/model/fem_model.h"

#include "lib/fem/voxel/fem_results.h"
#include "lib/model/held_corners.h"
#include "lib/model/quasi_static.h"
#include "volumes/base/units.h"

namespace supple {

ElasticTable material_elasticity(const MaterialTable& material) {
  ElasticTable table;
  const MaterialClasses classes(material);
  for (int c = 0; c <= kLastClass; ++c) {
    table.young_kpa[std::size_t(c)] = classes.physics(c, c).stiffness_kpa;
    table.poisson[std::size_t(c)] = classes.poisson_of_class(c);
  }
  return table;
}

namespace {

std::shared_ptr<const RefinedShape> refined(const Body& body, int halvings) {
  if (halvings == 0) return nullptr;
  const std::int64_t count = body.elements.active_count() << 3 * halvings;
  if (count > kMostElements) {
    throw InputError({"", "refine",
                      std::to_string(count) + " elements, " + std::to_string(1 << 3 * halvings) +
                          " of each voxel",
                      "at most " + std::to_string(kMostElements)});
  }
  return std::make_shared<const RefinedShape>(body, halvings);
}

}  // namespace

VoxelFemModel::VoxelFemModel(const HeldBody& held, const ElasticTable& elastic, FemLoads loads,
                             const FemParams& params, const Body* shape, int halvings,
                             Progress* progress)
    : m_held(held),
      m_shape(shape),
      m_refined(refined(shape != nullptr ? *shape : held.body, halvings)),
      m_model(
          std::make_shared<FemModel>(VoxelFemModel::shape(), elastic, params.elements, progress)),
      m_params(params) {
  params.validate();
  set_loads(std::move(loads));
}

VoxelFemModel::VoxelFemModel(const HeldBody& held, const VoxelFemModel& of)
    : m_held(held),
      m_shape(of.m_shape),
      m_refined(of.m_refined),
      m_model(of.m_model),
      m_params(of.m_params) {}

void VoxelFemModel::set_loads(FemLoads loads) {
  m_loads = std::move(loads);
  if (!m_refined) return;
  const auto refine = [&](auto& list) {
    for (auto& load : list) {
      load.elements = m_refined->parts_of(load.elements, m_held.body.elements);
    }
  };
  refine(m_loads.forces);
  refine(m_loads.face_pressures);
  refine(m_loads.inner_pressures);
}

const Body& VoxelFemModel::shape() const {
  if (m_refined) return m_refined->body();
  return m_shape != nullptr ? *m_shape : m_held.body;
}

std::vector<std::vector<std::int32_t>> VoxelFemModel::parts() const {
  std::vector<std::vector<std::int32_t>> all;
  if (!m_refined) return all;
  const BrickTopology& elements = m_held.body.elements;
  for_each_element(elements, [&](Slot slot) {
    all.push_back(m_refined->parts_of(m_model->mesh(), voxel_of(elements, slot)));
  });
  return all;
}

HeldVoxels VoxelFemModel::find(const std::vector<Handle>& handles, const FixedElements& fixed,
                               Progress* progress) {
  HeldVoxels found = hold(m_held.body, handles, fixed, m_held.holds);
  m_grips = fem_grips(m_held.body, found, m_told);
  m_model->join_hinges(shape(), progress);
  const bool may_hinge = m_params.elements.touching == Touching::joined;
  do {
    hold_corners();
  } while (may_hinge &&
           m_model->part_hinges(shape(), held_bits(m_model->mesh(), m_loads.held), progress));
  return found;
}

const FemLoads& VoxelFemModel::loads_of(const std::vector<Handle>& handles, Progress* progress) {
  find(handles, fix(m_held.body, m_held.anchors), progress);
  return m_loads;
}

void VoxelFemModel::move(const std::vector<Handle>& handles, int, Progress* progress) {
  const FixedElements fixed = fix(m_held.body, m_held.anchors);
  HeldVoxels found = find(handles, fixed, progress);
  m_solution = m_known != nullptr ? m_model->solve_by(*m_known, m_loads, m_params, progress)
                                  : m_model->solve(m_loads, m_params, progress, m_start.get());
  m_solution.report.energy_mj -= false_energy_mj();
  found.rest.anchored.add(found.grabbed);
  m_held.holds = std::move(found.rest);
}

void VoxelFemModel::hold_corners() {
  const RefinedShape* const refined = m_refined.get();
  const VoxelCorners corners(m_model->mesh(), m_held.body, refined);
  const HeldCorners held(corners, m_grips, true);
  m_loads.held = held.elements();
  m_reaches = held.reaches();
  if (refined == nullptr) return;
  for (HeldElements& of_grip : m_loads.held) {
    of_grip.elements = refined->parts_of(of_grip.elements, m_held.body.elements);
  }
}

/// Energy of the rigid pieces that are held, as linear theory takes their turn for a strain.
double VoxelFemModel::false_energy_mj() const {
  if (m_params.strain == StrainTheory::finite || m_held.body.rigid.empty()) return 0;
  const HexMesh& mesh = m_model->mesh();
  const BrickTopology& elements = m_held.body.elements;
  double density_kpa = 0;
  const auto add = [&](std::int32_t element) {
    density_kpa +=
        element_state(mesh, m_model->material(), m_solution.u_mm, element).energy_density_kpa;
  };
  for (const FemGrip& grip : m_grips) {
    grip.slots.for_each([&](Slot slot) {
      if (m_held.body.rigid.at(slot) < 0) return;
      if (!m_refined) {
        add(element_at(mesh, slot / kBrickVoxels, int(slot % kBrickVoxels)));
        return;
      }
      for (const std::int32_t part : m_refined->parts_of(mesh, voxel_of(elements, slot))) add(part);
    });
  }
  return density_kpa * m_model->material().matrix.volume_mm3 * kMjPerUj;
}

ModelEnergy VoxelFemModel::energy() {
  return {m_solution.report.energy_mj * kJPerMj, 0, 0};
}

std::vector<Reaction> VoxelFemModel::reactions(const std::vector<Handle>& handles) {
  std::vector<Reaction> found;
  for (const FemReaction& reaction : reactions(elements_of_handles(m_held.body, handles))) {
    found.push_back({reaction.force_n});
  }
  return found;
}

std::vector<FemReaction> VoxelFemModel::reactions(const std::vector<SlotSet>& elements) const {
  return sums_over(elements, m_grips, m_solution.reactions);
}

FemReaction VoxelFemModel::anchor_reaction() const {
  for (std::size_t n = 0; n < m_grips.size(); ++n) {
    if (m_grips[n].is_anchor()) return m_solution.reactions[n];
  }
  return {};
}

std::vector<Vec3d> VoxelFemModel::centres_mm(const std::vector<double>& u_mm) const {
  if (!m_refined) return at_centres(m_model->mesh(), u_mm);
  std::vector<Vec3d> centres;
  const BrickTopology& elements = m_held.body.elements;
  for_each_element(elements, [&](Slot slot) {
    centres.push_back(m_refined->at_centre(m_model->mesh(), u_mm, voxel_of(elements, slot)));
  });
  return centres;
}

void VoxelFemModel::store() {
  if (m_solution.u_mm.empty()) return;
  give_to_body(centres_mm(m_solution.u_mm), {}, m_grips, true, m_held.body);
}

Fields solver_fields(FemParams& params) {
  return {
      Field("tolerance", params.tolerance, "Largest force left on a node, of the largest there is")
          .positive()
          .otherwise("none beside error_mm, else 1e-06, of pictures 0.1"),
      Field("reaction_tolerance", params.reaction_tolerance,
            "Largest change of the reactions in the last iteration, relative")
          .positive()
          .otherwise("0.02 beside error_mm, 0.001 where a scene writes forces; else 1e-05, of "
                     "pictures 0.1"),
      Field("error_mm", params.error_mm,
            "Largest estimated error of displacements that iterations leave (95th percentile)")
          .unit("mm")
          .positive()
          .otherwise(
              "none; of voxel a twentieth of the shortest edge, unless tolerance or stresses are "
              "asked for, or there are labels"),
      Field("max_iterations", params.max_iterations, "Of one linear system; more are an error")
          .range(1, 100000),
      Field("solver", params.solver, {"multigrid", "calculix", "calculix-iterative", "dolfinx"},
            "Own solver, or another program, which must be installed: ccx, Python's dolfinx"),
      Field("loose", params.loose, {"hold", "refuse"},
            "What nothing holds: stays where it is at rest, or is an error"),
  };
}

}  // namespace supple
