// A session: a live session of the program, so that events, undo, journals and states are its own.
#include <mutex>

#include "lib/session/deformable_mesh.h"
#include "tools/python/attended.h"
#include "tools/python/bindings.h"
#include "tools/python/python_arrays.h"
#include "tools/python/python_values.h"
#include "tools/python/sent_through.h"
#include "tools/scene/augment/augmentation.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/live/live_session.h"
#include "tools/scene/live/replay.h"
#include "tools/scene/live/step_texts.h"
#include "tools/scene/pictures/picture_writer.h"
#include "tools/scene/run/frames.h"
#include "tools/scene/run/reports.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/field/dense/resample.h"
#include "volumes/grid/b_spline.h"

namespace py = pybind11;

namespace supple::python {

namespace {

using tools::LiveSession;

tools::AugmentParams augment_params(const Value& keys) {
  tools::AugmentParams params;
  read_keys(keys, fields(params));
  return params;
}

/// Pose of a state with a part of its displacement, settled again.
Pose scaled_pose(const State& state, const Pose& whole, double amount, Progress& progress) {
  Displacement scaled = whole.displacement;
  for (std::size_t b = 0; b < scaled.u.topology.brick_count(); ++b) {
    if (scaled.u.vectors.brick(b) == nullptr) continue;
    Vec3f* const u = scaled.u.vectors.touch(b);
    for (int n = 0; n < kBrickVoxels; ++n) u[n] *= float(amount);
  }
  OffsetField offsets = invert_displacement(state, scaled, &progress);
  return {std::move(scaled), std::move(offsets)};
}

/// One thread at a time; whoever waits for it attends to signals, too.
class HeldSession {
 public:
  HeldSession(const Value& root, const py::object& callback) {
    attend(callback, [&](Progress& progress) {
      m_live = std::make_unique<LiveSession>(Table(root), &progress);
    });
  }

  /// work(live, progress), without the GIL.
  template <class Work>
  auto with(const py::object& callback, const Work& work) {
    return attended(callback, [&](Progress& progress) {
      const std::lock_guard lock(m_guard);
      return work(*m_live, progress);
    });
  }

  /// Does what an event says, all of a relaxation too; the report of the step that it became.
  Value carry_out(const Value& keys, const py::object& callback) {
    return with(callback, [&](LiveSession& live, Progress& progress) {
      Table table(keys);
      const tools::LiveEvent event = tools::read_event(table, live.scene().label_names);
      const std::size_t done = live.session().records().size();
      live.carry_out(event, &progress);
      while (live.has_more()) live.go_on(&progress);
      const auto& records = live.session().records();
      return records.size() > done ? tools::to_value(records.back()) : Value();
    });
  }

  Geometry grid() const { return m_live->session().geometry(); }

  Value certificate(const py::object& callback) {
    return with(callback, [](LiveSession& live, Progress& progress) {
      return to_value(live.session().pose(&progress).offsets.certificate);
    });
  }

  /// State and pose as they are now; they share what is large with the session.
  struct Posed {
    State state;
    Pose pose;
  };
  Posed posed(const py::object& callback) {
    return with(callback, [](LiveSession& live, Progress& progress) {
      return Posed{live.session().state(), live.session().pose(&progress)};
    });
  }

  py::array displacement(const py::object& callback) {
    const Posed now = posed(callback);
    return vectors_of(now.state.geometry, dense_displacement(now.pose.displacement), callback);
  }

  py::array offsets(const Geometry& grid, const std::string& void_name,
                    const py::object& callback) {
    const VoidMode mode = void_of(void_name);
    const Posed now = posed(callback);
    return vectors_of(grid,
                      dense_offsets(now.pose.offsets, now.state.density.bricks(), grid, mode,
                                    &now.state.elements),
                      callback);
  }

  py::array resample(const Geometry& grid, bool is_cubic, const py::object& callback) {
    const Posed now = posed(callback);
    const State& state = now.state;
    std::optional<SplineDensity> spline;
    if (is_cubic) spline.emplace(state.density, state.geometry.dims(), true);
    const auto between = [&](const Vec3d& index) { return float(spline->at(index)); };
    const float fill = state.density.background();
    const auto slices = is_cubic ? dense_resampled(now.pose.offsets, between, grid, fill)
                                 : dense_resampled(now.pose.offsets, state.density, grid, fill);
    ValueType type = ValueType::float32;
    find_numpy_type(state.source_type, type);
    return scalars_of(grid, type, slices, callback);
  }

  py::tuple move_points(const PointArray& points, bool back, const py::object& callback) {
    const Posed now = posed(callback);
    const CutElements body{now.state.elements, now.state.cuts};
    const auto motion = attended(callback, [&](Progress&) {
      return back ? motion_to_rest(now.pose.displacement, body, now.pose.offsets)
                  : motion_along(now.pose.displacement, body);
    });
    return send_points(*motion, points, callback);
  }

  py::array move_labels(const StoredLabels& labels, bool back, const Geometry& grid,
                        const py::object& callback) {
    const Posed now = posed(callback);
    if (!back) {
      return labels_of(labels, grid, followed_labels(labels, now.pose.offsets, grid), callback);
    }
    std::atomic<std::int64_t> unresolved{0};
    const CutElements body{now.state.elements, now.state.cuts};
    const auto motion =
        attended(callback, [&](Progress&) { return motion_along(now.pose.displacement, body); });
    return labels_of(labels, grid, followed_labels(labels, *motion, grid, unresolved), callback);
  }

  /// Takes the body to a sample of `supple augment`, and its truth. The body at the first call is
  /// rest; `keys`: fields of AugmentParams.
  Value sample(const Value& keys, int number, const py::object& callback) {
    return with(callback, [&](LiveSession& live, Progress& progress) {
      if (!m_samples || !(keys == m_settings)) {
        const tools::AugmentParams params = augment_params(keys);
        if (m_samples) m_samples->take_back();
        m_samples.emplace(live.session(), params);
        m_settings = keys;
      }
      return m_samples->draw(number, &progress);
    });
  }

  py::tuple measure(bool has_maps, const py::object& callback) {
    struct Measured {
      State state;
      DeformationMaps maps;
    };
    const Measured measured = with(callback, [](LiveSession& live, Progress&) {
      State state = live.session().state();
      DeformationMaps maps = map_deformation(displacement_of(state), state.elements, state.cuts);
      return Measured{std::move(state), std::move(maps)};
    });
    return measures_of(measured.maps, measured.state.geometry, measured.state.labels, has_maps,
                       callback);
  }

  /// A view as a scene has it, into its `image`, with this part of the displacement.
  Value draw(const Value& keys, double amount, const py::object& callback) {
    return with(callback, [&](LiveSession& live, Progress& progress) {
      Table table(keys);
      tools::SceneView view = tools::read_view(table, 0);
      tools::check_view(view);
      Session& session = live.session();
      const State state = session.state();
      const Pose* pose = &session.pose(&progress);
      std::optional<Pose> part, own;
      if (amount != 1) pose = &part.emplace(scaled_pose(state, *pose, amount, progress));
      if (!view.path.empty()) pose = &own.emplace(tools::send_along(view.path, *pose, progress));
      if (!view.deformed) pose = nullptr;
      view = tools::effective_view(view, state.geometry, state.density.background());
      const bool solves = pose != nullptr && !view.inverse;
      const bool reads = pose != nullptr && (solves || tools::reads_displacement(view));
      const MaterialTable& material = session.material();
      const tools::PosedVolume subject{state.geometry,
                                       state.density,
                                       state.elements,
                                       pose == nullptr || solves ? nullptr : &pose->offsets,
                                       reads ? &pose->displacement : nullptr,
                                       material.domain_lo,
                                       material.domain_hi,
                                       0,
                                       &state.elements,
                                       &state.cuts,
                                       &state.labels};
      tools::PendingFiles files;
      tools::PictureWriter writer(files, view.image, view.picture);
      RenderReport report;
      tools::draw_view(subject, view, writer, &report, progress);
      files.commit();
      return tools::to_value(report);
    });
  }

  Value facts(const py::object& callback) {
    return with(callback, [](LiveSession& live, Progress&) {
      Session& session = live.session();
      Value facts = {{"elements", session.body().elements.active_count()},
                     {"undo_steps", std::int64_t(session.undo_steps())},
                     {"reports", Value::List()},
                     {"done", Value::List()},
                     {"undone", Value::List()},
                     {"messages", session.messages()}};
      for (const StepRecord& record : session.records()) {
        facts["reports"].push_back(tools::to_value(record));
      }
      const tools::History history = tools::history_of(live.history());
      for (const auto& entry : history.done) facts["done"].push_back(entry.text);
      for (const auto& entry : history.undone) facts["undone"].push_back(entry.text);
      return facts;
    });
  }

  std::string hash(const py::object& callback) {
    return with(callback, [](LiveSession& live, Progress&) {
      return tools::hash_of(live.session().state());
    });
  }

  void save(const std::string& path, const py::object& callback) {
    with(callback, [&](LiveSession& live, Progress& progress) {
      live.session().write_state(path, &progress);
      return true;
    });
  }

  Value journal(const py::object& callback) {
    return with(callback, [](LiveSession& live, Progress&) { return live.journal(); });
  }
  Value scene(const py::object& callback) {
    return with(callback, [](LiveSession& live, Progress&) { return live.batch_scene(); });
  }

 private:
  std::mutex m_guard;
  std::unique_ptr<LiveSession> m_live;
  std::optional<tools::Augmentation> m_samples;
  Value m_settings;
};

}  // namespace

void bind_session(py::module_& module) {
  py::class_<HeldSession>(module, "HeldSession")
      .def(py::init<const Value&, const py::object&>())
      .def("carry_out", &HeldSession::carry_out)
      .def_property_readonly("grid", &HeldSession::grid)
      .def("certificate", &HeldSession::certificate)
      .def("displacement", &HeldSession::displacement)
      .def("offsets", &HeldSession::offsets)
      .def("resample", &HeldSession::resample)
      .def("move_points", &HeldSession::move_points)
      .def("move_labels", &HeldSession::move_labels)
      .def("measure", &HeldSession::measure)
      .def("sample", &HeldSession::sample)
      .def("draw", &HeldSession::draw)
      .def("facts", &HeldSession::facts)
      .def("hash", &HeldSession::hash)
      .def("save", &HeldSession::save)
      .def("journal", &HeldSession::journal)
      .def("scene", &HeldSession::scene);
  module.def("check_augment", [](const Value& keys) { augment_params(keys); });
}

}  // namespace supple::python
