// Pictures of every volume of a folder: batch FOLDER OUTPUT_FOLDER
//
// A file that is no volume is named and left out; the exit code says whether there was one.
#include <cstdio>
#include <filesystem>

#include <supple/supple.h>

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: batch FOLDER OUTPUT_FOLDER\n"), 2;
  int failed = 0;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
    const std::string path = entry.path().string();
    if (entry.path().extension() == ".raw") continue;  // of a header beside it
    try {
      const supple::Session session(path);
      const std::string picture =
          (std::filesystem::path(argv[2]) / entry.path().stem()).string() + ".png";
      supple::Look look;
      look.preset = "MR-Default";
      look.width = look.height = 128;
      write_png(picture, show(session.state(), nullptr, look));
      std::printf("%s: %lld elements, %s\n", path.c_str(),
                  static_cast<long long>(session.body().elements.active_count()), picture.c_str());
    } catch (const supple::Error& error) {
      std::fprintf(stderr, "batch: %s\n", error.what());
      ++failed;
    }
  }
  return failed == 0 ? 0 : 1;
}
