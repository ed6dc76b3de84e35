// Pictures as files that appear all at once: each is written under a temporary name when it is
// drawn, so that a long series takes no memory and a failure leaves nothing.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "raycast/pictures/colour_map.h"
#include "tools/scene/pictures/picture_options.h"
#include "tools/scene/pictures/video.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/files.h"

namespace supple::tools {

/// Files under temporary names, and the folders made for them. Files that are not committed vanish.
class PendingFiles {
 public:
  PendingFiles() = default;
  PendingFiles(const PendingFiles&) = delete;
  PendingFiles& operator=(const PendingFiles&) = delete;

  /// A file to write to; missing folders are made. Throws as AtomicFile.
  const AtomicFile& add(const std::string& final_path);
  void commit();

 private:
  MadeFolders m_folders;  // outlive the files
  std::deque<AtomicFile> m_files;
};

/// One picture of a view, and the record in its file.
struct DrawnPicture {
  const FloatImage& picture;
  int frame;  // from 0
  std::string configuration;
  ScalarRange offset_range_mm;
  Vec3d towards_camera_lps;
  std::vector<RowMatrix> camera = {};  // ExrFacts::camera
};

/// Files the pictures of one view.
class PictureWriter {
 public:
  PictureWriter(PendingFiles& files, std::string image, const PictureOptions& options)
      : m_files(files), m_image(std::move(image)), m_options(options) {}

  void write(const DrawnPicture& drawn);
  /// Writes the next picture of a series of 8 bits with nothing beside it, into a file of its own
  /// or into the video.
  void write(const Image& image, int frame, const std::string& configuration);
  /// Ends the series after the last picture; a video is complete then.
  void finish();

 private:
  void write_aux(const DrawnPicture& drawn, const std::string& image);
  void add_to_video(const Image& image, const std::string& configuration);

  PendingFiles& m_files;
  std::string m_image;
  PictureOptions m_options;
  std::unique_ptr<VideoEncoder> m_video;
};

/// Pictures of 8 bits as numbered PNG files or a video, which appear when all are made.
class PictureSeries {
 public:
  /// `name` has a place for a number (`a_%03d.png`) or is that of a video. Throws as
  /// check_picture_options, naming `place`.
  PictureSeries(std::string name, double frames_per_second, const std::string& place);
  /// Lists the files that this many pictures become.
  std::vector<std::string> files(int length) const;
  void add(const Image& image);
  /// Ends the series: its files are complete then, under temporary names.
  void finish();
  void commit();

 private:
  PictureOptions m_options;
  std::string m_name;
  PendingFiles m_files;
  PictureWriter m_writer;
  int m_length = 0;
};

}  // namespace supple::tools
