#include "worker/frame_socket.h"

#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

#include "support/error.h"

namespace fluxfarm {

bool FrameSocket::read_exactly(char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t got = ::read(fd_, data, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    data += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

std::optional<std::string> FrameSocket::read() {
  unsigned char header[4];
  if (!read_exactly(reinterpret_cast<char*>(header), sizeof header)) return std::nullopt;
  const std::uint32_t size = header[0] | header[1] << 8 | header[2] << 16 | static_cast<std::uint32_t>(header[3]) << 24;
  if (size > kMaxFrame) throw Error("frame of " + std::to_string(size) + " bytes, expected at most " + std::to_string(kMaxFrame));
  std::string bytes(size, '\0');
  if (!read_exactly(bytes.data(), size)) return std::nullopt;
  return bytes;
}

bool FrameSocket::write(const std::string& bytes) {
  const auto size = static_cast<std::uint32_t>(bytes.size());
  std::string frame{static_cast<char>(size), static_cast<char>(size >> 8), static_cast<char>(size >> 16),
                    static_cast<char>(size >> 24)};
  frame += bytes;
  const std::lock_guard lock(write_mutex_);
  const char* data = frame.data();
  std::size_t left = frame.size();
  while (left > 0) {
    const ssize_t sent = ::send(fd_, data, left, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    data += sent;
    left -= static_cast<std::size_t>(sent);
  }
  return true;
}

}  // namespace fluxfarm
