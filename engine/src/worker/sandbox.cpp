#include "worker/sandbox.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "support/error.h"

namespace fluxfarm {
namespace {

// Newer than the headers of Debian 12.
constexpr std::uint64_t kTruncate = 1ull << 14;

constexpr std::uint64_t kReadFile = LANDLOCK_ACCESS_FS_READ_FILE;
constexpr std::uint64_t kReadFolder = kReadFile | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t kWriteFolder =
    kReadFolder | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_REMOVE_FILE | kTruncate;
// Of the first version: all bits up to that of making symbolic links.
constexpr std::uint64_t kAllOfFirstVersion = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;

// What libraries read: more libraries, and how many processors and how much memory there are.
constexpr std::array kSystemFolders = {"/usr/lib", "/usr/lib64", "/usr/share", "/lib", "/lib64", "/sys/devices/system"};
constexpr std::array kSystemFiles = {"/etc/ld.so.cache", "/proc/cpuinfo", "/proc/meminfo",
                                     "/proc/stat",       "/dev/urandom",  "/dev/null"};

// By what they are for: files, memory, threads, signals, time, the inherited socket, facts of the machine, the end.
constexpr std::array kCalls = {"read",
                               "write",
                               "readv",
                               "writev",
                               "pread64",
                               "pwrite64",
                               "preadv",
                               "pwritev",
                               "lseek",
                               "open",
                               "openat",
                               "close",
                               "fstat",
                               "newfstatat",
                               "stat",
                               "lstat",
                               "statx",
                               "access",
                               "faccessat",
                               "faccessat2",
                               "readlink",
                               "readlinkat",
                               "getdents64",
                               "getcwd",
                               "fcntl",
                               "ftruncate",
                               "fallocate",
                               "fadvise64",
                               "fsync",
                               "fdatasync",
                               "rename",
                               "renameat",
                               "renameat2",
                               "unlink",
                               "unlinkat",
                               "dup",
                               "dup2",
                               "dup3",
                               "statfs",
                               "fstatfs",
                               "mmap",
                               "munmap",
                               "mprotect",
                               "mremap",
                               "madvise",
                               "brk",
                               "msync",
                               "mlock",
                               "munlock",
                               "mincore",
                               "set_mempolicy",
                               "get_mempolicy",
                               "mbind",
                               "futex",
                               "set_robust_list",
                               "get_robust_list",
                               "rseq",
                               "membarrier",
                               "sched_yield",
                               "sched_getaffinity",
                               "sched_setaffinity",
                               "sched_getparam",
                               "sched_getscheduler",
                               "gettid",
                               "getpid",
                               "getppid",
                               "set_tid_address",
                               "arch_prctl",
                               "getcpu",
                               "poll",
                               "ppoll",
                               "select",
                               "pselect6",
                               "eventfd2",
                               "pipe2",
                               "rt_sigaction",
                               "rt_sigprocmask",
                               "rt_sigreturn",
                               "rt_sigpending",
                               "rt_sigtimedwait",
                               "sigaltstack",
                               "pause",
                               "restart_syscall",
                               "nanosleep",
                               "clock_nanosleep",
                               "clock_gettime",
                               "clock_getres",
                               "gettimeofday",
                               "time",
                               "times",
                               "sendto",
                               "recvfrom",
                               "sendmsg",
                               "recvmsg",
                               "shutdown",
                               "getsockopt",
                               "getuid",
                               "geteuid",
                               "getgid",
                               "getegid",
                               "getrandom",
                               "getrusage",
                               "getrlimit",
                               "sysinfo",
                               "uname",
                               "exit",
                               "exit_group"};

std::string because(const char* what) { return std::string(what) + " (" + std::strerror(errno) + ")"; }

void set_limit(decltype(RLIMIT_CORE) what, rlim_t most) {
  rlimit limit{};
  if (getrlimit(what, &limit) != 0) return;
  limit.rlim_max = std::min(limit.rlim_max, most);
  limit.rlim_cur = limit.rlim_max;
  setrlimit(what, &limit);
}

class Ruleset {
 public:
  Ruleset() {
    const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
    if (version < 1) return;
    handled_ = kAllOfFirstVersion;
    if (version >= 3) handled_ |= kTruncate;
    const landlock_ruleset_attr attributes{.handled_access_fs = handled_};
    descriptor_ = static_cast<int>(syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0));
  }
  Ruleset(const Ruleset&) = delete;
  Ruleset& operator=(const Ruleset&) = delete;
  ~Ruleset() {
    if (descriptor_ >= 0) close(descriptor_);
  }

  // Without effect where there is no such path.
  bool allow(const std::filesystem::path& path, std::uint64_t access) const {
    const int place = open(path.c_str(), O_PATH | O_CLOEXEC);
    if (place < 0) return false;
    landlock_path_beneath_attr rule{};
    rule.allowed_access = access & handled_;
    rule.parent_fd = place;
    const long added = syscall(SYS_landlock_add_rule, descriptor_, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
    close(place);
    return added == 0;
  }

  bool exists() const { return descriptor_ >= 0; }
  bool restrict_self() const { return syscall(SYS_landlock_restrict_self, descriptor_, 0) == 0; }

 private:
  std::uint64_t handled_ = 0;
  int descriptor_ = -1;
};

bool shut_files(const SandboxRules& rules) {
  const Ruleset ruleset;
  if (!ruleset.exists()) return false;
  for (const char* folder : kSystemFolders) ruleset.allow(folder, kReadFolder);
  for (const char* file : kSystemFiles) ruleset.allow(file, kReadFile);
  // This program's own library of images lies beside it.
  std::error_code none;
  ruleset.allow(std::filesystem::read_symlink("/proc/self/exe", none).parent_path(), kReadFolder);
  for (const auto& folder : rules.read) {
    if (!ruleset.allow(folder, kReadFolder)) throw ResourceError(folder.string() + ": no such folder for the sandbox");
  }
  for (const auto& folder : rules.write) {
    if (!ruleset.allow(folder, kWriteFolder)) throw ResourceError(folder.string() + ": no such folder for the sandbox");
  }
  return ruleset.restrict_self();
}

// A call that is not on the list fails with ENOSYS: libraries then go on without what is newer than the list.
bool shut_calls() {
  const scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(ENOSYS));
  if (filter == nullptr) return false;
  const auto allow = [&](int call, std::initializer_list<scmp_arg_cmp> when) {
    return seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, call, static_cast<unsigned>(when.size()), std::data(when)) == 0;
  };
  bool done = true;
  for (const char* name : kCalls) {
    const int call = seccomp_syscall_resolve_name(name);
    if (call != __NR_SCMP_ERROR) done = allow(call, {}) && done;
  }
  // Threads, but no processes; signals to this process alone; of devices, whether they are a terminal.
  done = allow(SCMP_SYS(clone), {SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, CLONE_THREAD)}) && done;
  done = allow(SCMP_SYS(tgkill), {SCMP_A0(SCMP_CMP_EQ, static_cast<scmp_datum_t>(getpid()))}) && done;
  done = allow(SCMP_SYS(prlimit64), {SCMP_A0(SCMP_CMP_EQ, 0)}) && done;
  done = allow(SCMP_SYS(ioctl), {SCMP_A1(SCMP_CMP_EQ, TCGETS)}) && done;
  done = allow(SCMP_SYS(prctl), {SCMP_A0(SCMP_CMP_EQ, PR_SET_NAME)}) && done;
  done = done && seccomp_load(filter) == 0;
  seccomp_release(filter);
  return done;
}

}  // namespace

std::vector<std::string> enter_sandbox(const SandboxRules& rules) {
  set_limit(RLIMIT_CORE, 0);
  if (rules.memory_bytes > 0) set_limit(RLIMIT_DATA, rules.memory_bytes);
  std::vector<std::string> missing;
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) missing.push_back(because("no_new_privs"));
  if (!shut_files(rules)) missing.push_back(because("files by Landlock"));
  if (!shut_calls()) missing.push_back(because("calls by seccomp"));
  return missing;
}

}  // namespace fluxfarm
