// Shuts this process in, before it reads what strangers wrote: which files it may open, which system calls it may make, how much
// memory it may take. None of it needs rights, and none of it can be undone. Linux alone.
//
// Files by Landlock, calls by seccomp: documentation of the kernel, userspace-api/landlock and userspace-api/seccomp_filter.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace fluxfarm {

struct SandboxRules {
  std::vector<std::filesystem::path> read;   // folders, with all that lies below
  std::vector<std::filesystem::path> write;  // the same; files in them may be made and removed, too
  std::uint64_t memory_bytes = 0;            // that the process may write to; 0: any
};

// Enters the sandbox; for a process that has no other thread yet. Beside the given folders the system's libraries can be read, and
// facts of the processor. No network, no other program, no other process. Returns what this kernel does not have of it, in words:
// empty where all holds. Throws ResourceError for a folder that is not there.
std::vector<std::string> enter_sandbox(const SandboxRules& rules);

}  // namespace fluxfarm
