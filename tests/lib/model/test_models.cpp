// Models of one body exchanged while a scene runs: what passes from one to the next.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "lib/model/fem_model.h"
#include "lib/model/mesh_ecm_model.h"
#include "lib/model/relax_model.h"
#include "lib/model/spring_models.h"
#include "lib/model/voxel_ecm_model.h"
#include "tests/lib/mesh_fixtures.h"
#include "tests/lib/spring_fixtures.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Tissue of 10 kPa in which motion fades.
MaterialTable tissue() {
  MaterialTable table = linear_table(1.5, 0.6, 0.7);
  table.stiffness = Curve{{{0, 10}}};
  table.rayleigh_beta_ms = Curve{{{0, 0.05}}};
  return table;
}

Body block_of(const Vec3i& dims) {
  return body_of(full_block(dims, tissue(), [](int, int, int) { return 255.0; }));
}

/// A block whose one end is fixed, with what its models share.
struct Scene {
  explicit Scene(const Vec3i& dims)
      : body(block_of(dims)), anchors{Region({0, 0, 0}, {0, dims.y - 1, dims.z - 1})} {}
  HeldBody held() { return {body, anchors, holds}; }

  Body body;
  std::vector<Region> anchors;
  Holds holds;
};

MotionParams motion(SpringMethod method, double step_s) {
  MotionParams params;
  params.method = method;
  params.step_s = step_s;
  return params;
}

MotionParams minimum() {
  MotionParams params;
  params.minimise = true;
  return params;
}

RelaxParams relaxation(RelaxMethod method) {
  RelaxParams params;
  params.method = method;
  return params;
}

using VoxelModel = Model<Handle>;

/// One of every kind, in turn.
std::unique_ptr<VoxelModel> model_of(int kind, Scene& scene) {
  const LatticeSpringParams springs = material_springs(scene.body);
  switch (kind % 9) {
    case 0:
      return std::make_unique<VoxelSpringModel>(scene.held(), springs,
                                                motion(SpringMethod::implicit, 5e-3));
    case 1:
      return std::make_unique<RelaxModel>(scene.held(), relaxation(RelaxMethod::accelerated));
    case 2:
      return std::make_unique<VoxelSpringModel>(scene.held(), springs,
                                                motion(SpringMethod::xpbd, 5e-3));
    case 3:
      return std::make_unique<VoxelEcmModel>(scene.held());
    case 4:
      return std::make_unique<VoxelSpringModel>(scene.held(), springs,
                                                motion(SpringMethod::symplectic, 5e-3));
    case 5:
      return std::make_unique<RelaxModel>(scene.held(), relaxation(RelaxMethod::jacobi));
    case 6:
      return std::make_unique<VoxelSpringModel>(scene.held(), springs,
                                                motion(SpringMethod::projective, 5e-3));
    case 7:
      return std::make_unique<VoxelSpringModel>(scene.held(), springs, minimum());
    default:
      return std::make_unique<VoxelFemModel>(scene.held(), material_elasticity(tissue()));
  }
}

double offset_voxels(const Body& body, Slot slot, int c) {
  return body.q[std::size_t(c)].at(slot) / kFixedOne +
         body.fraction[std::size_t(c)].at(slot) / (kFixedOne * 65536);
}

/// Largest differences of offsets, voxels, and of velocities, mm/s.
struct Jump {
  double voxels = 0, mm_s = 0;
};
Jump between(const Body& a, const Body& b) {
  Jump jump;
  for_each_element(a.elements, [&](Slot slot) {
    for (int c = 0; c < 3; ++c) {
      jump.voxels =
          std::max(jump.voxels, std::abs(offset_voxels(a, slot, c) - offset_voxels(b, slot, c)));
      jump.mm_s = std::max(jump.mm_s, std::abs(a.velocity_mm_s[std::size_t(c)].at(slot) -
                                               b.velocity_mm_s[std::size_t(c)].at(slot)));
    }
  });
  return jump;
}

/// The state that a model has taken, seen through a body of its own.
Body seen_by(VoxelModel& model, const Scene& scene) {
  model.store();
  return scene.body;
}

}  // namespace

TEST(PropertyModels, ThousandStepsWithAnotherModelEveryTenNeitherJumpNorDrift) {
  LEFT_OUT_WHEN_SANITIZED();
  Scene scene({9, 5, 4});
  VoxelEcmModel(scene.held()).move({{{8, 2, 2}, {2 * kVoxel, kVoxel, 0}}}, 1, nullptr);
  Slot grabbed;
  ASSERT_TRUE(slot_of(scene.body.elements, {8, 2, 2}, grabbed));
  std::int32_t place = 2 * kVoxel;
  std::vector<Body> after_round;
  double fastest = 0, moved_by_steps = 0;
  int steps = 0;
  for (int n = 0; steps < 1000; ++n) {
    const Body before = scene.body;
    const std::unique_ptr<VoxelModel> model = model_of(n, scene);
    double projected = 0;
    // To and fro, by another model every time.
    const std::int32_t by = n % 3 == 0 ? kVoxel / 4 : n % 3 == 1 ? -kVoxel / 4 : 0;
    const std::vector<Handle> handles = {{{8, 2, 2}, {by, 0, 0}}};
    if (auto* ecm = dynamic_cast<VoxelEcmModel*>(model.get())) {
      ecm->move({}, 1, nullptr);
      projected = ecm->report().projected_max_voxels;
    } else if (auto* relaxed = dynamic_cast<RelaxModel*>(model.get())) {
      projected = relaxed->report().projected_max_voxels;
    }
    // The next model starts from the state that the last one left, but for the reported projection,
    // and the fractions of what that moved.
    const Jump jump = between(before, seen_by(*model, scene));
    EXPECT_LE(jump.voxels, projected + 0.51 / kVoxel) << n;
    EXPECT_EQ(jump.mm_s, 0) << n;

    const Body start = scene.body;
    model->move(handles, 10, nullptr);
    place += by;
    const double energy = model->energy().total_j();
    // XPBD comes to rest where its sweeps leave it, with more energy than the springs' own rest.
    steps += run_model(*model, 10);
    if (n % 9 != 2 && by == 0) {
      EXPECT_LE(model->energy().total_j(), energy * (1 + 1e-6) + 1e-15) << n;
    }
    moved_by_steps = std::max(moved_by_steps, between(start, scene.body).voxels);
    for (const auto& velocity : scene.body.velocity_mm_s) {
      for_each_element(scene.body.elements, [&](Slot slot) {
        fastest = std::max(fastest, std::abs(velocity.at(slot)));
      });
    }
    // Handle and anchors stay where they are to be, to the bit.
    EXPECT_EQ(scene.body.q[0].at(grabbed), place) << n;
    EXPECT_EQ(scene.body.q[1].at(grabbed), kVoxel) << n;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(scene.body.fraction[c].at(grabbed), 0);
      for (int j = 0; j < 5; ++j) EXPECT_EQ(scene.body.offset({0, j, 1}, int(c)), 0);
    }
    // Handle and models come round together every 9; by projective dynamics, in motion.
    if (n % 9 == 6) after_round.push_back(scene.body);
  }
  EXPECT_GT(moved_by_steps, 0.05);
  EXPECT_GT(fastest, 1);
  // Every round ends where the one before did.
  ASSERT_GE(after_round.size(), 4u);
  for (std::size_t n = 2; n < after_round.size(); ++n) {
    EXPECT_LT(between(after_round[n], after_round[1]).voxels, 1e-3) << n;
  }
}

TEST(PropertyModels, AMotionThatIsHandedOverEveryTenStepsIsThatOfOneModel) {
  LEFT_OUT_WHEN_SANITIZED();
  for (const SpringMethod method : {SpringMethod::symplectic, SpringMethod::implicit,
                                    SpringMethod::xpbd, SpringMethod::projective}) {
    Scene whole({7, 4, 3}), parts({7, 4, 3});
    for (Scene* scene : {&whole, &parts}) {
      VoxelEcmModel(scene->held()).move({{{6, 2, 1}, {kVoxel, kVoxel / 2, 0}}}, 1, nullptr);
      scene->holds = {};  // let go: it swings
    }
    const LatticeSpringParams springs = material_springs(whole.body);
    VoxelSpringModel model(whole.held(), springs, motion(method, 5e-4));
    run_model(model, 400);
    double travelled = 0;
    for (int n = 0; n < 40; ++n) {
      const Body before = parts.body;
      VoxelSpringModel part(parts.held(), springs, motion(method, 5e-4));
      run_model(part, 10);
      travelled += between(before, parts.body).voxels;
      // Another model in between looks at the body and does nothing.
      EXPECT_GE(VoxelEcmModel(parts.held()).energy().elastic_j, 0);
    }
    EXPECT_GT(travelled, 1.2) << name_of(method);
    const Jump drift = between(whole.body, parts.body);
    EXPECT_LT(drift.voxels, 1e-6) << name_of(method);
    EXPECT_LT(drift.mm_s, 1e-4) << name_of(method);
  }
}

TEST(PropertyModels, QuasiStaticModelsLeaveVelocitiesAlone) {
  Scene scene({7, 4, 3});
  VoxelEcmModel(scene.held()).move({{{6, 2, 1}, {kVoxel, 0, 0}}}, 1, nullptr);
  scene.holds = {};
  VoxelSpringModel springs(scene.held(), material_springs(scene.body),
                           motion(SpringMethod::implicit, 2e-3));
  run_model(springs, 10);
  const Velocities moving = scene.body.velocity_mm_s;
  EXPECT_FALSE(moving[0].empty());
  RelaxModel relaxed(scene.held(), relaxation(RelaxMethod::accelerated));
  run_model(relaxed, 10);
  VoxelEcmModel(scene.held()).move({{{6, 1, 1}, {0, kVoxel, 0}}}, 1, nullptr);
  EXPECT_TRUE(scene.body.velocity_mm_s == moving);
  VoxelSpringModel at_rest(scene.held(), material_springs(scene.body), minimum());
  run_model(at_rest, 500);
  EXPECT_TRUE(scene.body.velocity_mm_s[0].empty());
  EXPECT_EQ(scene.body.velocity_mm_s[0].bytes(), 0u);
}

TEST(PropertyModels, SpringsMoveHandlesEvenlyAndHoldThemAfterwards) {
  Scene scene({6, 4, 3});
  VoxelSpringModel model(scene.held(), material_springs(scene.body),
                         motion(SpringMethod::implicit, 1e-2));
  const std::vector<Handle> handles = {{{5, 2, 1}, {2 * kVoxel, -kVoxel, 33}}};
  model.move(handles, 8, nullptr);
  for (int n = 1; n <= 10; ++n) {
    model.step();
    model.store();
    const std::int32_t part = std::min(n, 8);
    EXPECT_EQ(scene.body.offset({5, 2, 1}, 0), 2 * kVoxel / 8 * part);
    EXPECT_EQ(scene.body.offset({5, 2, 1}, 1), -kVoxel / 8 * part);
  }
  EXPECT_EQ(scene.body.offset({5, 2, 1}, 2), 33);
  // The body follows, and pulls back against the drag.
  EXPECT_GT(scene.body.offset({3, 2, 1}, 0), kVoxel / 10);
  ASSERT_EQ(model.reactions(handles).size(), 1u);
  EXPECT_LT(model.reactions(handles)[0].force_n.x, 0);
  EXPECT_GT(model.reactions(handles)[0].force_n.y, 0);
  // What was grabbed is held by the next model, too.
  RelaxModel relaxed(scene.held(), relaxation(RelaxMethod::accelerated));
  run_model(relaxed, 20);
  EXPECT_EQ(scene.body.offset({5, 2, 1}, 0), 2 * kVoxel);
}

TEST(PropertyModels, ThePullOnAHandleIsThatOfTheSpringsInARow) {
  // 40 links of 10 kPa * 1 mm in a row, pulled by 4 mm: 1 N/m.
  Scene scene({41, 1, 1});
  RelaxModel relaxed(scene.held(), relaxation(RelaxMethod::accelerated));
  const std::vector<Handle> end = {{{40, 0, 0}, {4 * kVoxel, 0, 0}}};
  relaxed.move(end, 1, nullptr);
  run_model(relaxed, 2000);
  ASSERT_EQ(relaxed.reactions(end).size(), 1u);
  EXPECT_NEAR(relaxed.reactions(end)[0].force_n.x, -10.0 / 40 * 4 * 1e-3, 2e-7);
  // The springs of the lattice have 2/5 of that: k = 2/5 E h.
  VoxelSpringModel springs(scene.held(), material_springs(scene.body), minimum());
  run_model(springs, 500);
  EXPECT_NEAR(springs.reactions(end)[0].force_n.x, -0.4 * 10.0 / 40 * 4 * 1e-3, 1e-8);
}

TEST(PropertyModels, IntegratorsAtRestPullAsTheMinimumDoesButXpbdPullsFarLess) {
  LEFT_OUT_WHEN_SANITIZED();
  const std::vector<Handle> end = {{{13, 2, 2}, {kVoxel, 0, 0}}};
  const auto pull = [&](const MotionParams& params, int steps) {
    Scene scene({14, 4, 4});
    LatticeSpringParams springs = material_springs(scene.body);
    springs.mass_damping_per_s = 100;
    VoxelSpringModel model(scene.held(), springs, params);
    EXPECT_EQ(model.reactions(end)[0].force_n, Vec3d(0.0));
    model.move(end, 20, nullptr);
    run_model(model, steps);
    return model.reactions(end)[0].force_n.x;
  };
  const double rest = pull(minimum(), 500);
  EXPECT_LT(rest, -1e-3);
  EXPECT_NEAR(pull(motion(SpringMethod::implicit, 1e-2), 200), rest, 1e-3 * -rest);
  EXPECT_NEAR(pull(motion(SpringMethod::projective, 1e-2), 200), rest, 1e-2 * -rest);
  EXPECT_NEAR(pull(motion(SpringMethod::symplectic, 1e-2), 100), rest, 1e-2 * -rest);
  EXPECT_NEAR(pull(motion(SpringMethod::xpbd, 1e-2), 100), rest, 2e-2 * -rest);
}

TEST(PropertyModels, TheSupportOfABodyAtRestCarriesItsWeight) {
  const Vec3i dims(6, 3, 3);
  const std::vector<Handle> support = {{Region({0, 0, 0}, {0, 2, 2}), {0, 0, 0}}};
  for (const int kind : {0, 1, 2, 3}) {
    Scene scene(dims);
    const double weight_n =
        1000 * 9.81e-9 * std::abs(scene.body.geometry.determinant()) * dims.x * dims.y * dims.z;
    MotionParams params = kind == 0   ? minimum()
                          : kind == 1 ? motion(SpringMethod::implicit, 1e-2)
                          : kind == 2 ? motion(SpringMethod::projective, 1e-2)
                                      : motion(SpringMethod::symplectic, 1e-2);
    params.gravity_m_s2 = {0, 0, -9.81};
    params.tolerance_mn = 1e-6;
    LatticeSpringParams springs = material_springs(scene.body);
    springs.mass_damping_per_s = 50;
    VoxelSpringModel model(scene.held(), springs, params);
    model.move({}, 1, nullptr);
    run_model(model, 300);
    const Vec3d force = model.reactions(support)[0].force_n;
    EXPECT_NEAR(force.z, -weight_n, 1e-3 * weight_n) << kind;
    EXPECT_NEAR(std::hypot(force.x, force.y), 0, 1e-3 * weight_n) << kind;
  }
}

TEST(PropertyModels, SpringsRestWherePlasticFlowLeftTheLinks) {
  MaterialTable table = tissue();
  table.yield_strain = Curve{{{0, 0.1}}};
  Scene scene({12, 3, 3});
  scene.body = body_of(full_block({12, 3, 3}, table, [](int, int, int) { return 255.0; }));
  {
    RelaxModel relaxed(scene.held(), relaxation(RelaxMethod::accelerated));
    relaxed.move({{{11, 1, 1}, {4 * kVoxel, 0, 0}}}, 1, nullptr);
    relaxed.store();
    EXPECT_TRUE(scene.body.rest[0][0].empty());  // a drag alone is no load step
    run_model(relaxed, 500);
    EXPECT_GT(relaxed.report().yielded_links, 5);
  }
  scene.holds = {};
  Scene with_springs({12, 3, 3});
  with_springs.body = scene.body;
  RelaxModel relaxed(scene.held(), relaxation(RelaxMethod::accelerated));
  run_model(relaxed, 2000);
  const double set = scene.body.offset({11, 1, 1}, 0) / kFixedOne;
  EXPECT_GT(set, 0.5);
  VoxelSpringModel springs(with_springs.held(), material_springs(with_springs.body), minimum());
  run_model(springs, 500);
  EXPECT_NEAR(with_springs.body.offset({11, 1, 1}, 0) / kFixedOne, set, 0.1 * set);
}

TEST(PropertyModels, AMoveThatFailsMovesNothing) {
  for (const int kind : {0, 1, 3, 7, 8}) {
    Scene scene({9, 4, 3});
    VoxelEcmModel(scene.held()).move({{{8, 2, 1}, {3 * kVoxel, kVoxel, 0}}}, 1, nullptr);
    const Body before = scene.body;
    const std::unique_ptr<VoxelModel> model = model_of(kind, scene);
    EXPECT_NE(input_error([&] { model->move({{{90, 0, 0}, {1, 0, 0}}}, 1, nullptr); }), "");
    EXPECT_NE(input_error([&] { model->move({{{0, 1, 1}, {1, 0, 0}}}, 1, nullptr); }), "");
    model->store();
    EXPECT_EQ(scene.body.q, before.q) << kind;
    EXPECT_EQ(scene.holds.anchored.size(), 1u) << kind;
  }
}

TEST(PropertyModels, InterruptedModelsHaveStoredWhatTheyDid) {
  class StopAfter final : public Progress {
   public:
    explicit StopAfter(int steps) : m_left(steps) {}
    void stage(std::string_view) override {}
    void update(double) override { --m_left; }
    bool cancelled() const override { return m_left <= 0; }

   private:
    int m_left;
  };
  for (const int kind : {0, 1, 2, 4, 5, 6, 7}) {
    Scene whole({9, 4, 3}), stopped({9, 4, 3});
    for (Scene* scene : {&whole, &stopped}) {
      VoxelEcmModel(scene->held()).move({{{8, 2, 1}, {3 * kVoxel, kVoxel, 0}}}, 1, nullptr);
    }
    const int steps = kind == 7 ? 2 : 7;
    StopAfter asked(steps);
    // Springs stop within a step and leave the one before; passes of relaxation are short.
    const bool is_relaxation = kind == 1 || kind == 5;
    run_model(*model_of(kind, whole), is_relaxation ? steps : steps - 1);
    EXPECT_THROW(run_model(*model_of(kind, stopped), 100, &asked), Cancelled) << kind;
    EXPECT_EQ(stopped.body.q, whole.body.q) << kind;
    EXPECT_TRUE(stopped.body.velocity_mm_s == whole.body.velocity_mm_s) << kind;
  }
}

TEST(PropertyModels, SpringsRefuseHandlesThatOnlyPush) {
  Scene scene({5, 3, 3});
  const LatticeSpringParams springs = material_springs(scene.body);
  const std::vector<Handle> push = {{{4, 1, 1}, {-kVoxel, 0, 0}, HandleKind::push}};
  {
    VoxelSpringModel model(scene.held(), springs, minimum());
    EXPECT_NE(input_error([&] { model.move(push, 1, nullptr); }).find("push"), std::string::npos);
  }
  VoxelEcmModel(scene.held()).move(push, 1, nullptr);
  EXPECT_NE(input_error([&] { VoxelSpringModel(scene.held(), springs, minimum()); }).find("push"),
            std::string::npos);
}

TEST(PropertyModels, BadParametersAreErrors) {
  Scene scene({3, 3, 3});
  const LatticeSpringParams springs = material_springs(scene.body);
  const auto error_of = [&](const MotionParams& params) {
    return input_error([&] { VoxelSpringModel(scene.held(), springs, params); });
  };
  EXPECT_NE(error_of(motion(SpringMethod::xpbd, 0)).find("time step"), std::string::npos);
  EXPECT_NE(error_of(motion(SpringMethod::xpbd, NAN)).find("time step"), std::string::npos);
  MotionParams params;
  params.tolerance_mn = 0;
  EXPECT_NE(error_of(params).find("tolerance"), std::string::npos);
  params = {};
  params.gravity_m_s2.y = INFINITY;
  EXPECT_NE(error_of(params).find("gravity"), std::string::npos);
}

TEST(PropertyModels, AMeshBodyGoesFromEcmToSpringsAndBack) {
  MeshBody body = make_mesh_body(sheet(15, 15, 2));
  const std::vector<NodeSet> rim = {{0, 14, 210, 224}};
  NodeSet anchored;
  const HeldMesh held{body, rim, anchored};
  const MeshLimits limits{1.1, 0.9, 0.3};
  {
    MeshEcmModel ecm(held, limits);
    ecm.move({{{112}, {1.5, 0, 3}}}, 1, nullptr);
    EXPECT_GT(ecm.report().moved, 20);
  }
  EXPECT_EQ(anchored, NodeSet{112});
  const Vec3d grabbed = body.pos_mm[112];
  const std::vector<Vec3d> dragged = body.pos_mm;
  MeshSpringModel springs(held, {}, motion(SpringMethod::implicit, 1e-2));
  springs.store();
  EXPECT_EQ(body.pos_mm, dragged);
  run_model(springs, 20);
  EXPECT_NE(body.pos_mm, dragged);
  EXPECT_EQ(body.pos_mm[112], grabbed);
  EXPECT_FALSE(body.velocity_mm_s.empty());
  const std::vector<MeshHandle> handles = {{{50}, {0, 0, 1}}, {{112}, {0, 0, 1}}};
  springs.move(handles, 4, nullptr);
  const Vec3d start = body.pos_mm[50];
  run_model(springs, 4);
  EXPECT_NEAR((body.pos_mm[50] - start - Vec3d(0, 0, 1)).length(), 0, 1e-12);
  EXPECT_LT(springs.reactions(handles)[1].force_n.z, 0);
  EXPECT_EQ(anchored, (NodeSet{50, 112}));
  {
    MeshEcmModel ecm(held, limits);
    const double z = body.pos_mm[112].z;
    const std::vector<Vec3d> unprojected = body.pos_mm;
    EXPECT_NE(input_error([&] { ecm.move({{{999}, {0, 1, 0}}}, 1, nullptr); }), "");
    EXPECT_EQ(body.pos_mm, unprojected);
    ecm.move({{{50}, {0, 0, 0.5}}}, 1, nullptr);
    EXPECT_GT(ecm.report().projection.violated_links, 0);
    EXPECT_EQ(ecm.report().projection.held_moved, 0);
    EXPECT_NEAR(body.pos_mm[112].z, z, 1.0 / kVoxel);
    EXPECT_NEAR(body.pos_mm[50].z, start.z + 1 + 0.5, 2.0 / kVoxel);
    EXPECT_EQ(anchored, (NodeSet{50, 112}));
  }
  const std::vector<Vec3d> before = body.pos_mm;
  MeshSpringModel again(held, {}, motion(SpringMethod::implicit, 1e-2));
  EXPECT_NE(input_error([&] { again.move({{{3}, {0, NAN, 0}}}, 1, nullptr); }), "");
  EXPECT_NE(input_error([&] { again.move({{{999}, {0, 1, 0}}}, 1, nullptr); }), "");
  EXPECT_EQ(body.pos_mm, before);
  anchored.push_back(999);
  EXPECT_NE(input_error([&] { MeshSpringModel(held, {}, {}); }).find("999"), std::string::npos);
}
