#include "tests/support/program.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/forks.h"

namespace supple::test {

namespace {

constexpr int kForOutput = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC;

/// Sets limits, working directory and standard streams in the child, and calls exec.
[[noreturn]] void become(const std::vector<std::string>& arguments, const RunOptions& options,
                         const std::string& out, const std::string& err) {
  if (options.max_file_bytes >= 0) {
    const rlimit limit = {rlim_t(options.max_file_bytes), rlim_t(options.max_file_bytes)};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  if (!options.directory.empty() && ::chdir(options.directory.c_str()) != 0) ::_exit(126);
  ::dup2(::open(out.c_str(), kForOutput, 0600), STDOUT_FILENO);
  ::dup2(::open(err.c_str(), kForOutput, 0600), STDERR_FILENO);
  ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
  if (options.as_nobody && ::getuid() == 0 && ::setuid(65534) != 0) ::_exit(126);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

/// Status of a run by this thread's fork server; nothing where the tests are run without one.
std::optional<int> status_of_fork(const std::vector<std::string>& arguments,
                                  const RunOptions& options, const std::string& out,
                                  const std::string& err) {
  const char* const library = std::getenv("SUPPLE_FORK_SERVER");
  const char* const binary = std::getenv("SUPPLE_BINARY");
  const bool is_plain = options.max_file_bytes < 0 && !options.as_nobody &&
                        options.interrupt_after_s < 0 && options.interrupt_at_file.empty() &&
                        !options.count_threads;
  if (library == nullptr || binary == nullptr || arguments[0] != binary || !is_plain) return {};
  thread_local Forks forks(binary, library);
  const std::string directory =
      options.directory.empty() ? std::filesystem::current_path().string() : options.directory;
  const std::array<int, 3> streams = {::open("/dev/null", O_RDONLY | O_CLOEXEC),
                                      ::open(out.c_str(), kForOutput, 0600),
                                      ::open(err.c_str(), kForOutput, 0600)};
  const int status = forks.run(arguments, directory, streams);
  for (const int stream : streams) ::close(stream);
  return status;
}

/// The most threads that a child has at a time, until it ends.
int most_threads(pid_t child) {
  const std::string status = "/proc/" + std::to_string(child) + "/status";
  const std::string key = "Threads:";
  int most = 0;
  for (siginfo_t ended{};; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
    ::waitid(P_PID, id_t(child), &ended, WEXITED | WNOHANG | WNOWAIT);
    if (ended.si_pid == child) return most;
    std::ifstream lines(status);
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind(key, 0) == 0) most = std::max(most, std::stoi(line.substr(key.size())));
    }
  }
}

/// Status of a run in a process of its own, and its most threads where they are asked for.
int status_of_start(const std::vector<std::string>& arguments, const RunOptions& options,
                    const std::string& out, const std::string& err, int& threads) {
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) become(arguments, options, out, err);
  if (!options.interrupt_at_file.empty()) {
    siginfo_t ended = {};
    while (ended.si_pid == 0 && !std::filesystem::exists(options.interrupt_at_file)) {
      ::waitid(P_PID, id_t(child), &ended, WEXITED | WNOHANG | WNOWAIT);
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  }
  if (options.interrupt_after_s >= 0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(options.interrupt_after_s));
  }
  if (options.interrupt_after_s >= 0 || !options.interrupt_at_file.empty()) {
    ::kill(child, options.interrupt_by);
  }
  if (options.count_threads) threads = most_threads(child);
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

}  // namespace

Outcome run_program(const std::vector<std::string>& arguments, const RunOptions& options) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", err = folder / "err";
  Outcome outcome;
  const std::optional<int> forked = status_of_fork(arguments, options, out, err);
  const int status =
      forked ? *forked : status_of_start(arguments, options, out, err, outcome.threads);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_text(out);
  outcome.err = read_text(err);
  return outcome;
}

Outcome run_supple(const std::vector<std::string>& arguments, const RunOptions& options) {
  const char* binary = std::getenv("SUPPLE_BINARY");
  if (binary == nullptr) throw std::runtime_error("run the tests through ctest");
  std::vector<std::string> all = {binary};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return run_program(all, options);
}

bool runs(const std::string& command) {
  return std::system((command + " > /dev/null 2>&1").c_str()) == 0;
}

bool runs_python(const std::string& arguments) {
  return std::system(("/usr/bin/python3 " + arguments + " > /dev/null").c_str()) == 0;
}

void write_ball(const TemporaryFolder& folder, const std::string& name, int size) {
  std::string voxels;
  const double center = 0.5 * (size - 1), radius = 0.38 * size;
  for (int k = 0; k < size; ++k) {
    for (int j = 0; j < size; ++j) {
      for (int i = 0; i < size; ++i) {
        const double distance = std::hypot(i - center, std::hypot(j - center, k - center));
        const double inside = std::clamp(radius - distance, 0.0, 2.0) / 2;
        voxels += char(static_cast<unsigned char>(std::lround(200 * inside)));
      }
    }
  }
  const std::string dim = std::to_string(size);
  write_text(folder / (name + ".raw"), voxels);
  write_text(folder / (name + ".nhdr"),
             "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: " + dim +
                 " " + dim + " " + dim +
                 "\nspace directions: (1,0,0) (0,1,0) (0,0,1.5)\nspace origin: (0,0,0)\n"
                 "encoding: raw\ndata file: " +
                 name + ".raw\n");
}

void write_soft_material(const std::string& path) {
  write_text(path,
             "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.3]]\n"
             "min_length = [[0, 0.7]]\nshear = [[0, 0.3]]\n");
}

std::string source_dir() {
  const char* folder = std::getenv("SUPPLE_SOURCE_DIR");
  if (folder == nullptr) throw std::runtime_error("run the tests through ctest");
  return folder;
}

std::string public_volume(const std::string& name) {
  const char* source = std::getenv("SUPPLE_SOURCE_DIR");  // none when started by hand
  const std::string fetched = std::string(source != nullptr ? source : ".") + "/build/data/";
  for (const std::string& folder : {fetched, std::string("/usr/share/mricron/templates/")}) {
    if (std::filesystem::exists(folder + name)) return folder + name;
  }
  return "";
}

}  // namespace supple::test
