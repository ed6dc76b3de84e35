// The pictures of one view: a single one, a stereo pair, a turntable, or a sequence from rest to
// the deformed state.
#pragma once

#include <string>

#include "tools/scene/pictures/picture_writer.h"
#include "tools/scene/run/view_pictures.h"

namespace supple::tools {

/// Draws all pictures of an effective view and files them; the report is their sum. In picture n of
/// a sequence of N the material lies at X + s u(X), s = n / (N - 1), or sin(2 pi n / N) where it
/// swings: u is scaled and inverted anew,
/// since s o would not be the offset of s u. Throws InputError, with the view's place, for channels
/// that the subject does not have.
void draw_view(const PosedVolume& subject, const SceneView& view, PictureWriter& writer,
               RenderReport* report, Progress& progress);

/// Makes the video of a view in a film, where it wants one, of the files of its frames, so that it
/// is the same whichever runs made those.
void make_video(const SceneView& view, const std::string& folder, PendingFiles& files);

class ViewDrawing;

/// The body in the frames beside one; null: at rest.
struct NeighbourFrames {
  const Displacement* before = nullptr;
  const Displacement* after = nullptr;
};

/// A view in a film: its pictures one by one, its sampling bricks built once.
class FilmView {
 public:
  /// The first frame decides how the camera frames the subject. All that the subjects refer to
  /// stays where it is.
  FilmView(const PosedVolume& first, const SceneView& view, const Film& film, RenderReport* report,
           Progress& progress);
  ~FilmView();

  /// The meshes are those of this frame. Throws as draw_view().
  void draw(const PosedVolume& subject, const std::vector<MeshChoice>& meshes,
            const NeighbourFrames& beside, int frame, PictureWriter& writer);

 private:
  std::unique_ptr<ViewDrawing> m_drawing;
  std::string m_place;
};

}  // namespace supple::tools
