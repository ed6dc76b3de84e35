#include "lib/session/tets/tet_results.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/mesh/tets/solid_quality.h"
#include "lib/session/step_warnings.h"
#include "lib/session/tet_record.h"
#include "volumes/base/text.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// The part of the voxels' volume by which that of a mesh may differ without a warning.
constexpr double kLargeDifference = 0.1;

void record_openings(const SolvedTets& in, TetRecord& record) {
  const std::vector<Vec3d>& at = in.model.volumes().positions();
  for (std::size_t n = 0; n < in.step.tets->openings.size(); ++n) {
    TetOpeningRecord& opening = record.openings.emplace_back();
    opening.name = in.step.tets->openings[n].name;
    opening.area_mm2 = in.model.area_of_faces(opening.name);
    if (in.shell) opening.free_area_mm2 = in.shell->openings[n].free_area_mm2;
    double out_mm3 = 0;
    for (const auto& face : in.model.parts_of_faces({opening.name})) {
      const auto area_at = [&](double part) {
        const auto x = [&](std::size_t c) {
          return at[std::size_t(face[c])] + displacement_of(in.solution, face[c]) * part;
        };
        return (x(1) - x(0)).cross(x(2) - x(0)) / 2;
      };
      const Vec3d rest = area_at(0);
      Vec3d way(0);
      for (const NodeIndex node : face) {
        way += displacement_of(in.solution, node) / 3;
        opening.bulge_mm =
            std::max(opening.bulge_mm, rest.normalized().dot(displacement_of(in.solution, node)));
      }
      // Simpson's rule is exact for what a triangle sweeps.
      out_mm3 += way.dot(rest + area_at(0.5) * 4 + area_at(1)) / 6;
    }
    opening.out_ml = out_mm3 * kMlPerMm3;
  }
}

/// Means over labels, values of voxels, and the mean pressure.
void record_elements(const SolvedTets& in, FemRecord& record, TetRecord& own) {
  const std::vector<ElementState> states = in.model.states(in.solution, in.loads);
  const Geometry& geometry = in.task.held.body.geometry;
  double volume = 0, turn = 0, strain = 0;
  for (std::size_t e = 0; e < states.size(); ++e) {
    const double mm3 = in.model.volumes().volume_mm3(e);
    own.mean_pressure_kpa += value_of(states[e], FemQuantity::pressure) * mm3;
    volume += mm3;
    const auto principal = eigenvalues(states[e].strain);
    const double stretch = std::max(std::abs(principal[0]), std::abs(principal[2]));
    if (states[e].rotation_rad.length() > turn) {
      turn = states[e].rotation_rad.length();
      record.report.turned = middle_voxel(in.mesh, e, geometry);
    }
    if (stretch > strain) {
      strain = stretch;
      record.report.strained = middle_voxel(in.mesh, e, geometry);
    }
  }
  own.mean_pressure_kpa /= volume;
  const BrickTopology& elements = in.task.held.body.elements;
  for (const FemQuantity quantity : in.step.wanted) {
    std::vector<float> values;
    for (const VoxelSite& site : in.tets.sites) {
      values.push_back(site.tet < 0 ? 0 : float(value_of(states[std::size_t(site.tet)], quantity)));
    }
    record.values.push_back({quantity, elements, std::move(values)});
  }
  if (in.task.labels.empty()) return;
  std::map<std::int32_t, StrainGauge> gauges;
  std::size_t element = 0;
  for_each_element(elements, [&](Slot slot) {
    const std::int32_t label = in.task.labels.at(slot), tet = in.tets.sites[element++].tet;
    if (label <= 0 || tet < 0) return;
    StrainGauge& gauge = gauges[label];
    gauge.label = label;
    ++gauge.elements;
    for (std::size_t n = 0; n < kFemQuantities.size(); ++n) {
      gauge.mean[n] += value_of(states[std::size_t(tet)], kFemQuantities[n].first);
    }
  });
  for (auto& [label, gauge] : gauges) {
    for (double& mean : gauge.mean) mean /= double(gauge.elements);
    record.gauges.push_back(gauge);
  }
}

}  // namespace

Vec3i middle_voxel(const SolidMesh& mesh, std::size_t tet, const Geometry& geometry) {
  Vec3d middle(0);
  for (const std::int32_t node : mesh.tets[tet]) {
    middle += mesh.nodes_lps_mm[std::size_t(node)] / 4;
  }
  return nearest_voxel(geometry.index_from_world(middle));
}

FemRecord record_of(const SolvedTets& solved) {
  FemRecord record;
  auto own = std::make_shared<TetRecord>();
  const SolidMesh& mesh = solved.mesh;
  own->tetrahedra = std::int64_t(mesh.tets.size());
  own->nodes = std::int64_t(mesh.nodes_lps_mm.size());
  own->outer_faces = std::int64_t(solved.tets.outer.size());
  const SolidQuality quality = quality_of(mesh);
  own->least_dihedral_deg = quality.least_dihedral_deg;
  own->largest_dihedral_deg = quality.largest_dihedral_deg;
  for (const auto& [region, mm3] : quality.volume_mm3) own->mesh_ml += mm3 * kMlPerMm3;
  own->voxels_ml = solved.tets.voxels_ml;
  own->unmeshed = solved.tets.unmeshed;
  own->far = solved.tets.far;
  own->shell = solved.shell;
  if (solved.step.tets->outside == TetOutside::held) {
    own->outside = solved.solution.reactions.back();
  }
  record.report = solved.solution.report;
  record.report.smallest_det_f = solved.solution.least_det_f;
  record.report.volume_change_ml =
      solved.model.volumes().displaced_volume_mm3(solved.solution.u_mm) * kMlPerMm3 - own->mesh_ml;
  record_openings(solved, *own);
  record_elements(solved, record, *own);
  record.tets = std::move(own);
  return record;
}

void warn_of_tets(const FemStep& step, const FemRecord& record, Progress* progress) {
  const TetRecord& own = *record.tets;
  const FemReport& report = record.report;
  if (own.unmeshed > 0) {
    warn(progress, "tetrahedra: " + with_count(own.unmeshed, "voxel") +
                       " in parts that the mesh leaves out, left at rest");
  }
  if (own.far > 0) {
    warn(progress, "tetrahedra: " + with_count(own.far, "voxel") + " more than " +
                       std::to_string(kNearRings) + " voxels from all of them, led by the nearest");
  }
  if (std::abs(own.mesh_ml - own.voxels_ml) > kLargeDifference * own.voxels_ml) {
    warn(progress, "tetrahedra: the mesh has " + number_text(own.mesh_ml) + " ml, the voxels " +
                       number_text(own.voxels_ml) + " ml");
  }
  if (report.loose_islands > 0) {
    warn(progress, "tetrahedra: nothing holds " + with_count(report.loose_islands, "island") +
                       " of " + std::to_string(report.loose_elements) +
                       " tetrahedra, left at rest");
  }
  if (report.smallest_det_f <= 0) {
    warn(progress, std::string("tetrahedra: ") +
                       (step.params.strain == StrainTheory::linear
                            ? "linear theory has turned some inside out"
                            : "some are inside out") +
                       ": least det F " + number_text(report.smallest_det_f));
  }
  if (report.beyond_linear) {
    warn(progress, "tetrahedra: turns of up to " + number_text(report.largest_rotation_deg) +
                       " degrees at voxel " + voxel_text(report.turned) + " and strains of up to " +
                       number_text(report.largest_strain) + " at voxel " +
                       voxel_text(report.strained) + " are beyond linear theory in " +
                       std::to_string(report.beyond_elements) + " tetrahedra");
  }
  warn_of_links(record.links, "tetrahedra", "a later drag or relaxation projects them", progress);
}

}  // namespace supple
