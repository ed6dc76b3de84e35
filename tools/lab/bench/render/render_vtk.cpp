#include "tools/lab/bench/render/render_vtk.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "raycast/pictures/compare.h"
#include "tools/lab/bench/peers/peer_head.h"
#include "tools/scene/peers/vtk_peer.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

const std::string kReference = "0.1";  // step in voxels
const char* const kSteps[] = {"0.15", "0.25", "0.5", "1", "2"};

bool is_step(const std::string& setting) {
  return setting.find_first_not_of("0123456789.") == std::string::npos;
}

/// Both renderers' pictures of the finest steps, on black. Where either shows something is the
/// foreground of every comparison: faint tissue counts for VTK, too, which loses some of it.
class References {
 public:
  References(Image supple, Image vtk)
      : m_pictures{{"supple", std::move(supple)}, {"vtk", std::move(vtk)}} {
    const std::vector<std::uint8_t>&a = m_pictures["supple"].rgba, &b = m_pictures["vtk"].rgba;
    m_alpha.resize(a.size() / 4);
    for (std::size_t n = 0; n < m_alpha.size(); ++n) {
      const auto is_seen = [n](const std::vector<std::uint8_t>& rgba) {
        return rgba[4 * n] > 0 || rgba[4 * n + 1] > 0 || rgba[4 * n + 2] > 0;
      };
      m_alpha[n] = is_seen(a) || is_seen(b) ? 255 : 0;
    }
    for (auto& [renderer, picture] : m_pictures) set_alpha(picture);
  }

  double ssim(Image image, const std::string& renderer) const {
    set_alpha(image);
    return compare(image, m_pictures.at(renderer), true).ssim;
  }

 private:
  void set_alpha(Image& image) const {
    image.has_alpha = true;
    for (std::size_t n = 0; n < m_alpha.size(); ++n) image.rgba[4 * n + 3] = m_alpha[n];
  }

  std::map<std::string, Image> m_pictures;
  std::vector<std::uint8_t> m_alpha;
};

double lerp(double a, double b, double t) {
  return a + t * (b - a);
}

/// A picture on black as VTK's window would show it: the pixels of `cast` become a texture whose
/// outermost texel centres, not edges, lie at the ends of the rectangle, bilinear between them.
Image as_vtk_shows(const FloatImage& picture, const PixelBox& cast) {
  Image image(picture.width, picture.height);
  const auto texel = [](int pixel, int first, int end) {
    const int count = end - first;
    return first + (pixel - first + 0.5) * (count - 1) / count;
  };
  const auto value = [&](int x, int y, int c) {
    return picture.rgba[4 * (std::size_t(y) * picture.width + x) + c];
  };
  for (int py = cast.y0; py < cast.y1; ++py) {
    const double ty = texel(py, cast.y0, cast.y1);
    const int y = int(ty);
    for (int px = cast.x0; px < cast.x1; ++px) {
      const double tx = texel(px, cast.x0, cast.x1);
      const int x = int(tx);
      for (int c = 0; c < 3; ++c) {
        const double above = lerp(value(x, y, c), value(x + 1, y, c), tx - x);
        const double below = lerp(value(x, y + 1, c), value(x + 1, y + 1, c), tx - x);
        const double shown = std::clamp(lerp(above, below, ty - y), 0.0, 1.0);
        image.rgba[4 * (std::size_t(py) * picture.width + px) + c] =
            std::uint8_t(std::lround(255 * shown));
      }
    }
  }
  return image;
}

/// Both renderers with the same head in view.
class StraightView {
 public:
  explicit StraightView(int threads)
      : m_head(written_head()),
        m_smallest_mm(smallest(m_head.geometry.spacing_mm())),
        m_camera(peer_camera(m_head.geometry)),
        m_supple(m_head.geometry, m_head.density, kAirRings),
        m_vtk(m_display),
        m_cast(open_vtk(threads)) {}

  FloatImage draw_supple(const std::string& setting, bool shaded, RenderReport* report) const {
    RenderSettings settings = peer_settings(shaded);
    if (setting == kReference) settings.early_termination = 1;
    if (is_step(setting)) {
      settings.step_voxels = std::stod(setting);
      settings.stride = 1;
    } else {
      settings.set_quality(parse_quality(setting));
    }
    return m_supple.render_float(m_camera, peer_function(), settings, report);
  }
  VtkAnswer draw_vtk(const std::string& setting, bool shaded) {
    return m_vtk.draw({std::stod(setting) * m_smallest_mm, shaded});
  }

  Image picture(const StraightSide& side) {
    const bool shaded = side.shading != "none";
    if (side.renderer == "supple") {
      return as_vtk_shows(draw_supple(side.setting, shaded, nullptr), m_cast);
    }
    VtkPicture wanted{std::stod(side.setting) * m_smallest_mm, shaded};
    wanted.image = m_scratch / "vtk.png";
    m_vtk.draw(wanted);
    return read_png(wanted.image);
  }

 private:
  PeerHead written_head() const {
    PeerHead head = make_peer_head();
    write_peer_head(m_scratch / "head.mha", head);
    return head;
  }
  PixelBox open_vtk(int threads) {
    m_vtk.open(
        vtk_job(m_scratch / "head.mha", m_camera, peer_function(), peer_settings(true), threads));
    return draw_vtk("1", false).cast;
  }
  static double smallest(const Vec3d& v) { return std::min({v.x, v.y, v.z}); }

  ScratchFolder m_scratch;
  PeerHead m_head;
  double m_smallest_mm;
  Camera m_camera;
  Renderer m_supple;
  VirtualDisplay m_display;
  VtkPeer m_vtk;
  PixelBox m_cast;  // the same for all pictures
};

/// Times and similarity (SSIM) of one side.
struct StraightResult {
  Times times, frame;  // of VTK, `times` are of the ray caster alone
  RenderReport report;
  double ssim = 0, ssim_other = 0;
};

/// VTK's time at an SSIM, between its steps: log(ms) linear in log(1 - SSIM). Absent beyond them.
std::optional<double> vtk_ms_at(double ssim, const std::vector<StraightSide>& sides,
                                const std::vector<StraightResult>& results) {
  std::map<double, double> log_ms;  // by log(1 - ssim)
  for (std::size_t n = 0; n < sides.size(); ++n) {
    if (sides[n].renderer != "vtk" || results[n].ssim >= 1) continue;
    log_ms[std::log(1 - results[n].ssim)] = std::log(results[n].times.median());
  }
  if (ssim >= 1) return std::nullopt;
  const double wanted = std::log(1 - ssim);
  const auto above = log_ms.lower_bound(wanted);
  if (above == log_ms.end()) return std::nullopt;
  if (above->first == wanted) return std::exp(above->second);
  if (above == log_ms.begin()) return std::nullopt;
  const auto below = std::prev(above);
  const double t = (wanted - below->first) / (above->first - below->first);
  return std::exp(below->second + t * (above->second - below->second));
}

BenchRow row_of(std::size_t n, const std::vector<StraightSide>& sides,
                const std::vector<StraightResult>& results) {
  const StraightSide& side = sides[n];
  const StraightResult& result = results[n];
  BenchRow row = {{"case", "casters-" + side.shading},
                  {"renderer", side.renderer},
                  {"setting", side.setting},
                  {"size", {kPeerHeadSize, kPeerHeadSize, kPeerHeadSize}},
                  {"image", {kPeerImageSize, kPeerImageSize}},
                  {"ssim", result.ssim},
                  {"ssim_other", result.ssim_other}};
  if (side.renderer == "vtk") {
    row["frame_ms"] = result.frame.median();
  } else {
    row["samples"] = result.report.samples;
    const double ms = result.times.median();
    for (std::size_t other = 0; other < sides.size(); ++other) {
      if (sides[other].renderer == "vtk" && sides[other].setting == side.setting) {
        row["times_vtk"] = results[other].times.median() / ms;
      }
    }
    if (const auto vtk_ms = vtk_ms_at(result.ssim, sides, results)) {
      row["times_vtk_at_ssim"] = *vtk_ms / ms;
    }
  }
  add_times(row, result.times, side.threads);
  return row;
}

std::vector<BenchRow> measure_shading(StraightView& view, const std::vector<StraightSide>& sides,
                                      const RoundLimits& limits,
                                      const std::function<void()>& before_run) {
  const auto reference = [&](const std::string& renderer) {
    before_run();
    return view.picture({renderer, sides.front().shading, kReference, 1});
  };
  const References references(reference("supple"), reference("vtk"));
  std::vector<StraightResult> results(sides.size());
  std::vector<TimedSide> timed(sides.size());
  for (std::size_t n = 0; n < sides.size(); ++n) {
    const bool shaded = sides[n].shading != "none";
    timed[n].run = [&, n, shaded](Times& times) {
      const StraightSide& side = sides[n];
      if (side.renderer == "vtk") {
        const VtkAnswer answer = view.draw_vtk(side.setting, shaded);
        results[n].frame.ms.push_back(answer.frame_ms);
        times.ms.push_back(answer.cast_ms);
      } else {
        times.ms.push_back(
            time_ms([&] { view.draw_supple(side.setting, shaded, &results[n].report); }));
      }
    };
  }
  take_turns(timed, limits, before_run);
  for (std::size_t n = 0; n < sides.size(); ++n) {
    const std::string& own = sides[n].renderer;
    const Image image = view.picture(sides[n]);
    results[n].times = timed[n].times;
    results[n].ssim = references.ssim(image, own);
    results[n].ssim_other = references.ssim(image, own == "vtk" ? "supple" : "vtk");
  }
  std::vector<BenchRow> rows;
  for (std::size_t n = 0; n < sides.size(); ++n) rows.push_back(row_of(n, sides, results));
  return rows;
}

}  // namespace

std::vector<StraightSide> straight_sides(int threads) {
  std::vector<StraightSide> sides;
  for (const std::string shading : {"blinn", "none"}) {
    for (const char* step : kSteps) sides.push_back({"vtk", shading, step, threads});
    for (const char* step : kSteps) sides.push_back({"supple", shading, step, threads});
    for (const char* quality : {"draft", "default", "accurate"}) {
      sides.push_back({"supple", shading, quality, threads});
    }
  }
  return sides;
}

std::string straight_row_name(const StraightSide& side) {
  return "casters/" + side.shading + "/" + side.renderer + "/" + side.setting + "/" +
         std::to_string(side.threads);
}

std::vector<BenchRow> measure_straight(const std::vector<StraightSide>& sides,
                                       const RoundLimits& limits, Console& console,
                                       const std::function<void()>& before_run) {
  if (!VtkPeer::is_installed()) {
    console.note("VTK is not installed: the rows beside it are left out");
    return {};
  }
  const int threads = sides.front().threads;
  const ThreadLimit limit(threads);
  StraightView view(threads);
  std::vector<BenchRow> rows;
  for (const std::string shading : {"blinn", "none"}) {
    std::vector<StraightSide> of_shading;
    for (const StraightSide& side : sides) {
      if (side.shading == shading) of_shading.push_back(side);
    }
    if (of_shading.empty()) continue;
    for (BenchRow& row : measure_shading(view, of_shading, limits, before_run)) {
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace supple::tools
