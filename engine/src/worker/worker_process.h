// The engine as a worker: takes requests from an inherited socket, carries them out on render threads, answers.
//
// One thread reads, so that a cancel is seen while others render; render threads take tiles in the order of their requests, and
// merges before tiles, so that what is finished is shown first. End of file on the socket ends the process.
#pragma once

#include <string>
#include <vector>

namespace fluxfarm {

// Says first what of the sandbox does not hold. Returns the exit status of the process: 0 at end of file, 1 when the peer broke the
// protocol.
int run_worker(int fd, int threads, const std::vector<std::string>& sandbox_missing);

}  // namespace fluxfarm
