#include "tools/console/own_process.h"

#include <filesystem>
#include <fstream>

namespace supple::tools {

std::string own_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

double peak_rss_mb() {
  // getrusage() would count what the parent held when it started this program.
  std::ifstream stream("/proc/self/status");
  const std::string name = "VmHWM:";
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(name, 0) == 0) return std::stod(line.substr(name.size())) * 1024 / 1e6;
  }
  return 0;
}

}  // namespace supple::tools
