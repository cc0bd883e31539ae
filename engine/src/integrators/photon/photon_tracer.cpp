#include "integrators/photon/photon_tracer.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <string>

#include "integrators/key_random.h"
#include "integrators/path/path_vertex.h"
#include "integrators/photon/emission_sequence.h"
#include "integrators/photon/sharpness.h"
#include "integrators/photon/surrounding_medium.h"
#include "integrators/roulette.h"
#include "media/channel_mis.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

std::vector<double> checked_powers(const Scene& scene, const PhotonSettings& settings) {
  std::vector<double> powers = ParticleSource::powers(scene);
  if (settings.photons == 0) throw SettingError("photons = 0, expected at least 1");
  if (!(std::accumulate(powers.begin(), powers.end(), 0.0) > 0)) {
    throw SettingError("nothing in the scene emits light, expected an emitter to shoot photons from");
  }
  bool stores = false;
  for (std::uint32_t shape = 0; shape < scene.census().shapes; ++shape) stores |= scene.surface(shape).has_continuous_lobe;
  for (const HomogeneousMedium& medium : scene.media()) stores |= !medium.sigma_s().is_black();
  if (!stores)
    throw SettingError("all surfaces of the scene are smooth mirrors or glass, expected one that photons can be stored on");
  return powers;
}

double watt(Rgb flux) { return static_cast<double>(mean(flux)); }

}  // namespace

// Photons on their way side by side, so that their rays can share packets.
class PhotonTracer::Group {
 public:
  Group(const PhotonTracer& tracer, RayQueries& queries, StoredPhotons& stored, FluxLedger& ledger)
      : tracer_(tracer),
        scene_(tracer.scene_),
        settings_(tracer.settings_),
        sequence_(tracer.settings_.seed),
        queries_(queries),
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
    Flying& photon = photons_[size_];
    photon = {.flux = flux, .begun_with = max_component(flux), .size = emission->size, .random = random};
    rays_[size_] = emission->ray;
    if (!tracer_.media_ || immerse(photon, *emission)) ++size_;
  }

  void follow() {
    while (size_ > 0) {
      for (std::size_t i = 0; i < size_ && tracer_.media_; ++i) sample_distance(photons_[i], rays_[i]);
      queries_.intersect({rays_.data(), size_}, {hits_.data(), size_}, false);
      std::size_t alive = 0;
      for (std::size_t i = 0; i < size_; ++i) {
        if (!advance(photons_[i], rays_[i], hits_[i])) continue;
        photons_[alive] = photons_[i];
        rays_[alive++] = rays_[i];
      }
      size_ = alive;
    }
  }

 private:
  struct Flying {
    Rgb flux;              // W
    float begun_with = 0;  // largest channel at emission, W
    ApparentSize size;     // of the emitter
    float travelled = 0;   // since emission, m
    int bounces = 0;
    PhotonKind kind = PhotonKind::kDirect;
    const HomogeneousMedium* medium = nullptr;  // around the ray
    ChannelMis channels = {};
    int channel = 0;        // chooses the distances
    bool collides = false;  // at the end of the ray, unless that meets a surface before
    KeyRandom random{0, KeyRandom::kPhoton, 0};
  };

  // Puts a photon into the medium where it starts. False if nothing is left of it there: light from outside that has come through
  // a medium without end.
  bool immerse(Flying& photon, const EmissionSample& emission) {
    if (scene_.census().coloured_media) photon.channel = std::min(static_cast<int>(3 * photon.random.next_1d()), 2);
    photon.medium = scene_.camera_medium();
    if (tracer_.media_change_) {
      // Photons of one point emitter follow each other.
      if (known_place_ != emission.ray.origin) {
        known_medium_ = surrounding_medium(scene_, emission.ray.origin, queries_);
        known_place_ = emission.ray.origin;
      }
      photon.medium = known_medium_;
    }
    if (emission.from_outside && photon.medium != nullptr) {
      lose(photon, photon.flux * photon.medium->transmittance(std::numeric_limits<float>::infinity()));
    }
    return !photon.flux.is_black();
  }

  // Ends the ray at its next collision.
  static void sample_distance(Flying& photon, Ray& ray) {
    photon.collides = false;
    if (photon.medium == nullptr) return;
    const float distance = photon.medium->sample_distance(photon.channel, photon.random.next_1d());
    photon.collides = distance < ray.t_max;
    ray.t_max = std::min(distance, ray.t_max);
  }

  // What it carries from now on. The mean over all photons is what is not absorbed.
  void lose(Flying& photon, Rgb flux) {
    ledger_.absorbed += watt(photon.flux) - watt(flux);
    photon.flux = flux;
  }

  // Takes a photon through the end of its ray and leaves its next one. False when it has ended.
  bool advance(Flying& photon, Ray& ray, const Hit& hit) {
    const bool hits = hit.shape != Hit::kNone;
    photon.travelled += hits ? hit.t : ray.t_max;
    if (!hits && photon.collides) return scatter_in_medium(photon, ray);
    if (photon.medium != nullptr) {
      lose(photon, photon.flux * photon.channels.pass(*photon.medium, hits ? hit.t : ray.t_max));
      if (photon.flux.is_black()) return false;
    }
    if (!hits) {
      ledger_.escaped += watt(photon.flux);
      return false;
    }
    const PathVertex vertex(scene_, ray, hit, space_);
    const Scene::Boundary* boundary = tracer_.media_ ? &scene_.boundary(hit.shape) : nullptr;
    if (boundary == nullptr || !boundary->invisible) {
      if (!scatter_at_surface(photon, ray, vertex)) return false;
    }
    if (boundary != nullptr) photon.medium = boundary->towards(ray.direction, vertex.point, photon.medium);
    ray = {vertex.origin_towards(ray.direction), ray.direction};
    return true;
  }

  // Turns the ray, or ends the photon.
  bool scatter_at_surface(Flying& photon, Ray& ray, const PathVertex& vertex) {
    arrive(photon);
    const Vec3f from = -ray.direction;
    if (vertex.surface->has_continuous_lobe && settings_.kinds.contains(photon.kind)) {
      const PhotonLight light(photon.flux, from, vertex.point.geometric_normal, photon.kind, photon.bounces,
                              photon.random.next_1d());
      stored_.photons.push_back({vertex.point.position, light});
    }
    if (cut(photon)) return false;
    const std::optional<ScatteredFlux> scatter = scatter_flux(vertex, from, photon.random);
    if (!survives(photon, scatter)) return false;
    ray.direction = scatter->direction;
    return true;
  }

  bool scatter_in_medium(Flying& photon, Ray& ray) {
    lose(photon, photon.flux * photon.channels.collide(*photon.medium, ray.t_max));
    arrive(photon);
    const Vec3f position = ray.origin + ray.t_max * ray.direction;
    const Rgb albedo = photon.medium->albedo();
    if (settings_.kinds.contains(photon.kind) && !(photon.flux * albedo).is_black()) {
      const PhotonLight light =
          PhotonLight::in_medium(photon.flux * albedo, -ray.direction, photon.kind, photon.bounces, photon.random.next_1d());
      stored_.in_media.push_back({position, light});
    }
    if (cut(photon)) return false;
    const PhaseFunction& phase = photon.medium->phase();
    const Vec3f direction = phase.sample(ray.direction, photon.random.next_2d());
    const ScatteredFlux scatter{direction, albedo, phase.value(ray.direction, direction), false, false};
    if (!survives(photon, scatter)) return false;
    ray = {position, direction};
    return true;
  }

  void arrive(Flying& photon) {
    ledger_.arrive(static_cast<std::size_t>(photon.bounces), watt(photon.flux));
    ++photon.bounces;
  }

  bool cut(const Flying& photon) {
    if (photon.bounces != settings_.max_bounces) return false;
    ledger_.cut += watt(photon.flux);
    return true;
  }

  // What is left of a photon after it was scattered, and what it is from then on. False when it has ended.
  bool survives(Flying& photon, const std::optional<ScatteredFlux>& scatter) {
    const double arriving = watt(photon.flux);
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

  const PhotonTracer& tracer_;
  const Scene& scene_;
  const PhotonSettings& settings_;
  const EmissionSequence sequence_;
  RayQueries& queries_;
  StoredPhotons& stored_;
  FluxLedger& ledger_;
  BsdfSpace space_;
  std::optional<Vec3f> known_place_;  // where a photon started, and the medium there
  const HomogeneousMedium* known_medium_ = nullptr;
  std::size_t size_ = 0;
  std::array<Flying, kGroup> photons_;
  std::array<Ray, kGroup> rays_;
  std::array<Hit, kGroup> hits_;
};

PhotonTracer::PhotonTracer(const Scene& scene, const PhotonSettings& settings)
    : scene_(scene),
      settings_(settings),
      source_(scene, checked_powers(scene, settings)),
      media_(scene.census().media > 0 || scene.census().null_boundaries) {
  for (std::uint32_t shape = 0; media_ && shape < scene.census().shapes; ++shape) {
    media_change_ |= scene.boundary(shape).separates;
  }
}

PhotonTracer::PhotonTracer(const Scene& scene, const PhotonSettings& settings, const ProjectionMap& projection)
    : PhotonTracer(scene, settings) {
  if (projection.empty()) throw SettingError("no emitter of the scene can shine on the surfaces that the photons are for");
  projection_ = &projection;
}

void PhotonTracer::trace(std::uint64_t first, std::size_t count, RayQueries& queries, StoredPhotons& stored,
                         FluxLedger& ledger) const {
  Group group(*this, queries, stored, ledger);
  for (std::size_t i = 0; i < count; ++i) group.start(first + i);
  group.follow();
}

}  // namespace fluxfarm
