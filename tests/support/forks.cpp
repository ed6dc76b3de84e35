#include "tests/support/forks.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace supple::test {

Forks::Forks(const std::string& program, const std::string& library) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error("no socket for the fork server");
  }
  std::vector<std::string> texts = {"LD_PRELOAD=" + library,
                                    "SUPPLE_FORKS=" + std::to_string(ends[1])};
  for (char** text = environ; *text != nullptr; ++text) texts.emplace_back(*text);
  std::vector<char*> environment;
  for (std::string& text : texts) environment.push_back(text.data());
  environment.push_back(nullptr);
  std::string path = program;
  std::array<char*, 2> arguments = {path.data(), nullptr};
  m_server = ::fork();
  if (m_server == 0) {
    ::fcntl(ends[1], F_SETFD, 0);
    ::execve(path.c_str(), arguments.data(), environment.data());
    ::_exit(127);
  }
  ::close(ends[1]);
  m_socket = ends[0];
}

Forks::~Forks() {
  ::close(m_socket);
  ::waitpid(m_server, nullptr, 0);
}

int Forks::run(const std::vector<std::string>& arguments, const std::string& directory,
               const std::array<int, 3>& streams) {
  std::string text = directory + '\0' + std::to_string(arguments.size()) + '\0';
  for (const std::string& argument : arguments) text += argument + '\0';
  for (char** entry = environ; *entry != nullptr; ++entry) text += std::string(*entry) + '\0';
  iovec part = {text.data(), text.size()};
  std::array<char, CMSG_SPACE(sizeof(streams))> control{};
  msghdr message = {};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  cmsghdr* const sent = CMSG_FIRSTHDR(&message);
  sent->cmsg_level = SOL_SOCKET;
  sent->cmsg_type = SCM_RIGHTS;
  sent->cmsg_len = CMSG_LEN(sizeof(streams));
  std::memcpy(CMSG_DATA(sent), streams.data(), sizeof(streams));
  std::int64_t child = 0;
  std::array<std::int64_t, 2> ended{};
  if (::sendmsg(m_socket, &message, MSG_NOSIGNAL) < 0 ||
      ::recv(m_socket, &child, sizeof(child), 0) <= 0 ||
      ::recv(m_socket, ended.data(), sizeof(ended), 0) <= 0) {
    throw std::runtime_error("the fork server has gone");
  }
  return int(ended[0]);
}

}  // namespace supple::test
