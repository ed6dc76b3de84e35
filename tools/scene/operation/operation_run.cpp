#include "tools/scene/operation/operation_run.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "raycast/pictures/compare.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/live/replay.h"
#include "tools/scene/operation/operated_volume.h"
#include "tools/scene/operation/operation_picture.h"
#include "tools/scene/operation/operation_record.h"
#include "tools/scene/pictures/picture_writer.h"
#include "tools/scene/run/scene_files.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/base/error.h"
#include "volumes/base/memory.h"
#include "volumes/base/stopwatch.h"

namespace supple::tools {

namespace {

/// A video of one view; two for two streams.
class ViewVideo {
 public:
  ViewVideo(const MicroscopeView& view, const std::string& folder, double frames_per_second)
      : m_view(view) {
    for (const std::string& name : video_names(view)) {
      m_series.push_back(
          std::make_unique<PictureSeries>(path_in(folder, name), frames_per_second, view.place));
    }
  }

  void add(OperationPicture& picture, double time_s) {
    const Image& image = picture.draw(m_view, time_s);
    if (m_series.size() == 1) return m_series[0]->add(image);
    m_series[0]->add(half_of(image, false));
    m_series[1]->add(half_of(image, true));
  }

  std::vector<std::string> files(int length) const {
    std::vector<std::string> all;
    for (const auto& one : m_series) {
      const std::vector<std::string> files = one->files(length);
      all.insert(all.end(), files.begin(), files.end());
    }
    return all;
  }

  /// Makes the files complete, under temporary names.
  void finish() {
    for (const auto& one : m_series) one->finish();
  }
  void commit() {
    for (const auto& one : m_series) one->commit();
  }

 private:
  static std::vector<std::string> video_names(const MicroscopeView& view) {
    if (view.stereo != StereoKind::two_streams) return {view.video};
    const std::filesystem::path path(view.video);
    const std::string stem = (path.parent_path() / path.stem()).string();
    return {stem + "_left" + path.extension().string(),
            stem + "_right" + path.extension().string()};
  }

  const MicroscopeView& m_view;
  std::vector<std::unique_ptr<PictureSeries>> m_series;
};

Value times_value(const std::vector<float>& ms) {
  const std::vector<double> values(ms.begin(), ms.end());
  return {{"median_ms", quantile(values, 0.5)},
          {"p95_ms", quantile(values, 0.95)},
          {"max_ms", quantile(values, 1)}};
}

/// An operation whose errors name the scene's file.
Operation operation_of(const OperationScene& scene, OperatedVolume* volume) {
  try {
    return Operation(volume == nullptr ? scene.setup : volume->joined_to(scene.setup));
  } catch (const InputError& error) {
    Problem problem = error.problem();
    if (problem.file.empty()) problem.file = scene.file;
    throw InputError(problem);
  }
}

double load_now() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : 0;
}

}  // namespace

struct OperationRun::Impl {
  const OperationScene& scene;
  std::string folder;
  OperationOptions options;
  std::unique_ptr<OperatedVolume> volume;  // where there is one
  Operation operation;
  OperationRecord record;
  std::unique_ptr<OperationPicture> picture;  // where something is drawn
  OperationPhases phases;
  double memory_at_start_mb = 0, memory_at_middle_mb = 0;
  int steps = 0;
  double wall_s = 0, settled_ssim = 1;
  Image last;  // of the scanned volume

  Impl(const OperationScene& given, std::string to, const OperationOptions& wanted,
       Progress& progress)
      : scene(given),
        folder(std::move(to)),
        options(wanted),
        volume(given.volume ? std::make_unique<OperatedVolume>(given, folder, progress) : nullptr),
        operation(operation_of(given, volume.get())),
        record(given, operation) {}

  bool draws() const {
    if (options.draws_every_step) return !scene.volume;
    return std::any_of(scene.views.begin(), scene.views.end(), [&](const MicroscopeView& view) {
      return !view.image.empty() || (options.makes_videos && !view.video.empty());
    });
  }
  std::vector<ViewVideo> videos() const {
    std::vector<ViewVideo> all;
    if (!options.makes_videos) return all;
    for (const MicroscopeView& view : scene.views) {
      if (!view.video.empty()) all.emplace_back(view, folder, scene.frames_per_second);
    }
    return all;
  }
  /// Pictures of every step, each brought up to the step's state.
  double pictures_per_s() const {
    const double ms = std::accumulate(phases.picture.begin(), phases.picture.end(), 0.0) +
                      std::accumulate(phases.update.begin(), phases.update.end(), 0.0);
    return 1000 * double(phases.picture.size()) / ms;
  }
  void step(int n);
  double ssim_of_settled();
  void draw_volume(int frame);
  void draw_step(int n, std::vector<ViewVideo>& videos, int& frames);
  void write_images(PendingFiles& files);
  void write_files(std::vector<ViewVideo>& videos);
};

/// One step and what follows of it for tasks, log and scores.
void OperationRun::Impl::step(int n) {
  const double time_s = (n + 1) * scene.setup.step_s;
  const std::vector<InstrumentPose> asked = scene.poses_at(time_s);
  operation.step(asked);
  record.take(operation, asked);
  phases.contact.push_back(float(operation.times().contact_ms));
  phases.vitreous.push_back(float(operation.times().vitreous_ms));
  if (volume) phases.volume.push_back(float(operation.times().volume_ms));
  phases.membranes.push_back(float(operation.times().membranes_ms));
  phases.step.push_back(float(operation.times().total_ms));
}

void OperationRun::Impl::draw_volume(int frame) {
  if (!options.volume_view) return volume->draw_frame(operation, frame);
  const Stopwatch drawing;
  last = volume->draw(operation, *options.volume_view, frame);
  phases.picture.push_back(float(drawing.ms()));
}

void OperationRun::Impl::draw_step(int n, std::vector<ViewVideo>& videos, int& frames) {
  const double time_s = (n + 1) * scene.setup.step_s;
  const bool is_due = time_s * scene.frames_per_second >= frames + 1 - 1e-9;
  if (volume) {
    if (is_due && frames < scene.frame_count()) draw_volume(frames++);
    return;
  }
  if (!picture) return;
  const bool is_frame = !videos.empty() && is_due;
  if (!is_frame && !options.draws_every_step && n + 1 < scene.step_count()) return;
  const Stopwatch update;
  picture->follow(operation, record.balls());
  phases.update.push_back(float(update.ms()));
  if (options.draws_every_step && !scene.views.empty()) {
    const Stopwatch drawing;
    picture->draw(scene.views.front(), time_s);
    phases.picture.push_back(float(drawing.ms()));
  }
  if (!is_frame) return;
  for (ViewVideo& video : videos) video.add(*picture, time_s);
  ++frames;
}

/// How near the last picture is to what it would be with time enough.
double OperationRun::Impl::ssim_of_settled() {
  MicroscopeView view = scene.views.front();
  const double time_s = operation.sample().time_s;
  const Image drawn = picture->draw(view, time_s);
  view.is_settled = true;
  return compare(drawn, picture->draw(view, time_s), false).ssim;
}

void OperationRun::Impl::write_images(PendingFiles& files) {
  if (!options.volume_image.empty()) {
    if (last.width == 0) draw_volume(0);  // shorter than a frame
    write_png(files.add(path_in(folder, options.volume_image)), last, "");
  }
  for (const MicroscopeView& view : scene.views) {
    if (view.image.empty()) continue;
    write_png(files.add(path_in(folder, view.image)),
              picture->draw(view, operation.sample().time_s), "");
  }
}

/// All outputs get their names together, after the last of them is complete.
void OperationRun::Impl::write_files(std::vector<ViewVideo>& videos) {
  PendingFiles files;
  write_images(files);
  record.write(folder, files);
  if (volume) volume->make_videos(files);
  for (ViewVideo& video : videos) video.finish();
  const CommonCommit all;
  record.commit();
  for (ViewVideo& video : videos) video.commit();
  files.commit();
}

OperationRun::OperationRun(const OperationScene& scene, std::string folder,
                           const OperationOptions& options, Progress& progress)
    : m_impl(std::make_unique<Impl>(scene, std::move(folder), options, progress)) {}
OperationRun::~OperationRun() = default;

OutputPlan OperationRun::plan(bool may_overwrite) const {
  const Impl& in = *m_impl;
  OutputPlan plan = in.scene.volume ? check_scene(*in.scene.volume, in.folder, may_overwrite)
                                    : OutputPlan(may_overwrite, true);
  plan.protect(in.scene.file);
  for (const MicroscopeView& view : in.scene.views) {
    if (!view.image.empty()) plan.add_image(path_in(in.folder, view.image));
  }
  if (!in.options.volume_image.empty()) {
    plan.add_image(path_in(in.folder, in.options.volume_image));
  }
  for (const ViewVideo& video : in.videos()) plan.add_files(video.files(in.scene.frame_count()));
  in.record.plan(in.folder, plan);
  return plan;
}

void OperationRun::run(Progress& progress) {
  Impl& in = *m_impl;
  const int count = in.scene.step_count();
  const Stopwatch whole;
  if (in.draws()) in.picture = std::make_unique<OperationPicture>(in.scene, in.operation);
  std::vector<ViewVideo> videos = in.videos();
  in.record.open(in.folder);
  progress.stage("operating");
  int frames = 0;
  for (int n = 0; n < count; ++n) {
    supple::report(&progress, double(n) / count);
    in.step(n);
    in.draw_step(n, videos, frames);
    ++in.steps;
    if (n == count / 10) in.memory_at_start_mb = peak_rss_mb();
    if (n == count / 2) in.memory_at_middle_mb = peak_rss_mb();
  }
  in.write_files(videos);
  in.wall_s = whole.ms() / 1000;
  if (in.picture && !in.phases.picture.empty()) in.settled_ssim = in.ssim_of_settled();
}

const Operation& OperationRun::operation() const {
  return m_impl->operation;
}

Value OperationRun::report() const {
  const Impl& in = *m_impl;
  Value times = {{"contact", times_value(in.phases.contact)},
                 {"vitreous", times_value(in.phases.vitreous)},
                 {"membranes", times_value(in.phases.membranes)},
                 {"step", times_value(in.phases.step)}};
  if (!in.phases.volume.empty()) times["volume"] = times_value(in.phases.volume);
  if (!in.phases.update.empty()) times["update"] = times_value(in.phases.update);
  if (!in.phases.picture.empty()) times["picture"] = times_value(in.phases.picture);
  Value report = {{"steps", in.steps},
                  {"time_s", in.operation.sample().time_s},
                  {"wall_s", in.wall_s},
                  {"load", load_now()},
                  {"times", times},
                  {"memory_mb",
                   {{"at_a_tenth", in.memory_at_start_mb},
                    {"at_half", in.memory_at_middle_mb},
                    {"at_the_end", peak_rss_mb()}}},
                  {"digest", in.operation.digest()}};
  if (!in.phases.picture.empty()) {
    report["pictures_per_s"] = in.pictures_per_s();
    report["pairs"] = false;
  }
  if (in.picture && !in.phases.picture.empty()) {
    report["pairs"] = in.scene.views.front().stereo != StereoKind::none;
    report["settled_ssim"] = in.settled_ssim;
  }
  if (in.volume) report["elements"] = in.volume->element_count();
  report.update(in.record.report());
  return report;
}

}  // namespace supple::tools
