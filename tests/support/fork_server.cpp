// A program that is linked once and then forked for every run: the dynamic linker spends most of a
// start of `supple` on the symbols of OpenVDB. Preloaded into the program, this library answers in
// place of main(): it takes requests from the socket whose number is in SUPPLE_FORKS, and runs the
// program's main() in a child for each. The child ends without destructors of libraries, whose
// threads a fork has not copied.
//
// A request is one message: working directory, number of arguments, arguments and environment, each
// ended by a zero byte, and the three standard streams as file descriptors. The answer is one
// message with the child's process number, and one with its status and its peak memory in KiB,
// as 64-bit integers.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

using Main = int (*)(int, char**, char**);
using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
using Streams = std::array<int, 3>;

constexpr std::size_t kMostBytes = std::size_t(1) << 18;
Main g_main = nullptr;

/// The bytes of a request, empty at the end of all.
std::vector<char> receive(int socket, Streams& streams) {
  std::vector<char> text(kMostBytes);
  iovec part = {text.data(), text.size()};
  std::array<char, CMSG_SPACE(sizeof(Streams))> control{};
  msghdr message = {};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t bytes = ::recvmsg(socket, &message, 0);
  const cmsghdr* const sent = CMSG_FIRSTHDR(&message);
  if (bytes <= 0 || sent == nullptr || text[std::size_t(bytes) - 1] != 0) return {};
  std::memcpy(streams.data(), CMSG_DATA(sent), sizeof(Streams));
  text.resize(std::size_t(bytes));
  return text;
}

[[noreturn]] void become(std::vector<char>& text, const Streams& streams) {
  for (int stream = 0; stream < 3; ++stream) ::dup2(streams[std::size_t(stream)], stream);
  for (const int stream : streams) ::close(stream);
  std::vector<char*> strings;
  for (char* s = text.data(); s < text.data() + text.size(); s += std::strlen(s) + 1) {
    strings.push_back(s);
  }
  strings.push_back(nullptr);
  if (::chdir(strings[0]) != 0) ::_exit(126);
  const int count = std::atoi(strings[1]);
  std::vector<char*> arguments(strings.begin() + 2, strings.begin() + 2 + count);
  arguments.push_back(nullptr);
  environ = strings.data() + 2 + count;
  const int code = g_main(count, arguments.data(), environ);
  std::cout.flush();
  std::fflush(nullptr);
  ::_exit(code);
}

int serve(int, char**, char**) {
  const int socket = std::atoi(std::getenv("SUPPLE_FORKS"));
  while (true) {
    Streams streams{};
    std::vector<char> text = receive(socket, streams);
    if (text.empty()) ::_exit(0);
    const pid_t child = ::fork();
    if (child == 0) {
      ::close(socket);
      become(text, streams);
    }
    for (const int stream : streams) ::close(stream);
    const std::int64_t number = child;
    ::send(socket, &number, sizeof(number), MSG_NOSIGNAL);
    int status = 0;
    rusage usage = {};
    ::wait4(child, &status, 0, &usage);
    const std::array<std::int64_t, 2> ended = {status, usage.ru_maxrss};
    ::send(socket, ended.data(), sizeof(ended), MSG_NOSIGNAL);
  }
}

}  // namespace

extern "C" int __libc_start_main(Main main, int count, char** arguments, void (*init)(),
                                 void (*fini)(), void (*linker_fini)(), void* stack_end) {
  g_main = main;
  const auto start = reinterpret_cast<Start>(::dlsym(RTLD_NEXT, "__libc_start_main"));
  return start(std::getenv("SUPPLE_FORKS") != nullptr ? serve : main, count, arguments, init, fini,
               linker_fini, stack_end);
}
