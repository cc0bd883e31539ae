// Length-delimited frames over an inherited socket: a 32-bit little-endian length, then that many bytes.
#pragma once

#include <mutex>
#include <optional>
#include <string>

namespace fluxfarm {

class FrameSocket {
 public:
  static constexpr std::uint32_t kMaxFrame = 64u << 20;

  // Takes over an open file descriptor.
  explicit FrameSocket(int fd) : fd_(fd) {}

  // The next frame; empty at end of file. One reading thread. Throws Error when a frame is longer than kMaxFrame.
  std::optional<std::string> read();
  // Any thread. False when the peer is gone.
  bool write(const std::string& bytes);

 private:
  bool read_exactly(char* data, std::size_t size);

  int fd_;
  std::mutex write_mutex_;
};

}  // namespace fluxfarm
