#include "integrators/photon/photon_tracer.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>

#include "integrators/key_random.h"
#include "integrators/path/path_vertex.h"
#include "integrators/photon/emission_sequence.h"
#include "integrators/photon/sharpness.h"
#include "integrators/roulette.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

const std::vector<double>& checked(const Scene& scene, const PhotonSettings& settings, const std::vector<double>& weights) {
  if (settings.photons == 0) throw SettingError("photons = 0, expected at least 1");
  if (scene.census().media > 0 || scene.census().null_boundaries) {
    throw SettingError("the scene has participating media or null boundaries, which photon maps do not model");
  }
  if (!(std::accumulate(weights.begin(), weights.end(), 0.0) > 0)) {
    throw SettingError("nothing in the scene emits light, expected an emitter to shoot photons from");
  }
  bool stores = false;
  for (std::uint32_t shape = 0; shape < scene.census().shapes; ++shape) stores |= scene.surface(shape).has_continuous_lobe;
  if (!stores)
    throw SettingError("all surfaces of the scene are smooth mirrors or glass, expected one that photons can be stored on");
  return weights;
}

double watt(Rgb flux) { return static_cast<double>(mean(flux)); }

}  // namespace

// Photons on their way side by side, so that their rays can share packets.
class PhotonTracer::Group {
 public:
  Group(const PhotonTracer& tracer, std::vector<Photon>& stored, FluxLedger& ledger)
      : tracer_(tracer),
        scene_(tracer.scene_),
        settings_(tracer.settings_),
        sequence_(tracer.settings_.seed),
        stored_(stored),
        ledger_(ledger) {}

  void start(std::uint64_t index) {
    KeyRandom random(settings_.seed, KeyRandom::kPhoton, index);
    const double place = tracer_.place(index, random);
    const EmissionSequence::Point u = sequence_.at(index);
    const ProjectionMap* projection = tracer_.projection_;
    if (projection != nullptr) ledger_.left_out += projection->left_out() / static_cast<double>(settings_.photons);
    const std::optional<EmissionSample> emission =
        projection != nullptr ? projection->emit(place, u.place, u.direction) : tracer_.source_.emit(place, u.place, u.direction);
    if (!emission) return;
    const Rgb flux = emission->flux / static_cast<float>(settings_.photons);
    if (!(max_component(flux) > 0) || !is_finite(flux)) return;
    ledger_.emitted += watt(flux);
    photons_[size_] = {flux, max_component(flux), emission->size, 0, PhotonKind::kDirect, random};
    rays_[size_++] = emission->ray;
  }

  void follow(RayQueries& queries) {
    for (int bounce = 0; size_ > 0; ++bounce) {
      queries.intersect({rays_.data(), size_}, {hits_.data(), size_}, false);
      std::size_t alive = 0;
      for (std::size_t i = 0; i < size_; ++i) {
        if (!advance(photons_[i], rays_[i], hits_[i], bounce)) continue;
        photons_[alive] = photons_[i];
        rays_[alive++] = rays_[i];
      }
      size_ = alive;
    }
  }

 private:
  struct Flying {
    Rgb flux;           // W
    float begun_with;   // largest channel at emission, W
    ApparentSize size;  // of the emitter
    float travelled;    // since emission, m
    PhotonKind kind;
    KeyRandom random{0, KeyRandom::kPhoton, 0};
  };

  // Takes a photon through its next surface and leaves its next ray. False when it has ended.
  bool advance(Flying& photon, Ray& ray, const Hit& hit, int bounce) {
    const double arriving = watt(photon.flux);
    if (hit.shape == Hit::kNone) {
      ledger_.escaped += arriving;
      return false;
    }
    ledger_.arrive(static_cast<std::size_t>(bounce), arriving);
    photon.travelled += hit.t;
    const PathVertex vertex(scene_, ray, hit, space_);
    if (vertex.surface->has_continuous_lobe) store(vertex, photon, ray, bounce + 1);
    if (bounce + 1 == settings_.max_bounces) {
      ledger_.cut += arriving;
      return false;
    }
    const std::optional<ScatteredFlux> scatter = scatter_flux(vertex, -ray.direction, photon.random);
    const Rgb scattered = scatter ? photon.flux * scatter->share : Rgb{};
    if (!is_finite(scattered)) {
      ledger_.absorbed += arriving;
      return false;
    }
    ledger_.absorbed += arriving - watt(scattered);
    const float survival = std::min(max_component(scattered) / photon.begun_with, kMaxSurvival);
    if (!(photon.random.next_1d() < survival)) {
      ledger_.ended += watt(scattered);
      return false;
    }
    photon.flux = scattered * (1 / survival);
    ledger_.regained += watt(photon.flux) - watt(scattered);
    if (!scatter->passes) photon.kind = kind_after(photon, *scatter);
    if (photon.kind == PhotonKind::kIndirect && !settings_.kinds.contains(PhotonKind::kIndirect)) {
      ledger_.cut += watt(photon.flux);  // it stays of that kind
      return false;
    }
    ray = {vertex.origin_towards(scatter->direction), scatter->direction};
    return true;
  }

  // One scattering further. Whether it was a sharp one is drawn, where that is not certain.
  static PhotonKind kind_after(Flying& photon, const ScatteredFlux& scatter) {
    if (photon.kind == PhotonKind::kIndirect) return PhotonKind::kIndirect;
    const bool first = photon.kind == PhotonKind::kDirect;
    const float sharp = sharpness(1 / scatter.value + (first ? photon.size.from(photon.travelled) : 0.0f));
    if (!(sharp >= 1) && !(photon.random.next_1d() < sharp)) return PhotonKind::kIndirect;
    return scatter.delta && photon.kind != PhotonKind::kGlossy ? PhotonKind::kCaustic : PhotonKind::kGlossy;
  }

  void store(const PathVertex& vertex, Flying& photon, const Ray& ray, int surfaces) {
    if (!settings_.kinds.contains(photon.kind)) return;
    const PhotonLight light(photon.flux, -ray.direction, vertex.point.geometric_normal, photon.kind, surfaces,
                            photon.random.next_1d());
    stored_.push_back({vertex.point.position, light});
  }

  const PhotonTracer& tracer_;
  const Scene& scene_;
  const PhotonSettings& settings_;
  const EmissionSequence sequence_;
  std::vector<Photon>& stored_;
  FluxLedger& ledger_;
  BsdfSpace space_;
  std::size_t size_ = 0;
  std::array<Flying, kGroup> photons_;
  std::array<Ray, kGroup> rays_;
  std::array<Hit, kGroup> hits_;
};

PhotonTracer::PhotonTracer(const Scene& scene, const PhotonSettings& settings, const std::vector<double>& weights)
    : scene_(scene), settings_(settings), source_(scene, checked(scene, settings, weights)) {}

PhotonTracer::PhotonTracer(const Scene& scene, const PhotonSettings& settings)
    : PhotonTracer(scene, settings, ParticleSource::powers(scene)) {}

PhotonTracer::PhotonTracer(const Scene& scene, const PhotonSettings& settings, const ProjectionMap& projection)
    : PhotonTracer(scene, settings) {
  if (projection.empty()) throw SettingError("no emitter of the scene can shine on the surfaces that the photons are for");
  projection_ = &projection;
}

void PhotonTracer::trace(std::uint64_t first, std::size_t count, RayQueries& queries, std::vector<Photon>& stored,
                         FluxLedger& ledger) const {
  Group group(*this, stored, ledger);
  for (std::size_t i = 0; i < count; ++i) group.start(first + i);
  group.follow(queries);
}

}  // namespace fluxfarm
