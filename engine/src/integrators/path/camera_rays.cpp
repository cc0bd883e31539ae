#include "integrators/path/camera_rays.h"

#include <array>

#include "integrators/pixel_blocks.h"

namespace fluxfarm {

void start_camera_rays(const Scene& scene, std::span<const CameraSample> samples, std::uint64_t seed, SamplerBatch& sampler,
                       std::span<Ray> rays) {
  sampler.clear();
  for (const CameraSample& sample : samples) sampler.add(seed, sample.x, sample.y, sample.index);
  const Camera& camera = scene.camera();
  std::array<Vec2f, kMaxPaths> u_film, u_lens;
  sampler.draw_2d(kFilmDimension, u_film);
  if (camera.has_lens()) sampler.draw_2d(kLensDimension, u_lens);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec2f offset = scene.pixel_filter().sample(u_film[i]);
    const float x = static_cast<float>(samples[i].x) + 0.5f + offset.x;
    const float y = static_cast<float>(samples[i].y) + 0.5f + offset.y;
    rays[i] = camera.has_lens() ? camera.ray(x, y, u_lens[i]) : camera.ray(x, y);
  }
}

}  // namespace fluxfarm
