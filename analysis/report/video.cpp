#include "analysis/report/video.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/error.hpp"

extern char** environ;

namespace repose {

struct VideoWriter::Impl {
  std::filesystem::path file, part;
  int width = 0, height = 0;
  int socket = -1;
  pid_t child = -1;

  /// The exit status of ffmpeg, which ends when its input does.
  int wait() {
    if (socket >= 0) close(socket);
    socket = -1;
    int status = -1;
    if (child > 0)
      while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
      }
    child = -1;
    return status;
  }
};

bool VideoWriter::available() {
  const char* path = std::getenv("PATH");
  std::string_view rest = path ? path : "";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const std::string program = std::string(rest.substr(0, end)) + "/ffmpeg";
    if (access(program.c_str(), X_OK) == 0) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

VideoWriter::VideoWriter(std::filesystem::path file, int width, int height, double frames_per_second)
    : impl_(std::make_unique<Impl>()) {
  impl_->file = std::move(file);
  impl_->part = impl_->file.string() + ".part";
  impl_->width = width;
  impl_->height = height;
  // A socket, not a pipe: writing to one whose reader has died can be told not to raise SIGPIPE.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw Error("ffmpeg", std::system_category().message(errno), "free some file descriptors", Error::Kind::simulation);
  impl_->socket = ends[0];
  const std::string size = fmt::format("{}x{}", width, height), rate = fmt::format("{}", frames_per_second);
  // H.264 with 4:2:0 colour, which every player knows, needs even sides.
  std::vector<std::string> words{"ffmpeg",
                                 "-hide_banner",
                                 "-loglevel",
                                 "error",
                                 "-y",
                                 "-f",
                                 "rawvideo",
                                 "-pixel_format",
                                 "rgb24",
                                 "-video_size",
                                 size,
                                 "-framerate",
                                 rate,
                                 "-i",
                                 "pipe:0",
                                 "-vf",
                                 "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                 "-pix_fmt",
                                 "yuv420p",
                                 "-c:v",
                                 "libx264",
                                 "-crf",
                                 "20",
                                 "-movflags",
                                 "+faststart",
                                 "-f",
                                 "mp4",
                                 "file:" + impl_->part.string()};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  const int failed = posix_spawnp(&impl_->child, "ffmpeg", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failed) {
    impl_->child = -1;
    impl_->wait();
    throw Error("ffmpeg", std::system_category().message(failed), "install ffmpeg, or choose --format html");
  }
}

VideoWriter::~VideoWriter() {
  if (impl_->child <= 0) return;
  impl_->wait();
  std::error_code ignored;
  std::filesystem::remove(impl_->part, ignored);
}

void VideoWriter::add(const Image& image) {
  if (image.width != impl_->width || image.height != impl_->height)
    throw Error("film", "a picture differs in size from the first", "render all frames at one size");
  const std::uint8_t* data = image.rgb.data();
  std::size_t left = image.rgb.size();
  while (left > 0) {
    const ssize_t sent = send(impl_->socket, data, left, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0)
      throw Error(impl_->file.string(), "ffmpeg stopped reading", "see its message above, or choose --format html",
                  Error::Kind::simulation);
    data += sent;
    left -= static_cast<std::size_t>(sent);
  }
}

void VideoWriter::finish() {
  const int status = impl_->wait();
  std::error_code problem;
  if (status == 0) std::filesystem::rename(impl_->part, impl_->file, problem);
  if (status != 0 || problem) {
    std::error_code ignored;
    std::filesystem::remove(impl_->part, ignored);
    throw Error(impl_->file.string(), "ffmpeg could not write the film",
                "see its message above, or choose --format html", Error::Kind::simulation);
  }
}

}  // namespace repose
