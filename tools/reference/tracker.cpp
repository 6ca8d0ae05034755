#include "tools/reference/tracker.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/reference/density_grid.h"
#include "tools/reference/lighting.h"
#include "tools/reference/rows.h"

namespace brume::reference {

namespace {

// splitmix64 (Steele et al. 2014).
class Random {
public:
    Random(uint64_t seed, uint64_t stream) : state_(mixed(seed) + mixed(~stream)) {}
    // In [0, 1).
    double uniform() { return static_cast<double>(mixed(state_ += 0x9e3779b97f4a7c15) >> 11) * 0x1p-53; }
    double depth() { return -std::log1p(-uniform()); } // exponential, mean 1

private:
    static uint64_t mixed(uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return z ^ (z >> 31);
    }
    uint64_t state_;
};

class Tracker {
public:
    Tracker(const World& world, const DensityGrid& grid, const Lighting& lighting, int orders)
        : world_(world), grid_(grid), lighting_(lighting), orders_(orders) {}

    // Radiance along one path back from the ray.
    glm::dvec3 path(Ray ray, Random& random) {
        glm::dvec3 radiance(0), weight(1);
        bool from_surface = false; // True: the ray begins on a surface that the camera sees
        for (int order = 0;; ++order) {
            const Hit hit = lighting_.obstacles().nearest(ray);
            ray.end = std::min(ray.end, hit.t);
            const Collision collision = collide(ray, random);
            if (order == 0) {
                Ray seen = ray;
                seen.end = std::min(ray.end, collision.t);
                sheetsOn(world_, seen, sheets_);
                for (const SheetHit& sheet : sheets_) radiance += weight * sheet.mirrored, weight *= sheet.passes;
            }
            if (!(collision.t < ray.end)) {
                if (from_surface) return radiance; // its shading knows what else the surface gets
                if (hit.object >= 0) {
                    const glm::dvec3 surface = lighting_.surface(hit, ray);
                    radiance += weight * (order == 0 ? throughHaze(world_, surface, hit.t, ray.direction) : surface);
                    if (order > 0 || !world_.onto_surfaces) return radiance;
                    weight *= std::exp(-world_.haze * hit.t) *
                              albedoAt(world_.obstacles[static_cast<size_t>(hit.object)], ray, hit.t);
                    ray = {ray.at(hit.t) + 1e-7 * hit.normal, byCosine(hit.normal, random)};
                    from_surface = true;
                    continue;
                } else {
                    if (order > 0) radiance += weight * world_.ambient;
                    if (order == 0 || world_.sky_lights) radiance += weight * skyRadiance(world_, ray.direction);
                }
                return radiance;
            }
            from_surface = false;
            radiance += weight * collision.emitted;
            if (order == orders_) return radiance;
            weight *= collision.albedo;
            const glm::dvec3 x = ray.at(collision.t);
            for (const LightSource& light : world_.lights) {
                const Arrival arrival = arrivalAt(light, x);
                const Ray toward{x, arrival.to_light, 0, arrival.distance};
                if (arrival.irradiance == glm::dvec3(0)) continue;
                if (light.shadows && lighting_.obstacles().occluded(toward)) continue;
                radiance += weight * arrival.irradiance * phase(*collision.phase, -arrival.to_light, -ray.direction) *
                            (light.shadows ? transmittance(toward, random) : throughFogs(toward));
            }
            // Dim paths end by chance, brighter ones in their place.
            const double bright = std::max({weight.x, weight.y, weight.z}), survive = std::min(bright / 0.25, 1.0);
            if (survive < 1 && random.uniform() >= survive) return radiance;
            weight /= survive;
            ray = {x, scatteredFrom(ray.direction, *collision.phase, random)};
        }
    }

private:
    struct Collision {
        double t = kInfinity;
        glm::dvec3 albedo{0}, emitted{0}; // emitted: radiance per collision
        const PhaseLobes* phase = nullptr;
    };

    Collision ofParticles(double t, glm::dvec3 albedo) const {
        return {t, albedo, emittedBy(world_, albedo), &world_.phase};
    }

    // The first of the media's own collisions: they are independent.
    Collision collide(const Ray& ray, Random& random) {
        Collision first;
        for (const Fog& fog : world_.fogs)
            if (const double t = ray.begin + distanceOfDepth(fog, ray, random.depth()); t < first.t)
                first = {t, fog.albedo, (1.0 - fog.albedo) * fog.emission, &fog.phase};
        grid_.walk({ray.origin, ray.direction, ray.begin, std::min(ray.end, first.t)},
                   [&](size_t cell, double t0, double t1, double majorant) {
                       for (double t = t0;;) {
                           t += random.depth() / majorant;
                           if (t >= t1) return true;
                           const DensityGrid::Density density = grid_.at(cell, ray.at(t));
                           if (random.uniform() * majorant >= density.extinction) continue;
                           first = ofParticles(t, density.scattering / density.extinction);
                           return false;
                       }
                   });
        lighting_.tetrahedra().along({ray.origin, ray.direction, ray.begin, std::min(ray.end, first.t)}, parts_);
        for (const CellPart& part : parts_)
            if (const double t = part.whereDepthIs(random.depth()); t < first.t)
                first = ofParticles(t, part.albedoAt(t));
        return first;
    }

    double throughFogs(const Ray& ray) const {
        double depth = 0;
        for (const Fog& fog : world_.fogs) depth += depthOn(fog, ray);
        return std::exp(-depth);
    }

    double transmittance(const Ray& ray, Random& random) const {
        double through = throughFogs(ray) * std::exp(-lighting_.tetrahedra().depth(ray));
        if (through == 0) return 0;
        grid_.walk(ray, [&](size_t cell, double t0, double t1, double majorant) {
            for (double t = t0 + random.depth() / majorant; t < t1; t += random.depth() / majorant)
                through *= 1 - grid_.at(cell, ray.at(t)).extinction / majorant;
            return through > 0;
        });
        return through;
    }

    // A direction above a surface, by the cosine to its normal.
    static glm::dvec3 byCosine(glm::dvec3 normal, Random& random) {
        const double cosine = std::sqrt(1 - random.uniform());
        return around(normal, cosine, random);
    }

    // A direction of this cosine to the unit `axis`.
    static glm::dvec3 around(glm::dvec3 axis, double cosine, Random& random) {
        const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0)), turn = 2 * kPi * random.uniform();
        const glm::dvec3 x =
            glm::normalize(glm::cross(axis, std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
        return glm::normalize(cosine * axis + sine * (std::cos(turn) * x + std::sin(turn) * glm::cross(axis, x)));
    }

    // A direction by the phase function: paths run backwards, which leaves the angle between the directions as it is.
    static glm::dvec3 scatteredFrom(glm::dvec3 w, const PhaseLobes& phase, Random& random) {
        const auto& [part, asymmetry, draine, second] = phase;
        const bool by_draine = random.uniform() < part;
        const double g = by_draine ? asymmetry : second, alpha = by_draine ? draine : 0;
        double cosine;
        do {
            const double u = random.uniform();
            cosine = 2 * u - 1;
            if (std::abs(g) > 1e-6) {
                const double s = (1 - g * g) / (1 - g + 2 * g * u);
                cosine = (1 + g * g - s * s) / (2 * g);
            }
        } while (alpha > 0 && random.uniform() * (1 + alpha) > 1 + alpha * cosine * cosine);
        return around(w, cosine, random);
    }

    const World& world_;
    const DensityGrid& grid_;
    const Lighting& lighting_;
    int orders_;
    std::vector<SheetHit> sheets_; // on the camera's ray
    std::vector<CellPart> parts_;  // on the last ray
};

} // namespace

TrackedPicture track(const World& world, const Camera& camera, const TrackSettings& settings) {
    if (world.support != Support::full || world.composition != Composition::overlapping)
        throw std::invalid_argument("tracking is of whole Gaussians whose extinctions add up");
    if (world.voxels.volume) throw std::invalid_argument("tracking is not of volumes");
    if (isColoured(world)) throw std::invalid_argument("tracking is of one channel of a coloured world: inChannel()");
    const DensityGrid grid(world);
    const Lighting lighting(world, kReach, true);
    const size_t size = static_cast<size_t>(camera.width) * camera.height;
    TrackedPicture picture{camera.width, camera.height, std::vector<glm::dvec3>(size), std::vector<glm::dvec3>(size)};
    forRows(camera.height, settings.threads, [&] {
        return [&, tracker = Tracker(world, grid, lighting, settings.orders)](int y) mutable {
            for (int x = 0; x < camera.width; ++x) {
                const size_t pixel = static_cast<size_t>(y) * camera.width + x;
                const Ray ray = rayThrough(camera, x + 0.5, y + 0.5);
                Random random(settings.seed, pixel);
                glm::dvec3 mean(0), squares(0); // of the differences from the mean (Welford 1962)
                for (int i = 1; i <= settings.samples; ++i) {
                    const glm::dvec3 value = tracker.path(ray, random), before = value - mean;
                    mean += before / double(i);
                    squares += before * (value - mean);
                }
                picture.radiance[pixel] = mean;
                picture.standard_error[pixel] =
                    glm::sqrt(squares / (double(settings.samples) * (settings.samples - 1)));
            }
        };
    });
    return picture;
}

} // namespace brume::reference
