// The volumetric shadow map texel by texel, its laws, and what interpolating it costs.
#include <cmath>

#include "server/effects/shadow_volume/shadow_volume.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/light_passes.h"

namespace brume::test::shadow_volume_test {
namespace {

// A particle in the map's cells (columns, rows, planes).
struct Stored {
    glm::dvec3 at, variance; // of what is stored: linear interpolation adds a sixth of a squared cell to it
    double column;           // optical depth through its centre, before it is stored narrower

    Stored(const gpu::Tick& tick, const gpu::Particle& p) {
        const glm::dvec3 cell =
                             glm::dvec3(tick.map.hi - tick.map.lo) / glm::dvec3(tick.map.texels, tick.map.slices - 1.0),
                         c(p.centre);
        at = glm::dvec3(glm::dot(c, glm::dvec3(tick.map.x)) - double(tick.map.lo.x),
                        glm::dot(c, glm::dvec3(tick.map.y)) - double(tick.map.lo.y),
                        double(tick.map.hi.z) - glm::dot(c, glm::dvec3(tick.sun.to_light))) /
                 cell -
             glm::dvec3(0.5, 0.5, 0);
        const double deviation = 0.1 * double(p.scale) * double(tick.falloff);
        const glm::dvec3 own = deviation * deviation / (cell * cell);
        variance = glm::max(own - 1.0 / 6, 0.75 * own);
        column = std::sqrt(2 * kPi) * double(p.sigma_t) * deviation;
        peak = column * std::sqrt(own.x / variance.x * own.y / variance.y);
    }
    double depth(glm::dvec3 texel) const {
        const glm::dvec3 d = texel - at;
        return 0.5 * peak * std::exp(-0.5 * (d.x * d.x / variance.x + d.y * d.y / variance.y)) *
               std::erfc(-d.z / std::sqrt(2 * variance.z));
    }

private:
    double peak;
};

class ShadowVolumeTest : public GpuTest {
protected:
    // The texels of all planes of `scene`'s volume, plane after plane.
    std::vector<float> texelsOf(const Scene& scene, const std::vector<gpu::Particle>& particles, gpu::Tick& tick) {
        return shadowTexels(device(), volume_, scene, particles, tick);
    }

    // Every `stride`-th texel of every plane against the sum over all particles.
    void expectSums(const Scene& scene, const std::vector<gpu::Particle>& particles, uint32_t stride = 1) {
        gpu::Tick tick;
        const std::vector<float> texels = texelsOf(scene, particles, tick);
        std::vector<Stored> all;
        for (const gpu::Particle& p : particles) all.emplace_back(tick, p);
        // What particles leave out beyond their reach, at most `cut` each.
        const double left_out = double(tick.cut) * double(particles.size());
        // Float: a place errs by two ulps of its distance, which changes exp(-d^2 / 2 s^2) by d / s^2 times that, d up
        // to 6 s.
        double relative = 2e-5;
        for (const gpu::Particle& p : particles)
            relative =
                std::max(relative, 6 * 2.4e-7 * double(glm::length(p.centre) + glm::length(tick.map.lo) + p.scale) /
                                       (0.1 * 0.86 * double(p.scale) * double(tick.falloff)));
        double largest = 0;
        for (uint32_t plane = 0; plane < tick.map.slices; ++plane)
            for (uint32_t y = 0; y < tick.map.texels.y; y += stride)
                for (uint32_t x = 0; x < tick.map.texels.x; x += stride) {
                    double exact = 0;
                    for (const Stored& one : all) exact += one.depth({x, y, plane});
                    const double got = double(texels[(size_t(plane) * tick.map.texels.y + y) * tick.map.texels.x + x]);
                    ASSERT_LE(got, exact * (1 + relative) + 1e-9) << plane << ": " << x << ' ' << y;
                    ASSERT_GE(got, exact * (1 - relative) - left_out - 1e-9) << plane << ": " << x << ' ' << y;
                    largest = std::max(largest, got);
                    if (plane == 0) {
                        ASSERT_LE(got, left_out + 1e-9) << "the medium reaches beyond the first plane";
                    }
                }
        if (!particles.empty()) {
            EXPECT_GT(largest, 0.01);
        }
    }

    static Scene lit(glm::vec3 to_light, uint32_t size, uint32_t slices, float falloff = 1.6f) {
        Scene scene = sceneOf({Point{}}, falloff);
        scene.lights[0].to_light = glm::normalize(to_light);
        scene.render.shadow_size = size;
        scene.render.shadow_slices = slices;
        return scene;
    }

    static std::vector<gpu::Particle> few() {
        return {{{0, 0, 0}, 3, glm::vec3(1), 0.7f},
                {{2, 1, -1}, 1.5f, glm::vec3(1), 2},
                {{-4, 3, 2}, 4, glm::vec3(1), 0.2f},
                {{1, -3, 5}, 0.4f, glm::vec3(1), 9},
                {{1, -3, 4.5f}, 6, glm::vec3(1), 1e-9f}}; // below every cut
    }

    ShadowVolume volume_{device(), 3000};
};

TEST_F(ShadowVolumeTest, SizesAndPlanes) {
    for (const uint32_t size : {16u, 37u})
        for (const uint32_t slices : {2u, 3u, 4u, 5u, 7u, 8u, 15u, 16u, 17u, 193u}) {
            SCOPED_TRACE(testing::Message() << size << " texels, " << slices << " planes");
            expectSums(lit({0.3f, 0.8f, 0.5f}, size, slices), few());
        }
}

// 172 MiB of texels, which go through a buffer of 64.
TEST_F(ShadowVolumeTest, LargeMapsInBands) { expectSums(lit({0.3f, 0.8f, 0.5f}, 512, 128), few(), 29); }

TEST_F(ShadowVolumeTest, LightFromAnywhere) {
    for (const glm::vec3 to_light : {glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, -1),
                                     glm::vec3(-0.02f, 1, 0.01f), glm::vec3(-3, -1, 2)}) {
        SCOPED_TRACE(testing::Message() << to_light.x << ' ' << to_light.y << ' ' << to_light.z);
        expectSums(lit(to_light, 33, 16, 1), few());
        expectSums(lit(to_light, 33, 16), {few()[1]});
    }
}

TEST_F(ShadowVolumeTest, CloudAtTheMediumsOwnSize) {
    Scene scene = loadScene("server/scenes/cloud.toml");
    scene.render.cutoff = 1e-3f;
    scene.render.shadow_error = 5e-4f; // finer than the least map
    expectSums(scene, particlesOf(scene), 3);
    gpu::Tick tick;
    texelsOf(scene, particlesOf(scene), tick);
    EXPECT_NE(tick.map.texels.x, tick.map.texels.y); // rows and columns cannot be mixed up unseen
}

// More particles than words of bits, in places that say where they are: each a thousandth deeper than the one before.
TEST_F(ShadowVolumeTest, NoParticleIsLostOrCountedTwice) {
    const Scene scene = lit({0.2f, 1, -0.1f}, 64, 9);
    std::vector<gpu::Particle> many;
    Random random(3);
    for (int i = 0; i < 2777; ++i)
        many.push_back({random.inCube(4), 0.5f, glm::vec3(1), 0.01f * (1 + 0.001f * float(i))});
    expectSums(scene, many, 7);
}

// On the last plane lies all that there is: sums over texels are the particles' masses, whatever the size.
TEST_F(ShadowVolumeTest, MassIsKept) {
    const std::vector<gpu::Particle> particles = {few()[0], few()[1], few()[2]};
    double mass = 0;
    for (const gpu::Particle& p : particles) {
        const double s = 0.16 * double(p.scale);
        mass += std::pow(2 * kPi, 1.5) * double(p.sigma_t) * s * s * s;
    }
    // Texels are at most 0.9 standard deviations wide: sums are integrals to 1e-5.
    for (const uint32_t size : {64u, 101u, 256u}) {
        gpu::Tick tick;
        const std::vector<float> texels = texelsOf(lit({0.3f, 0.8f, 0.5f}, size, 5), particles, tick);
        const glm::dvec2 texel = glm::dvec2(tick.map.hi - tick.map.lo) / glm::dvec2(tick.map.texels);
        double sum = 0;
        for (size_t i = texels.size() / 5 * 4; i < texels.size(); ++i) sum += double(texels[i]) * texel.x * texel.y;
        EXPECT_NEAR(sum / mass, 1, 2e-4) << size; // the rest is beyond the reach of tiles
    }
}

// Bilinear interpolation of one particle's last plane: the RMS error is 2.5 times below the (h/s)^2 / 8 of stored true
// values, and what shadow_resolution.cpp reckons with.
TEST_F(ShadowVolumeTest, InterpolationErrsByNoMoreThanItIsReckonedToErr) {
    const gpu::Particle one{{0.1f, 0, 0.2f}, 3, glm::vec3(1), 0.7f};
    const double s = 0.16 * 3, column = std::sqrt(2 * kPi) * 0.7 * s;
    for (const uint32_t size : {16u, 12u, 24u, 40u}) {
        gpu::Tick tick;
        const std::vector<float> texels = texelsOf(lit({0.3f, 0.8f, 0.5f}, size, 5), {one}, tick);
        const glm::dvec2 texel = glm::dvec2(tick.map.hi - tick.map.lo) / double(size);
        ASSERT_NEAR(texel.x / texel.y, 1, 1e-3);
        const Stored stored(tick, one);
        constexpr int kParts = 8;
        double squares = 0;
        for (uint32_t y = 0; y + 1 < size; ++y)
            for (uint32_t x = 0; x + 1 < size; ++x)
                for (int i = 0; i < kParts * kParts; ++i) {
                    const glm::dvec2 part = (glm::dvec2(i % kParts, i / kParts) + 0.5) / double(kParts);
                    const auto at = [&](uint32_t i_x, uint32_t i_y) {
                        return double(texels[(size_t(4) * size + y + i_y) * size + x + i_x]);
                    };
                    const double got =
                        glm::mix(glm::mix(at(0, 0), at(1, 0), part.x), glm::mix(at(0, 1), at(1, 1), part.x), part.y);
                    const glm::dvec2 d = (glm::dvec2(x, y) + part - glm::dvec2(stored.at)) * texel;
                    squares += std::pow(got - column * std::exp(-0.5 * glm::dot(d, d) / (s * s)), 2);
                }
        const double error = std::sqrt(squares * texel.x * texel.y / (kParts * kParts) / (kPi * s * s)) / column;
        const double q = texel.x / s, reckoned = q * q * (0.0456 + 0.0155 * q * q);
        EXPECT_LT(error, 1.06 * reckoned + 1e-4) << "texels of " << q << " standard deviations";
        EXPECT_GT(error, 0.9 * reckoned - 1e-4) << "texels of " << q << " standard deviations";
    }
}

// Fewer lanes, as other devices have them, make narrower tiles, which leave out a little more and add in another order.
TEST_F(ShadowVolumeTest, FewerLanes) {
    Scene scene = loadScene("server/scenes/cloud.toml");
    scene.render.cutoff = 1e-5f;
    const std::vector<gpu::Particle> particles = particlesOf(scene);
    for (const uint32_t lanes : {4u, 2u, 1u}) {
        const gpu::Device few({.validation = true, .name = device().name(), .most_lanes = lanes});
        if (few.lanesTogether() == device().lanesTogether()) continue;
        SCOPED_TRACE(testing::Message() << lanes << " lanes");
        ShadowVolume other(few, uint32_t(particles.size()));
        for (const uint32_t size : {0u, 37u}) {
            scene.render.shadow_size = size;
            gpu::Tick tick;
            const std::vector<float> usual = texelsOf(scene, particles, tick),
                                     texels = shadowTexels(few, other, scene, particles, tick);
            ASSERT_EQ(texels.size(), usual.size());
            const float left_out = tick.cut * float(particles.size());
            for (size_t i = 0; i < usual.size(); ++i)
                ASSERT_NEAR(texels[i], usual[i], left_out + 2e-6f * usual[i]) << i;
        }
        EXPECT_EQ(few.validationMessages(), 0u);
    }
}

TEST_F(ShadowVolumeTest, NoParticles) {
    gpu::Tick tick;
    for (const float texel : texelsOf(lit({0, 1, 0}, 37, 17), {}, tick)) ASSERT_EQ(texel, 0);
}

TEST_F(ShadowVolumeTest, SameBitsOnEveryRun) {
    const Scene scene = loadScene("server/scenes/cloud.toml");
    gpu::Tick tick;
    const auto first = texelsOf(scene, particlesOf(scene), tick);
    EXPECT_EQ(first, texelsOf(scene, particlesOf(scene), tick));
}

// Skipped only when nothing that it depends on has changed.
TEST_F(ShadowVolumeTest, IsRecordedOnceForWhatRests) {
    const Scene scene = lit({0.3f, 0.8f, 0.5f}, 16, 5);
    const std::vector<gpu::Particle> particles = few();
    const auto recorded = [&](const Scene& what, bool same_particles) {
        const gpu::Tick tick = tickOf(what, particles);
        bool result = false;
        recordAndWait(device(), tick, "Particles", particles, [&](gpu::Commands& commands, gpu::Resources& shared) {
            result = volume_.record(commands, shared, tick, same_particles);
        });
        return result;
    };
    EXPECT_TRUE(recorded(scene, true)) << "there is none yet";
    EXPECT_FALSE(recorded(scene, true));
    EXPECT_TRUE(recorded(scene, false));
    Scene other = scene;
    other.lights[0].irradiance = glm::vec3(7);
    other.render.exposure = 2;
    EXPECT_FALSE(recorded(other, true)) << "depths do not depend on it";
    for (const auto& change : std::vector<std::function<void(Scene&)>>{
             [](Scene& s) { s.lights[0].to_light = glm::normalize(glm::vec3(0.3f, 0.8f, 0.501f)); },
             [](Scene& s) { s.medium.falloff = 1.7f; },
             [](Scene& s) { s.render.shadow_size = 17; },
             [](Scene& s) { s.render.shadow_slices = 6; },
             [](Scene& s) { s.render.cutoff = 2e-6f; },
         }) {
        Scene changed = scene;
        change(changed);
        EXPECT_TRUE(recorded(changed, true));
        EXPECT_TRUE(recorded(scene, true)) << "and back";
    }
}

} // namespace
} // namespace brume::test::shadow_volume_test
