#include "tools/scene/pictures/picture_writer.h"

#include "raycast/drawings/value_images.h"
#include "volumes/base/error.h"

namespace supple::tools {

const AtomicFile& PendingFiles::add(const std::string& final_path) {
  m_folders.make(std::filesystem::path(final_path).parent_path());
  return m_files.emplace_back(final_path);
}

void PendingFiles::commit() {
  const CommonCommit all;
  for (AtomicFile& file : m_files) file.commit();
  m_files.clear();
  m_folders.keep();
}

void PictureWriter::write(const DrawnPicture& drawn) {
  const PictureKind kind = picture_kind(m_image);
  const std::string image = m_options.is_series() ? frame_name(m_image, drawn.frame) : m_image;
  if (kind == PictureKind::exr) {
    const double fps = m_options.is_series() ? m_options.frames_per_second : 0;
    write_exr(m_files.add(image), drawn.picture,
              {drawn.configuration, m_options.bits == 16, drawn.camera, fps});
  } else if (m_options.bits == 16) {
    write_png16(m_files.add(image), drawn.picture, drawn.configuration);
  } else {
    write(to_image(drawn.picture), drawn.frame, drawn.configuration);
  }
  write_aux(drawn, image);
}

void PictureWriter::write(const Image& image, int frame, const std::string& configuration) {
  if (picture_kind(m_image) == PictureKind::video) return add_to_video(image, configuration);
  const std::string name = m_options.is_series() ? frame_name(m_image, frame) : m_image;
  write_png(m_files.add(name), image, configuration);
}

void PictureWriter::write_aux(const DrawnPicture& drawn, const std::string& image) {
  const FloatImage& picture = drawn.picture;
  const Vec3f eye(drawn.towards_camera_lps);
  for (const std::string& channel : m_options.maps()) {
    const AtomicFile& file = m_files.add(aux_name(image, channel));
    const Image shown = channel == "depth" ? depth_image(picture, range_of(picture.depth_mm))
                        : channel == "normal"
                            ? normal_image(picture)
                            : offset_image(picture, drawn.offset_range_mm, {eye.x, eye.y, eye.z});
    write_png(file, shown, drawn.configuration);
  }
}

void PictureWriter::add_to_video(const Image& image, const std::string& configuration) {
  if (m_video == nullptr) {
    m_video =
        std::make_unique<VideoEncoder>(m_files.add(m_image).path(), m_image, image.width,
                                       image.height, m_options.frames_per_second, configuration);
  }
  m_video->add(image);
}

void PictureWriter::finish() {
  if (m_video != nullptr) m_video->finish();
  m_video.reset();
}

namespace {

PictureOptions series_options(double frames_per_second, const std::string& name,
                              const std::string& place) {
  PictureOptions options;
  options.sequence = kMostFrames;
  options.frames_per_second = frames_per_second;
  check_picture_options(options, name, place);
  if (picture_kind(name) == PictureKind::exr) {
    throw InputError({place, "film", name, "extension .png, .mp4, .webm or .avi"});
  }
  return options;
}

}  // namespace

PictureSeries::PictureSeries(std::string name, double frames_per_second, const std::string& place)
    : m_options(series_options(frames_per_second, name, place)),
      m_name(std::move(name)),
      m_writer(m_files, m_name, m_options) {}

std::vector<std::string> PictureSeries::files(int length) const {
  PictureOptions options = m_options;
  options.sequence = length;
  return picture_files(options, m_name);
}

void PictureSeries::add(const Image& image) {
  m_writer.write(image, m_length++, "");
}

void PictureSeries::finish() {
  m_writer.finish();
}

void PictureSeries::commit() {
  finish();
  m_files.commit();
}

}  // namespace supple::tools
