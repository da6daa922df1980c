#include "child_process.hpp"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

extern char** environ;

namespace deltadyn {
namespace {

/// Owns one end of a channel.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() { close(); }
  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_ = -1;
};

/// A connected pair above the three standard numbers, which the child is about to overwrite.
/// Sockets and not pipes: send() with MSG_NOSIGNAL keeps a child that dies early from ending this process by SIGPIPE.
bool open_channel(Descriptor& ours, Descriptor& theirs) {
  std::array<int, 2> fds{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds.data()) != 0) return false;
  const Descriptor first(fds[0]), second(fds[1]);
  ours = Descriptor(::fcntl(first.get(), F_DUPFD_CLOEXEC, 3));
  theirs = Descriptor(::fcntl(second.get(), F_DUPFD_CLOEXEC, 3));
  return ours.get() >= 0 && theirs.get() >= 0;
}

void receive(Descriptor& from, std::string& to) {
  std::array<char, 65536> buffer;
  const ssize_t count = ::read(from.get(), buffer.data(), buffer.size());
  if (count > 0) {
    to.append(buffer.data(), static_cast<std::size_t>(count));
  } else if (count == 0 || (errno != EINTR && errno != EAGAIN)) {
    from.close();
  }
}

/// Writes and reads at the same time, so that neither side waits for the other for ever.
void exchange(Descriptor& in, Descriptor& out, Descriptor& err, std::string_view input, ProcessResult& result) {
  while (out.get() >= 0 || err.get() >= 0 || in.get() >= 0) {
    if (in.get() >= 0 && input.empty()) in.close();  // the end of its input
    std::array<pollfd, 3> polled{{{in.get(), POLLOUT, 0}, {out.get(), POLLIN, 0}, {err.get(), POLLIN, 0}}};
    if (in.get() < 0 && out.get() < 0 && err.get() < 0) return;
    if (::poll(polled.data(), polled.size(), -1) < 0) {
      if (errno == EINTR) continue;
      return;
    }
    if (polled[0].revents != 0) {
      const ssize_t sent = ::send(in.get(), input.data(), input.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent > 0) {
        input.remove_prefix(static_cast<std::size_t>(sent));
      } else if (sent < 0 && errno != EINTR && errno != EAGAIN) {
        in.close();
      }
    }
    if (polled[1].revents != 0) receive(out, result.output);
    if (polled[2].revents != 0) receive(err, result.errors);
  }
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& arguments, std::string_view input) {
  ProcessResult result;
  Descriptor in, out, err, child_in, child_out, child_err;
  if (!open_channel(in, child_in) || !open_channel(out, child_out) || !open_channel(err, child_err)) {
    result.start_error = errno;
    return result;
  }
  std::vector<std::string> copies = arguments;
  std::vector<char*> argv;
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, child_in.get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, child_out.get(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, child_err.get(), STDERR_FILENO);
  pid_t child = 0;
  result.start_error = ::posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (result.start_error != 0) return result;

  child_in.close();
  child_out.close();
  child_err.close();
  exchange(in, out, err, input, result);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace deltadyn
