// Programs of other people: they are found, started and asked line by line, and their cost is taken
// from the system.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "volumes/base/files.h"
#include "volumes/base/progress.h"

namespace supple::tools {

/// Cost of a process from its start to its end.
struct ProcessCost {
  double wall_ms = 0;
  /// The largest resident size. Absent when it was not above that of this program, which Linux
  /// counts in until the new one takes over.
  std::optional<double> peak_mbytes;
};

/// One process with its stdin and stdout at hand; stderr is kept for error messages.
class PeerProcess {
 public:
  /// `arguments` begins with the program; `environment` adds NAME=VALUE. Throws SystemError.
  explicit PeerProcess(const std::vector<std::string>& arguments,
                       const std::vector<std::string>& environment = {});
  /// Ends the process when it still runs.
  ~PeerProcess();
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;

  /// The next line that it prints. Throws Error, with its last message, when it ends instead, and
  /// Cancelled when the progress says so.
  std::string read_line(const Progress* progress = nullptr);
  /// Sends a line and returns the next one.
  std::string ask(const std::string& line, const Progress* progress = nullptr);
  /// Ends its stdin and waits. Throws Error when it fails.
  ProcessCost finish();

 private:
  std::string complaint() const;

  ScratchFolder m_scratch;  // of stderr
  std::string m_name;
  int m_pid = -1;
  int m_socket = -1;
  double m_start_ms = 0;
  double m_own_mbytes = 0;
  std::string m_unread;
};

/// The Python that Debian's VTK belongs to.
constexpr const char* kPythonWithVtk = "/usr/bin/python3";
/// True when it has these of VTK's modules.
bool has_python_with_vtk(const std::vector<std::string>& modules);

/// An X server without a screen, for programs that cannot draw without one.
class VirtualDisplay {
 public:
  /// True where Xvfb is installed.
  static bool is_installed();
  /// Lives as long as the thread that makes it. Throws Error when it does not come up.
  VirtualDisplay();

  /// The variable "DISPLAY=:N".
  const std::string& environment() const { return m_environment; }

 private:
  PeerProcess m_server;
  std::string m_environment;
};

}  // namespace supple::tools
