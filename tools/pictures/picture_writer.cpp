#include "tools/pictures/picture_writer.h"

#include "raycast/drawings/value_images.h"

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
  if (kind == PictureKind::video) return add_to_video(drawn);
  const std::string image = m_options.is_series() ? frame_name(m_image, drawn.frame) : m_image;
  const AtomicFile& file = m_files.add(image);
  if (kind == PictureKind::exr) {
    write_exr(file, drawn.picture, drawn.configuration);
  } else if (m_options.bits == 16) {
    write_png16(file, drawn.picture, drawn.configuration);
  } else {
    write_png(file, to_image(drawn.picture), drawn.configuration);
  }
  write_aux(drawn, image);
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

void PictureWriter::add_to_video(const DrawnPicture& drawn) {
  if (m_video == nullptr) {
    m_video = std::make_unique<VideoEncoder>(m_files.add(m_image).path(), m_image,
                                             drawn.picture.width, drawn.picture.height,
                                             m_options.frames_per_second, drawn.configuration);
  }
  m_video->add(to_image(drawn.picture));
}

void PictureWriter::finish() {
  if (m_video != nullptr) m_video->finish();
  m_video.reset();
}

}  // namespace supple::tools
