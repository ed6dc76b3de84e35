#include "tools/lab/bench/render/render_show.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <optional>

#include "lib/state/pose.h"
#include "lib/state/state.h"
#include "raycast/progressive.h"
#include "tools/lab/bench/bodies/ecm_bodies.h"
#include "tools/lab/bench/peers/peer_head.h"
#include "tools/lab/bench/report/memory.h"
#include "tools/scene/peers/peer_process.h"
#include "tools/scene/peers/vtk_peer.h"
#include "tools/scene/plan/calibrate.h"
#include "volumes/base/parallel.h"
#include "volumes/base/process.h"
#include "volumes/base/value.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/inversion/invert.h"

namespace supple::tools {

namespace {

const std::string kWithoutInverse = "supple-no-inverse";
const std::string kLocal = "session-local";

/// Times and memory of one side; medians are taken of the times.
struct ShowResult {
  Times prepare, frame;
  double peak_mbytes = 0;  // the largest of all runs

  /// Returns the sum of both times.
  double add(double prepare_ms, double frame_ms, double peak) {
    prepare.ms.push_back(prepare_ms);
    frame.ms.push_back(frame_ms);
    peak_mbytes = std::max(peak_mbytes, peak);
    return prepare_ms + frame_ms;
  }
};

/// The head, a drag of its upper jaw (as in docs/scenes/head_drag.toml) and its dense warp, made by
/// the program itself, as a user would.
class DraggedFiles {
 public:
  DraggedFiles(int by_mm, int threads) : m_threads(std::to_string(threads)) {
    write_peer_head(volume(), make_peer_head());
    std::ofstream(m_scratch / "material.toml") << kHeadMaterial;
    supple({"deform", volume(), "--material", m_scratch / "material.toml", "--grab", "128,44,28",
            "--by", "0,-" + std::to_string(by_mm) + ",0", "--fix", "20,105,142:235,235,253", "-o",
            state()});
    supple({"export", state(), "-o", warp()});
  }

  std::string volume() const { return m_scratch / "head.mha"; }
  std::string state() const { return m_scratch / "drag.vdb"; }
  std::string warp() const { return m_scratch / "warp.mha"; }
  std::string operator/(const std::string& name) const { return m_scratch / name; }

  ProcessCost supple(std::vector<std::string> arguments) const {
    const std::vector<std::string> program = {require_program_beside("supple"), "--quiet",
                                              "--force", "--threads", m_threads};
    arguments.insert(arguments.begin(), program.begin(), program.end());
    return PeerProcess(arguments).finish();
  }

 private:
  ScratchFolder m_scratch;
  std::string m_threads;
};

/// A body held as a viewer does, dragged out of rest, with an inverse that follows or without any.
class SuppleViewer {
 public:
  SuppleViewer(const std::string& state_path, bool has_inverse)
      : m_state(read_state(state_path)),
        m_renderer(m_state.geometry, m_state.density),
        m_live(m_state.geometry, m_state.elements, m_state.density.bricks()) {
    if (has_inverse) {
      m_inversion = std::make_unique<IncrementalInversion>(m_live.displacement(), params());
    } else {
      m_forward = std::make_shared<ForwardOffsets>(m_live.displacement(), &m_state.elements);
    }
  }

  double show_drag(ShowResult& result) {
    follow({});
    refine();
    const double prepare_ms = time_ms([&] { follow(m_state.q); });
    const double frame_ms = time_ms([&] { refine(); });
    return result.add(prepare_ms, frame_ms, 0);
  }
  /// Memory above what was held before; of the whole process.
  double peak_mbytes() const { return double(m_memory.growth().value_or(0)) / 1e6; }

 private:
  /// Draws the whole picture of what is shown now.
  void refine() {
    m_picture = m_picture != nullptr
                    ? m_picture->follow()
                    : std::make_unique<ProgressiveRender>(m_renderer, peer_camera(m_state.geometry),
                                                          preset("Bone"), peer_settings(true));
    m_picture->refine_to(1);
    to_image(m_picture->picture());
  }
  InvertParams params() const {
    InvertParams params;
    params.material = &m_state.elements;
    return params;
  }
  void follow(const std::array<BrickValues, 3>& q) {
    const std::vector<std::int32_t> changed = m_live.update(q);
    if (m_inversion != nullptr) {
      const std::vector<Vec3i> touched = m_inversion->update(m_live.displacement(), changed);
      m_renderer.update_offsets(touched, m_inversion->finder());
    } else {
      m_forward->update(changed);
      m_renderer.set_pointwise_offsets(m_forward);
    }
  }

  PeakMemory m_memory;  // before anything is held
  State m_state;
  Renderer m_renderer;
  std::unique_ptr<ProgressiveRender> m_picture;
  LiveDisplacement m_live;
  std::unique_ptr<IncrementalInversion> m_inversion;
  std::shared_ptr<ForwardOffsets> m_forward;
};

/// ITK and VTK with what they need to show the dragged head.
class PeerPipeline {
 public:
  PeerPipeline(const DraggedFiles& files, int threads)
      : m_files(files),
        m_threads(threads),
        m_itk{program_beside("supple-itk-warp"), files.volume(), files.warp(), files / "warped.mha",
              std::to_string(threads)},
        m_geometry(peer_geometry()),
        m_picture{half_mean_spacing(m_geometry), true, false, ""} {}

  static bool is_installed() {
    return !program_beside("supple-itk-warp").empty() && VtkPeer::is_installed();
  }

  double run_processes(ShowResult& result) {
    PeerProcess itk(m_itk);
    const ProcessCost warp = itk.finish();
    VtkPeer vtk(m_display);
    vtk.open(job());
    VtkPicture picture = m_picture;
    picture.image = m_files / "vtk.png";
    vtk.draw(picture);
    const ProcessCost frame = vtk.finish();
    return result.add(warp.wall_ms, frame.wall_ms,
                      std::max(warp.peak_mbytes.value_or(0), frame.peak_mbytes.value_or(0)));
  }

  /// Both programs stay: nothing is read or written after a drag, and what the one hands to the
  /// other costs nothing.
  double show_drag(ShowResult& result) {
    if (m_itk_session == nullptr) {
      m_itk_session = std::make_unique<PeerProcess>(m_itk);
      m_itk_session->read_line();
      // Before VTK reads it: an answer comes after the warped volume is written.
      m_itk_session->ask("again");
      m_vtk_session = std::make_unique<VtkPeer>(m_display);
      m_vtk_session->open(job());
      m_vtk_session->draw(m_picture);
    }
    const auto warp = nlohmann::json::parse(m_itk_session->ask("again"));
    VtkPicture picture = m_picture;
    picture.is_fresh = true;
    const VtkAnswer frame = m_vtk_session->draw(picture);
    const double warp_growth =
        warp.at("peak_mbytes").get<double>() - warp.at("base_mbytes").get<double>();
    return result.add(warp.at("warp_ms"), frame.frame_ms,
                      std::max(warp_growth, frame.growth_mbytes));
  }

 private:
  /// VTK's own choice where its sample distance is locked to the spacing.
  static double half_mean_spacing(const Geometry& geometry) {
    const Vec3d spacing = geometry.spacing_mm();
    return (spacing.x + spacing.y + spacing.z) / 6;
  }

  Value job() const {
    return vtk_job(m_itk[3], peer_camera(m_geometry), peer_function(), peer_settings(true),
                   m_threads);
  }

  const DraggedFiles& m_files;
  int m_threads;
  std::vector<std::string> m_itk;
  Geometry m_geometry;
  VtkPicture m_picture;
  VirtualDisplay m_display;
  std::unique_ptr<PeerProcess> m_itk_session;
  std::unique_ptr<VtkPeer> m_vtk_session;
};

double run_supple(const ShowSide& side, const DraggedFiles& files, ShowResult& result) {
  std::vector<std::string> arguments = {"render", files.state()};
  if (side.pipeline == "supple-warp") {
    arguments = {"render", files.volume(), "--offsets", files.warp()};
  } else if (side.pipeline == kWithoutInverse) {
    arguments.emplace_back("--no-inverse");
  }
  const std::vector<std::string> picture = {"--preset", "Bone", "--size",
                                            "512,512",  "-o",   files / "supple.png"};
  arguments.insert(arguments.end(), picture.begin(), picture.end());
  const ProcessCost cost = files.supple(arguments);
  result.peak_mbytes = std::max(result.peak_mbytes, cost.peak_mbytes.value_or(0));
  return cost.wall_ms;
}

BenchRow row_of(const ShowSide& side, const ShowResult& result, const Times& times,
                const Times* supple_times) {
  BenchRow row = {{"case", "show"},
                  {"mode", side.mode},
                  {"pipeline", side.pipeline},
                  {"size", {kPeerHeadSize, kPeerHeadSize, kPeerHeadSize}},
                  {"image", {kPeerImageSize, kPeerImageSize}}};
  if (!result.prepare.ms.empty()) {
    row["prepare_ms"] = result.prepare.median();
    row["frame_ms"] = result.frame.median();
  }
  if (result.peak_mbytes > 0) row["peak_mbytes"] = result.peak_mbytes;
  if (supple_times != nullptr) row["times_supple"] = times.median() / supple_times->median();
  add_times(row, times, side.threads);
  return row;
}

using Viewers = std::map<std::string, std::unique_ptr<SuppleViewer>>;

/// Opens the viewers and measures each one's memory before the next; all stay for the rounds.
void open_viewers(const std::vector<ShowSide>& sides, const DraggedFiles& files, Viewers& viewers,
                  std::vector<ShowResult>& results) {
  for (std::size_t n = 0; n < sides.size(); ++n) {
    const std::string& pipeline = sides[n].pipeline;
    if (sides[n].mode == "process" || pipeline == "itk+vtk") continue;
    auto viewer = std::make_unique<SuppleViewer>(files.state(), pipeline != kWithoutInverse);
    ShowResult ignored;
    viewer->show_drag(ignored);
    results[n].peak_mbytes = viewer->peak_mbytes();
    viewers[pipeline] = std::move(viewer);
  }
}

/// Sides of one mode.
std::vector<BenchRow> measure_mode(const std::vector<ShowSide>& sides, const DraggedFiles& files,
                                   const RoundLimits& limits,
                                   const std::function<void()>& before_run) {
  std::unique_ptr<PeerPipeline> peers;
  Viewers viewers;
  std::vector<ShowResult> results(sides.size());
  std::vector<TimedSide> timed(sides.size());
  for (std::size_t n = 0; n < sides.size(); ++n) {
    const ShowSide& side = sides[n];
    timed[n].run = [&, n](Times& times) {
      const bool is_process = side.mode == "process";
      if (side.pipeline == "itk+vtk") {
        if (!peers) peers = std::make_unique<PeerPipeline>(files, side.threads);
        times.ms.push_back(is_process ? peers->run_processes(results[n])
                                      : peers->show_drag(results[n]));
      } else if (is_process) {
        times.ms.push_back(run_supple(side, files, results[n]));
      } else {
        times.ms.push_back(viewers.at(side.pipeline)->show_drag(results[n]));
      }
    };
  }
  open_viewers(sides, files, viewers, results);
  take_turns(timed, limits, before_run);
  std::vector<BenchRow> rows;
  for (std::size_t n = 0; n < sides.size(); ++n) {
    const bool has_lead = sides.front().pipeline == "supple" && n > 0;
    rows.push_back(
        row_of(sides[n], results[n], timed[n].times, has_lead ? &timed.front().times : nullptr));
  }
  return rows;
}

}  // namespace

std::vector<ShowSide> show_sides(int threads) {
  return {{"process", "supple", threads},      {"process", kWithoutInverse, threads},
          {"process", "supple-warp", threads}, {"process", "itk+vtk", threads},
          {"session", "supple", threads},      {"session", kWithoutInverse, threads},
          {"session", "itk+vtk", threads},     {kLocal, "supple", threads},
          {kLocal, kWithoutInverse, threads},  {kLocal, "itk+vtk", threads}};
}

std::string show_row_name(const ShowSide& side) {
  return "show/" + side.mode + "/" + side.pipeline + "/" + std::to_string(side.threads);
}

std::vector<BenchRow> measure_show(const std::vector<ShowSide>& wanted, const RoundLimits& limits,
                                   Console& console, const std::function<void()>& before_run) {
  std::vector<ShowSide> sides = wanted;
  if (!PeerPipeline::is_installed()) {
    const auto is_peer = [](const ShowSide& side) { return side.pipeline == "itk+vtk"; };
    const auto first = std::remove_if(sides.begin(), sides.end(), is_peer);
    if (first != sides.end()) console.note("ITK or VTK is not installed: its rows are left out");
    sides.erase(first, sides.end());
  }
  if (sides.empty()) return {};
  const int threads = sides.front().threads;
  const ThreadLimit limit(threads);
  std::vector<BenchRow> rows;
  // Processes first: while this program holds a volume, their memory could not be told.
  for (const std::string& mode : {std::string("process"), std::string("session"), kLocal}) {
    std::vector<ShowSide> of_mode;
    for (const ShowSide& side : sides) {
      if (side.mode == mode) of_mode.push_back(side);
    }
    if (of_mode.empty()) continue;
    const DraggedFiles files(mode == kLocal ? 3 : 12, threads);
    for (BenchRow& row : measure_mode(of_mode, files, limits, before_run)) {
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace supple::tools
