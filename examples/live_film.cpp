// A journal or a scene as a live session with pictures: live_film JOURNAL FOLDER
//
// After each event a first picture within 50 ms, and the settled one, which is that of the program.
#include <cstdio>

#include <supple/raycast/pictures/image.h>
#include <supple/scene/live/live_picture.h>
#include <supple/scene/live/live_session.h>
#include <supple/volumes/base/table.h>

namespace {

class Silent final : public supple::Progress {
 public:
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return false; }
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "usage: live_film JOURNAL FOLDER\n"), 2;
  // [film]
  Silent listener;
  supple::tools::LiveSession live(supple::Table::read(argv[1]), nullptr);
  supple::tools::LivePicture picture(live.session(), live.view(), listener);
  int frame = 0;
  for (const supple::tools::LiveEvent& event : live.events()) {
    live.carry_out(event);
    while (live.has_more()) live.go_on();
    picture.look(live.view());
    picture.follow();
    constexpr double kBudgetMs = 50;
    picture.prepare(kBudgetMs);
    const supple::Image first = picture.first_pixels(kBudgetMs);
    while (picture.refine()) {
    }
    const std::string path = std::string(argv[2]) + "/" + std::to_string(frame++) + ".png";
    write_png(path, *picture.settled());
    std::printf("%s: first %d pixels wide\n", path.c_str(), first.width);
  }
  // [film]
  return 0;
} catch (const supple::Error& error) {
  return std::fprintf(stderr, "live_film: %s\n", error.what()), 1;
}
