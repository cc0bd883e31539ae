#include "worker/worker_process.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <new>
#include <thread>

#include "support/error.h"
#include "worker/build_id.h"
#include "worker/codec.h"
#include "worker/frame_socket.h"
#include "worker/job_queue.h"
#include "worker/loaded_scene.h"
#include "worker/merge.h"
#include "worker/pass_memory.h"
#include "worker/tile_file.h"
#include "worker/tile_runner.h"

namespace fluxfarm {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kKeptScenes = 8;
// Photon maps of one pass may be as large as a scene; tiles of two jobs may take turns.
constexpr std::size_t kKeptPasses = 2;
constexpr std::chrono::milliseconds kProgressInterval{250};

FailureReply failure_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const CancelledError& e) {
    return {FailureKind::kCancelled, e.what()};
  } catch (const SceneError& e) {
    return {FailureKind::kScene, e.what()};
  } catch (const SettingError& e) {
    return {FailureKind::kScene, e.what()};
  } catch (const ResourceError& e) {
    return {FailureKind::kResource, e.what()};
  } catch (const std::bad_alloc&) {
    return {FailureKind::kResource, "out of memory"};
  } catch (const std::exception& e) {
    return {FailureKind::kInternal, e.what()};
  }
}

// A request that is being carried out.
struct Running {
  std::atomic<bool> cancelled{false};
  // RenderTiles only:
  std::atomic<std::size_t> tiles_left{0};
  std::mutex failure_mutex;
  std::optional<FailureReply> failure;  // the first one that is not a cancel
  std::atomic<std::uint64_t> samples{0};
  std::atomic<Clock::rep> last_progress{Clock::now().time_since_epoch().count()};
};

class Worker {
 public:
  Worker(int fd, int threads) : socket_(fd), threads_(threads), scenes_(kKeptScenes), passes_(kKeptPasses) {}

  int run(const std::vector<std::string>& sandbox_missing) {
    reply(0, HelloReply{engine_build_id(), threads_, sandbox_missing});
    for (int i = 0; i < threads_; ++i) {
      std::thread([this] {
        prepare_render_thread();
        for (;;) jobs_.pop()();
      }).detach();  // the process ends with the socket, not with its threads
    }
    try {
      while (const std::optional<std::string> frame = socket_.read()) handle(decode_request(*frame));
    } catch (const Error& error) {
      std::fprintf(stderr, "fluxfarm-engine worker: %s\n", error.what());
      return 1;
    }
    return 0;
  }

 private:
  void reply(std::uint64_t id, const ReplyBody& body) { socket_.write(encode_reply(id, body)); }

  void handle(Request request) {
    const std::uint64_t id = request.id;
    std::visit([&](auto& body) { handle(id, std::move(body)); }, request.body);
  }

  void reply_not_loaded(std::uint64_t id, const SceneKey& key) {
    reply(id, FailureReply{FailureKind::kResource, "scene " + key + " is not loaded here, LoadScene first"});
  }

  void handle(std::uint64_t id, UnknownRequest) {
    reply(id, FailureReply{FailureKind::kInternal, "request not known to protocol version " + std::to_string(kProtocolVersion)});
  }
  void handle(std::uint64_t id, PingRequest) { reply(id, PongReply{}); }
  void handle(std::uint64_t, CancelRequest request) {
    merger_.forget();  // a job that stops may not come back
    const std::lock_guard lock(running_mutex_);
    if (const auto found = running_.find(request.target); found != running_.end()) found->second->cancelled = true;
  }

  void handle(std::uint64_t id, const LoadSceneRequest& request) {
    // Known from now on, so that tiles may be asked for before it is loaded: they wait for it. Loading is urgent, hence begun
    // before any of them.
    SceneFuture scene = scenes_.find(request.key);
    using Loading = std::packaged_task<std::shared_ptr<const LoadedScene>(const std::atomic<bool>&)>;
    std::shared_ptr<Loading> loading;
    if (!scene.valid()) {
      loading = std::make_shared<Loading>(
          [this, request](const std::atomic<bool>& cancelled) { return load_scene(request, threads_, cancelled); });
      scene = loading->get_future().share();
      scenes_.keep(request.key, scene);
    }
    start(id, [this, scene, loading, key = request.key](const std::atomic<bool>& cancelled) -> ReplyBody {
      if (loading) (*loading)(cancelled);
      try {
        return scene.get()->info;
      } catch (...) {
        if (loading) scenes_.forget(key);  // asked for again, it is tried again
        throw;
      }
    });
  }
  void handle(std::uint64_t id, MergePassRequest request) {
    SceneFuture scene;
    if (request.decision) {
      scene = scenes_.find(request.decision->key);
      if (!scene.valid()) return reply_not_loaded(id, request.decision->key);
    }
    start(id, [this, scene, request = std::move(request)](const std::atomic<bool>& cancelled) -> ReplyBody {
      if (cancelled) throw CancelledError();
      if (!scene.valid()) return merger_.merge(request);
      const LoadedScene& loaded = *scene.get();
      const LightAudit audit =
          loaded.audits->find(loaded.scene, *loaded.integrator, request.crop, request.info.seed, threads_, cancelled);
      return merger_.merge(request, &audit, loaded.integrator->bias() != Integrator::Bias::kFixed);
    });
  }
  void handle(std::uint64_t id, WriteTileRequest request) {
    start(id, [request = std::move(request)](const std::atomic<bool>& cancelled) -> ReplyBody {
      if (cancelled) throw CancelledError();
      write_tile(request);
      return TileWrittenReply{};
    });
  }

  // One job that answers with one reply. `work` hears whether it is cancelled, maybe before it began: others may wait for its end.
  void start(std::uint64_t id, std::function<ReplyBody(const std::atomic<bool>&)> work) {
    const std::shared_ptr<Running> running = begin(id);
    jobs_.push(
        [this, id, running, work = std::move(work)] {
          ReplyBody body;
          try {
            body = work(running->cancelled);
          } catch (...) {
            body = failure_of(std::current_exception());
          }
          end(id);
          reply(id, body);
        },
        true);
  }

  void handle(std::uint64_t id, RenderTilesRequest body) {
    const auto request = std::make_shared<const RenderTilesRequest>(std::move(body));
    const SceneFuture scene = scenes_.find(request->key);
    if (!scene.valid()) {
      reply_not_loaded(id, request->key);
      return;
    }
    if (request->tiles.empty()) {
      reply(id, TilesDoneReply{});
      return;
    }
    const std::shared_ptr<Running> running = begin(id);
    running->tiles_left = request->tiles.size();
    for (std::uint32_t tile = 0; tile < request->tiles.size(); ++tile) {
      jobs_.push([this, id, request, scene, running, tile] { render(id, *request, scene, *running, tile); }, false);
    }
  }

  void render(std::uint64_t id, const RenderTilesRequest& request, const SceneFuture& scene, Running& running, std::uint32_t tile) {
    try {
      if (running.cancelled) throw CancelledError();
      const LoadedScene& loaded = *scene.get();
      const Clock::time_point start = Clock::now();
      RayQueries queries(loaded.scene.accelerator());
      const TileSums sums = sums_of(loaded, request, tile, queries, running.cancelled,
                                    [&](std::uint64_t samples) { tell_progress(id, running, samples); });
      const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
      if (!running.cancelled) {
        const std::uint64_t bytes = write_tile_file(request.file(tile), sums);
        reply(id, TileDoneReply{tile, bytes, seconds, queries.rays(), sums.non_finite_samples});
      }
    } catch (...) {
      note_failure(running, failure_of(std::current_exception()));
    }
    if (--running.tiles_left > 0) return;
    end(id);
    if (running.failure) {
      reply(id, *running.failure);
    } else if (running.cancelled) {
      reply(id, FailureReply{FailureKind::kCancelled, "cancelled"});
    } else {
      reply(id, TilesDoneReply{});
    }
  }

  // From the pilot, where it has them.
  TileSums sums_of(const LoadedScene& loaded, const RenderTilesRequest& request, std::uint32_t tile, RayQueries& queries,
                   const std::atomic<bool>& cancelled, const std::function<void(std::uint64_t)>& progress) {
    std::optional<std::shared_ptr<const PreparedPass>> pass;
    if (const std::shared_ptr<const PilotSamples> known = loaded.pilot->find(request.samples)) {
      if (const TileSums* sums = known->tile(request.seed, request.samples, request.tiles[tile])) return *sums;
      pass = known->pass(request.seed, request.samples);
    }
    if (!pass) pass = passes_.find(request.key, *loaded.integrator, request.seed, request.samples, threads_, cancelled);
    const TileTask task{request.tiles[tile], request.samples, request.seed, pass->get()};
    return render_tile(loaded.scene, *loaded.integrator, task, queries, cancelled, progress);
  }

  // The first failure ends the other tiles of the request, and answers it when they have ended: until then they may write files.
  static void note_failure(Running& running, const FailureReply& failure) {
    // A scene may be cancelled by the request that loads it, and this one, which waits for it, may not be.
    if (failure.kind == FailureKind::kCancelled && running.cancelled) return;
    const std::lock_guard lock(running.failure_mutex);
    if (!running.failure) running.failure = failure;
    running.cancelled = true;
  }

  void tell_progress(std::uint64_t id, Running& running, std::uint64_t samples) {
    const std::uint64_t total = running.samples += samples;
    const Clock::rep now = Clock::now().time_since_epoch().count();
    Clock::rep last = running.last_progress;
    if (Clock::duration(now - last) < kProgressInterval) return;
    if (running.last_progress.compare_exchange_strong(last, now)) reply(id, ProgressReply{total});
  }

  std::shared_ptr<Running> begin(std::uint64_t id) {
    const std::lock_guard lock(running_mutex_);
    return running_[id] = std::make_shared<Running>();
  }
  void end(std::uint64_t id) {
    const std::lock_guard lock(running_mutex_);
    running_.erase(id);
  }

  FrameSocket socket_;
  int threads_;
  SceneStore scenes_;
  PassMemory passes_;
  PassMerger merger_;
  JobQueue jobs_;
  std::mutex running_mutex_;
  std::map<std::uint64_t, std::shared_ptr<Running>> running_;
};

}  // namespace

int run_worker(int fd, int threads, const std::vector<std::string>& sandbox_missing) {
  // Never destroyed: render threads use it until the process ends.
  auto* worker = new Worker(fd, threads);
  const int status = worker->run(sandbox_missing);
  std::fflush(nullptr);
  _exit(status);
}

}  // namespace fluxfarm
