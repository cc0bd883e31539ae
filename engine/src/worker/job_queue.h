// Jobs of the render threads, urgent ones first, else in the order they came.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>

namespace fluxfarm {

class JobQueue {
 public:
  using Job = std::function<void()>;

  void push(Job job, bool urgent) {
    {
      const std::lock_guard lock(mutex_);
      (urgent ? urgent_ : ordinary_).push_back(std::move(job));
    }
    waiting_.notify_one();
  }

  // Waits for a job.
  Job pop() {
    std::unique_lock lock(mutex_);
    waiting_.wait(lock, [&] { return !urgent_.empty() || !ordinary_.empty(); });
    std::deque<Job>& jobs = urgent_.empty() ? ordinary_ : urgent_;
    Job job = std::move(jobs.front());
    jobs.pop_front();
    return job;
  }

 private:
  std::mutex mutex_;
  std::condition_variable waiting_;
  std::deque<Job> urgent_, ordinary_;
};

}  // namespace fluxfarm
