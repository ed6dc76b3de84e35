// A session: a live session of the program, so that events, undo, journals and states are its own.
#include <chrono>
#include <mutex>
#include <thread>

#include "lib/session/deformable_mesh.h"
#include "lib/session/step_model.h"
#include "raycast/pictures/image.h"
#include "tools/python/attended.h"
#include "tools/python/bindings.h"
#include "tools/python/python_arrays.h"
#include "tools/python/python_values.h"
#include "tools/python/sent_through.h"
#include "tools/scene/augment/augmentation.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/live/hand_lead.h"
#include "tools/scene/live/kept_pictures.h"
#include "tools/scene/live/live_session.h"
#include "tools/scene/live/replay.h"
#include "tools/scene/live/step_texts.h"
#include "tools/scene/run/reports.h"
#include "volumes/base/atomic_file.h"
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

  LiveSession& live() { return *m_live; }
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

  /// The body in hand as a page is told of it: what leads, how far it came, error and force.
  Value hand(const py::object& callback) {
    return with(callback, [](LiveSession& live, Progress&) {
      const bool waits = live.hand().grab && live.model().waits_for_hands;
      Value told = {{"model", (waits ? step_models().front() : live.model()).name}};
      if (live.hand().led) told.update(tools::to_value(*live.hand().led));
      if (const tools::HandLead* const lead = live.lead()) {
        told.update(tools::to_value(lead->state()));
        if (lead->has_level()) told["model"] = live.model().name;
      }
      return told;
    });
  }

  /// Waits until the best of finite elements under the hand leads.
  void wait_for_hand(const py::object& callback) {
    with(callback, [](LiveSession& live, Progress& progress) {
      tools::HandLead* const lead = live.lead();
      if (lead == nullptr) return false;
      lead->found(&progress);
      for (; lead->is_changing(); std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
        poll(&progress);
        lead->shape();
      }
      return true;
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

/// A picture in memory, and as a file when somebody asks for that.
class TakenPicture {
 public:
  TakenPicture(tools::SinglePicture drawn, bool has_16_bits)
      : m_drawn(std::move(drawn)), m_image(to_image(m_drawn.picture)), m_has_16_bits(has_16_bits) {
    if (!m_has_16_bits) m_drawn.picture = {};
  }

  /// The pixels, which are not copied, rows from the top. They keep `self`, this.
  static py::array pixels(const py::object& self) {
    const Image& image = self.cast<const TakenPicture&>().m_image;
    return py::array_t<std::uint8_t>({image.height, image.width, 4}, image.rgba.data(), self);
  }
  void save(const std::string& path, const py::object& callback) const {
    attend(callback, [&](Progress&) {
      AtomicFile file(path);
      if (m_has_16_bits) {
        write_png16(file, m_drawn.picture, m_drawn.configuration);
      } else {
        write_png(file, m_image, m_drawn.configuration);
      }
      file.commit();
    });
  }

 private:
  tools::SinglePicture m_drawn;
  Image m_image;
  bool m_has_16_bits;
};

/// Pictures of a session, which must outlive them, or of a volume.
class HeldPictures {
 public:
  explicit HeldPictures(HeldSession& session)
      : m_kept(std::make_unique<tools::BodyPictures>(session.live())), m_session(&session) {}
  explicit HeldPictures(const Value& root)
      : m_kept(std::make_unique<tools::VolumePictures>(tools::read_scene(Table(root)))) {}

  /// The picture and the report of how it was drawn.
  py::tuple draw(const Value& keys, double amount, const py::object& callback) {
    Table table(keys);
    const tools::SceneView view = tools::read_view(table, 0);
    RenderReport report;
    const auto draw = [&](Progress& progress) {
      return std::make_unique<TakenPicture>(m_kept->draw(view, amount, report, progress),
                                            view.picture.bits == 16);
    };
    std::unique_ptr<TakenPicture> taken =
        m_session != nullptr
            ? m_session->with(callback, [&](LiveSession&, Progress& to) { return draw(to); })
            : attended(callback, [&](Progress& to) {
                const std::lock_guard lock(m_guard);
                return draw(to);
              });
    return py::make_tuple(std::move(taken), tools::to_value(report));
  }

 private:
  std::unique_ptr<tools::KeptPictures> m_kept;
  HeldSession* m_session = nullptr;
  std::mutex m_guard;  // of a volume
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
      .def("hand", &HeldSession::hand)
      .def("wait_for_hand", &HeldSession::wait_for_hand)
      .def("facts", &HeldSession::facts)
      .def("hash", &HeldSession::hash)
      .def("save", &HeldSession::save)
      .def("journal", &HeldSession::journal)
      .def("scene", &HeldSession::scene);
  py::class_<TakenPicture>(module, "TakenPicture")
      .def_property_readonly("array", &TakenPicture::pixels)
      .def("save", &TakenPicture::save);
  py::class_<HeldPictures>(module, "HeldPictures")
      .def(py::init<HeldSession&>(), py::keep_alive<1, 2>())
      .def(py::init<const Value&>())
      .def("draw", &HeldPictures::draw);
  module.def("check_augment", [](const Value& keys) { augment_params(keys); });
}

}  // namespace supple::python
