// The sandbox, from inside: each test runs in a process of its own, once shut in and, to see that there is something to forbid,
// once not.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "support/error.h"
#include "worker/sandbox.h"

namespace fluxfarm {
namespace {

namespace fs = std::filesystem;

class SandboxTest : public ::testing::Test {
 protected:
  SandboxTest() {
    for (const char* name : {"scenes", "jobs", "other"}) fs::create_directories(root_ / name);
    std::ofstream(root_ / "scenes" / "scene.xml") << "<scene/>";
    std::ofstream(root_ / "owner.key") << "secret";
  }
  ~SandboxTest() override { fs::remove_all(root_); }

  // Whether `attempt` succeeds in a new process, shut in or not.
  bool succeeds(bool inside, const std::function<bool()>& attempt, std::uint64_t memory = 0) const {
    const pid_t child = fork();
    if (child == 0) {
      if (inside && !enter_sandbox({{root_ / "scenes"}, {root_ / "jobs"}, memory}).empty()) _exit(2);
      _exit(attempt() ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
    EXPECT_NE(WEXITSTATUS(status), 2) << "this kernel has no such sandbox";
    return WEXITSTATUS(status) == 0;
  }

  void forbids(const char* what, const std::function<bool()>& attempt) const {
    EXPECT_TRUE(succeeds(false, attempt)) << what << ": nothing to forbid";
    EXPECT_FALSE(succeeds(true, attempt)) << what;
  }

  static bool opens(const fs::path& path, int flags) {
    const int file = open(path.c_str(), flags, 0600);
    if (file >= 0) close(file);
    return file >= 0;
  }

  fs::path root_ = fs::temp_directory_path() / ("fluxfarm-sandbox-" + std::to_string(getpid()));
};

TEST_F(SandboxTest, OpensNothingOutsideItsFolders) {
  forbids("passwords", [] { return opens("/etc/passwd", O_RDONLY); });
  forbids("the owner's key", [&] { return opens(root_ / "owner.key", O_RDONLY); });
  forbids("its environment", [] { return opens("/proc/self/environ", O_RDONLY); });
  forbids("a list of files", [] { return opens("/", O_RDONLY | O_DIRECTORY); });
  forbids("a new file elsewhere", [&] { return opens(root_ / "other" / "new", O_WRONLY | O_CREAT); });
  forbids("a change of the scene", [&] { return opens(root_ / "scenes" / "scene.xml", O_WRONLY); });
}

TEST_F(SandboxTest, RunsNoProgramAndNoProcess) {
  forbids("a shell", [] {
    execl("/bin/sh", "sh", "-c", "exit 0", nullptr);
    return false;
  });
  forbids("a process", [] {
    const pid_t child = fork();
    if (child == 0) _exit(0);
    return child > 0 && waitpid(child, nullptr, 0) == child;
  });
  forbids("a signal to its parent", [] { return kill(getppid(), 0) == 0; });
}

TEST_F(SandboxTest, HasNoNetwork) {
  forbids("an internet socket", [] { return socket(AF_INET, SOCK_STREAM, 0) >= 0; });
  forbids("a socket of this machine", [] { return socket(AF_UNIX, SOCK_STREAM, 0) >= 0; });
}

TEST_F(SandboxTest, ReadsScenesWritesResultsAndTalksOnTheSocketThatItHas) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  EXPECT_TRUE(succeeds(true, [&] {
    std::string text;
    std::getline(std::ifstream(root_ / "scenes" / "scene.xml"), text);
    std::ofstream(root_ / "jobs" / "tile") << text;
    bool written = false;
    std::thread([&] { written = send(ends[0], "x", 1, MSG_NOSIGNAL) == 1; }).join();
    return written && text == "<scene/>" && unlink((root_ / "jobs" / "tile").c_str()) == 0;
  }));
  char sent = 0;
  EXPECT_EQ(recv(ends[1], &sent, 1, MSG_DONTWAIT), 1);
}

TEST_F(SandboxTest, MemoryEndsWithBadAllocAndNotWithTheMachine) {
  const auto take = [] {
    try {
      const std::vector<char> much(std::size_t{1} << 29, 'x');
      return much.back() == 'x';
    } catch (const std::bad_alloc&) {
      return false;
    }
  };
  EXPECT_TRUE(succeeds(true, take));
  EXPECT_FALSE(succeeds(true, take, std::uint64_t{1} << 28));
}

TEST_F(SandboxTest, RefusesAFolderThatIsNotThere) {
  EXPECT_TRUE(succeeds(false, [&] {
    try {
      enter_sandbox({{root_ / "nowhere"}, {}, 0});
    } catch (const ResourceError& error) {
      return std::string(error.what()).find("nowhere") != std::string::npos;
    }
    return false;
  }));
}

}  // namespace
}  // namespace fluxfarm
