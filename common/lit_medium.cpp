#include "common/lit_medium.h"

#include <algorithm>
#include <cmath>

#include "shaders/shared/emission.h"
#include "shaders/shared/multiple.h"
#include "shaders/shared/phase.h"

namespace brume::lit {
namespace {

constexpr double kReach = 14; // k^2 b^2 beyond which a particle is left out: 1e-6 of its depth is left

// What a ray has of a particle.
struct Crossing {
    const Medium::Particle* particle;
    double line, closest; // optical depth of the whole line; m, distance of the closest approach
    glm::dvec3 nearest;   // u of the closest approach
};

// Optical depth, and optical depth times source.
struct Slab {
    double depth = 0;
    glm::dvec3 lit{0};
};

// The index of the hue that has a channel.
std::array<uint32_t, 3> huesOf(const Medium& medium) {
    std::array<uint32_t, 3> hues{};
    for (uint32_t c = 0; c < 3; ++c)
        while (hues[c] + 1 < medium.hues.size() && !(medium.hues[hues[c]].channels >> c & 1)) ++hues[c];
    return hues;
}

class Ray {
public:
    Ray(const Medium& medium, glm::dvec3 direction)
        : medium_(medium), direction_(direction), hues_(huesOf(medium)),
          phase_(physics::phaseOfLobes<double>(-medium.to_light, -direction, medium.phase.x, medium.phase.y,
                                               medium.phase.z, medium.phase.w)) {}

    // Adds what a particle has between two places to a slab.
    void add(const Crossing& at, const physics::LitSums<double>& from, const physics::LitSums<double>& to,
             Slab& slab) const {
        const Medium::Particle& p = *at.particle;
        const auto own = physics::emitted<double>(medium_.emission, medium_.cold_albedo, 1, p.albedo);
        for (uint32_t c = 0; c < 3; ++c) {
            const auto line = physics::litLine<double>(p.fits[hues_[c]], at.nearest, direction_);
            const auto part = physics::litPart<double>(at.line, line, from, to);
            if (c == 0) slab.depth += part.depth;
            double lit = medium_.irradiance[c] * phase_ * part.lit + medium_.ambient[c] * part.depth;
            if (medium_.scatters_on && part.depth > 0) {
                const double through = part.lit / part.depth;
                const double on = std::pow(through, medium_.straight[c]) - through;
                const glm::dvec4& f = p.fluence[c];
                lit += medium_.irradiance[c] * part.depth *
                       (phase_ * on +
                        physics::scatteredFluence<double>(f.w, glm::dvec3(f), medium_.mean_cosine, -direction_));
            }
            slab.lit[c] += p.albedo[c] * lit + own[c] * part.depth;
        }
    }

    Seen sum(const std::vector<Slab>& slabs) const {
        Seen seen;
        for (uint32_t c = 0; c < 3; ++c) {
            const double factor = medium_.hues[hues_[c]].extinction;
            for (size_t i = 0; i < slabs.size(); ++i) {
                const Slab none, &own = slabs[i], &before = i > 0 ? slabs[i - 1] : none,
                                 &behind = i + 1 < slabs.size() ? slabs[i + 1] : none;
                seen.radiance[c] +=
                    seen.transmittance[c] *
                    physics::litSlab<double>(factor * before.lit[c], factor * own.lit[c], factor * behind.lit[c],
                                             factor * glm::dvec3(before.depth, own.depth, behind.depth));
                seen.transmittance[c] *= std::exp(-factor * own.depth);
            }
        }
        return seen;
    }

private:
    const Medium& medium_;
    const glm::dvec3 direction_;
    const std::array<uint32_t, 3> hues_;
    const double phase_;
};

// The slabs before `far`.
std::vector<Slab> cutAt(double far, const std::vector<double>& ends, const std::vector<Slab>& slabs) {
    std::vector<Slab> kept = slabs;
    const auto at = [&](size_t i, auto number) { return i < slabs.size() ? number(slabs[i]) : 0.0; };
    const auto length = [&](size_t i) { return i < slabs.size() ? ends[i + 1] - ends[i] : 1.0; };
    for (size_t i = 0; i < slabs.size(); ++i) {
        if (far >= ends[i + 1]) continue;
        const double part = std::clamp((far - ends[i]) / length(i), 0.0, 1.0);
        const auto before = [&](auto number) {
            return physics::litBefore<double>({at(i - 1, number), at(i, number), at(i + 1, number)},
                                              {length(i - 1), length(i), length(i + 1)}, part);
        };
        kept[i].depth = before([](const Slab& slab) { return slab.depth; });
        for (int c = 0; c < 3; ++c) kept[i].lit[c] = before([c](const Slab& slab) { return slab.lit[c]; });
    }
    return kept;
}

} // namespace

void addParticles(const Rows& rows, glm::dvec3 origin, double step, double falloff, Medium& medium) {
    const auto number = [&](uint32_t column, uint32_t row) {
        return rows.columns[column].empty() ? uint16_t(0) : rows.columns[column][row];
    };
    const auto vector = [&](uint32_t column, uint32_t row, auto value) {
        return glm::dvec3(value(number(column, row)), value(number(column + 1, row)), value(number(column + 2, row)));
    };
    const auto plain = [](uint16_t x) { return double(x); };
    const auto part = [](uint16_t x) { return double(ofSignedCode(x)); };
    for (uint32_t row = 0; row < rows.count; ++row) {
        Medium::Particle p;
        p.centre = origin + step * vector(kPlace, row, plain);
        p.scale = double(ofLogCode(number(kScale, row)));
        p.k = physics::gaussianK<double>(p.scale, falloff);
        p.sigma_t = double(ofLogCode(number(kExtinction, row)));
        p.albedo = vector(kAlbedo, row, plain) / 65535.0;
        for (uint32_t hue = 0; hue < medium.hues.size(); ++hue) {
            const uint32_t column = kFit + hue * kFitColumns;
            p.fits[hue] = {double(ofRootCode(number(column, row))), vector(column + 1, row, part),
                           vector(column + 4, row, part), vector(column + 7, row, part)};
        }
        for (uint32_t c = 0; c < 3; ++c) {
            uint32_t column = kFluence + c * kFluenceColumns;
            if (rows.columns[column].empty()) column = kFluence; // all have red's
            const double fluence = double(ofLogCode(number(column, row)));
            p.fluence[c] = glm::dvec4(fluence * vector(column + 1, row, part), fluence);
            medium.scatters_on = medium.scatters_on || fluence > 0;
        }
        medium.particles.push_back(p);
    }
}

Seen along(const Medium& medium, glm::dvec3 origin, glm::dvec3 direction, double near, double far, uint32_t count) {
    std::vector<Crossing> crossings;
    glm::dvec3 moments(0);
    for (const Medium::Particle& p : medium.particles) {
        const glm::dvec3 to = p.centre - origin;
        const double closest = glm::dot(to, direction);
        const glm::dvec3 nearest = p.k * (closest * direction - to);
        const double b2 = glm::dot(nearest, nearest);
        if (b2 > kReach) continue;
        const double line = physics::lineDepth<double>(p.sigma_t, p.k, std::exp(-b2));
        crossings.push_back({&p, line, closest, nearest});
        moments += physics::litMoments<double>(line, p.k, closest, physics::litSums<double>(p.k * (near - closest)));
    }
    const auto range = physics::litRange<double>(moments, near);
    std::vector<double> ends; // m, of slabs
    for (uint32_t i = 0; i <= count; ++i) ends.push_back(physics::litEdge<double>(range, double(i) / count));
    std::vector<Slab> slabs(count);
    const Ray ray(medium, direction);
    for (const Crossing& at : crossings) {
        const double k = at.particle->k;
        auto from = physics::litSums<double>(k * (near - at.closest));
        for (uint32_t i = 0; i < count; ++i) {
            const auto to = physics::litSums<double>(i + 1 < count ? k * (ends[i + 1] - at.closest) : 1e9);
            ray.add(at, from, to, slabs[i]);
            from = to;
        }
    }
    return ray.sum(cutAt(far, ends, slabs));
}

} // namespace brume::lit
