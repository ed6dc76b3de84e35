// Runs of a program by a server that forks (fork_server.cpp), in a tenth of the time of a start.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <sys/types.h>

namespace supple::test {

/// Runs a program by a fork server, for one thread; it ends with the thread.
class Forks {
 public:
  /// `library`: the built fork_server.cpp. Throws std::runtime_error.
  Forks(const std::string& program, const std::string& library);
  ~Forks();
  Forks(const Forks&) = delete;
  Forks& operator=(const Forks&) = delete;

  /// The status of the run, as waitpid() tells it, with the environment of this process. Throws
  /// std::runtime_error where the server has gone.
  int run(const std::vector<std::string>& arguments, const std::string& directory,
          const std::array<int, 3>& streams);

 private:
  int m_socket = -1;
  pid_t m_server = -1;
};

}  // namespace supple::test
