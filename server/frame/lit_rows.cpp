#include "server/frame/lit_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume {
namespace {

constexpr float kStepsOfDeviation = 64; // of places, at least
constexpr float kSteps = 64'000;        // that all places take, at most
constexpr float kGrid = 1024;           // steps, of the origin: it stays while particles move a little

// A power of two, and an origin on a coarse grid: both stay while the medium changes little, and differences are small.
void placeColumns(std::span<const gpu::Particle> particles, float falloff, LitRows& out) {
    glm::vec3 lo(std::numeric_limits<float>::max()), hi(std::numeric_limits<float>::lowest());
    float least = std::numeric_limits<float>::max();
    for (const gpu::Particle& p : particles) {
        lo = glm::min(lo, p.centre);
        hi = glm::max(hi, p.centre);
        least = std::min(least, 0.1f * p.scale * falloff); // a deviation is a tenth of scale * falloff
    }
    const glm::vec3 extent = hi - lo;
    const float fine = least / kStepsOfDeviation, all = std::max({extent.x, extent.y, extent.z}) / kSteps;
    out.step =
        std::exp2(std::max(std::floor(std::log2(std::max(fine, 1e-9f))), std::ceil(std::log2(std::max(all, 1e-9f)))));
    out.origin = glm::floor(lo / (kGrid * out.step)) * (kGrid * out.step);
}

// All but the particles.
lit::Medium numbersOf(const Submission::Fits& fits) {
    const gpu::Tick& tick = fits.tick;
    lit::Medium medium;
    medium.hues.clear();
    for (const Hue& hue : fits.hues) medium.hues.push_back({hue.channels, double(hue.particles)});
    medium.to_light = tick.sun.to_light, medium.irradiance = tick.sun.irradiance, medium.ambient = tick.ambient;
    medium.emission = tick.emission, medium.cold_albedo = tick.cold_albedo;
    medium.phase = {tick.phase.part, tick.phase.asymmetry, tick.phase.draine, tick.phase.second};
    medium.straight = tick.multiple.passed;
    medium.mean_cosine = double(tick.multiple.mean_cosine);
    return medium;
}

// The hue that has a channel.
uint32_t hueOf(const Submission::Fits& fits, uint32_t channel) {
    uint32_t hue = 0;
    while (hue + 1 < fits.hues.size() && !(fits.hues[hue].channels >> channel & 1)) ++hue;
    return hue;
}

} // namespace

lit::Medium litMedium(const LitRows& made, const Submission::Fits& fits) {
    lit::Medium medium = numbersOf(fits);
    lit::addParticles(made.rows, made.origin, double(made.step), double(fits.tick.falloff), medium);
    return medium;
}

lit::Medium litMedium(const Submission::Fits& fits) {
    lit::Medium medium = numbersOf(fits);
    const uint32_t channels = fits.tick.multiple.channels;
    medium.scatters_on = channels > 0;
    for (size_t i = 0; i < fits.particles.size(); ++i) {
        const gpu::Particle& from = fits.particles[i];
        lit::Medium::Particle p{.centre = from.centre,
                                .scale = double(from.scale),
                                .k = physics::gaussianK<double>(double(from.scale), double(fits.tick.falloff)),
                                .sigma_t = double(from.sigma_t),
                                .albedo = from.albedo};
        for (size_t hue = 0; hue < fits.fits.size(); ++hue) {
            const gpu::ParticleFit& fit = fits.fits[hue][i];
            p.fits[hue] = {double(fit.middle), fit.slope, fit.bend, fit.twist};
        }
        for (uint32_t c = 0; c < 3 && channels > 0; ++c)
            p.fluence[c] = fits.fits[hueOf(fits, c)][i].fluence[std::min(c, channels - 1)];
        medium.particles.push_back(p);
    }
    return medium;
}

LitRows litRows(const Submission::Fits& fits, uint64_t first) {
    const std::span<const gpu::Particle> particles = fits.particles;
    LitRows out;
    lit::Rows& rows = out.rows;
    rows.first = first;
    rows.count = uint32_t(particles.size());
    if (particles.empty()) return out;
    placeColumns(particles, fits.tick.falloff, out);
    const auto fill = [&](uint32_t column, const auto& number) {
        std::vector<uint16_t>& numbers = rows.columns[column];
        numbers.resize(particles.size());
        for (size_t i = 0; i < particles.size(); ++i) numbers[i] = number(i);
    };
    for (int axis = 0; axis < 3; ++axis) {
        fill(lit::kPlace + axis, [&, from = out.origin[axis], per = 1 / out.step](size_t i) {
            return uint16_t(std::clamp(std::round((particles[i].centre[axis] - from) * per), 0.0f, 65535.0f));
        });
        fill(lit::kAlbedo + axis, [&](size_t i) {
            return uint16_t(std::lround(65535.0f * std::clamp(particles[i].albedo[axis], 0.0f, 1.0f)));
        });
    }
    fill(lit::kScale, [&](size_t i) { return lit::logCode(particles[i].scale); });
    fill(lit::kExtinction, [&](size_t i) { return lit::logCode(particles[i].sigma_t); });
    for (uint32_t hue = 0; hue < fits.fits.size(); ++hue) {
        const std::span<const gpu::ParticleFit> of = fits.fits[hue];
        const uint32_t column = lit::kFit + hue * lit::kFitColumns;
        fill(column, [&](size_t i) { return lit::rootCode(of[i].middle); });
        for (int axis = 0; axis < 3; ++axis) {
            fill(column + 1 + axis, [&](size_t i) { return lit::signedCode(of[i].slope[axis]); });
            fill(column + 4 + axis, [&](size_t i) { return lit::signedCode(of[i].bend[axis]); });
            fill(column + 7 + axis, [&](size_t i) { return lit::signedCode(of[i].twist[axis]); });
        }
    }
    for (uint32_t channel = 0; channel < fits.tick.multiple.channels; ++channel) {
        const std::span<const gpu::ParticleFit> of = fits.fits[hueOf(fits, channel)];
        const uint32_t column = lit::kFluence + channel * lit::kFluenceColumns;
        fill(column, [&](size_t i) { return lit::logCode(of[i].fluence[channel].w); });
        for (int axis = 0; axis < 3; ++axis)
            fill(column + 1 + axis, [&](size_t i) {
                const glm::vec4& f = of[i].fluence[channel];
                return lit::signedCode(f.w > 0 ? f[axis] / f.w : 0);
            });
    }
    return out;
}

} // namespace brume
