// What is prepared for a pass is prepared once for all its tiles, and let go when others need the room.
#include <gtest/gtest.h>

#include "support/error.h"
#include "support/parallel.h"
#include "worker/pass_memory.h"

namespace fluxfarm::testing {
namespace {

struct CountedPass : PreparedPass {
  explicit CountedPass(int& alive) : alive_(++alive) {}
  CountedPass(const CountedPass&) = delete;
  CountedPass& operator=(const CountedPass&) = delete;
  ~CountedPass() override { --alive_; }
  std::uint64_t rays() const override { return 0; }

 private:
  int& alive_;
};

// Counts the passes that it made and those that are still there.
struct CountingIntegrator : Integrator {
  mutable int made = 0, alive = 0;
  const char* name() const override { return "counting"; }
  void prepare(const Scene&) override {}
  std::shared_ptr<const PreparedPass> prepare_pass(std::uint64_t, SampleRange, int,
                                                   const std::atomic<bool>& cancelled) const override {
    ++made;
    if (cancelled) throw CancelledError();
    return std::make_shared<CountedPass>(alive);
  }
  void radiance(std::span<const CameraSample>, std::uint64_t, const PreparedPass*, std::span<SampleResult>,
                RayQueries&) const override {}
};

TEST(PassMemory, MakesAPassOnceForAllItsTiles) {
  CountingIntegrator integrator;
  PassMemory memory(2);
  const std::atomic<bool> never{false};
  parallel_for(64, 4, [&](std::size_t, int) { EXPECT_TRUE(memory.find("a", integrator, 1, {0, 4}, 1, never)); });
  EXPECT_EQ(integrator.made, 1);
  memory.find("a", integrator, 1, {4, 8}, 1, never);
  memory.find("a", integrator, 2, {0, 4}, 1, never);
  memory.find("b", integrator, 2, {0, 4}, 1, never);
  EXPECT_EQ(integrator.made, 4);
}

TEST(PassMemory, KeepsTheLastOnesOfAllScenesTogether) {
  CountingIntegrator integrator;
  PassMemory memory(2);
  const std::atomic<bool> never{false};
  for (const char* key : {"a", "b", "c", "b", "c"}) memory.find(key, integrator, 1, {0, 4}, 1, never);
  EXPECT_EQ(integrator.made, 3);
  EXPECT_EQ(integrator.alive, 2);
  memory.find("a", integrator, 1, {0, 4}, 1, never);
  EXPECT_EQ(integrator.made, 4);
}

TEST(PassMemory, ForgetsWhatWasCancelled) {
  CountingIntegrator integrator;
  PassMemory memory(2);
  const std::atomic<bool> never{false}, cancelled{true};
  EXPECT_THROW(memory.find("a", integrator, 1, {0, 4}, 1, cancelled), CancelledError);
  EXPECT_TRUE(memory.find("a", integrator, 1, {0, 4}, 1, never));
}

}  // namespace
}  // namespace fluxfarm::testing
