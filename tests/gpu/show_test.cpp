// Views of how a picture is made: colours of finished pictures against what closed forms say of each pixel.
#include <algorithm>
#include <cmath>

#include "server/effects/shadow_volume/shadow_volume.h"
#include "server/render/legend.h"
#include "shaders/shared/orientation.h"
#include "shaders/shared/support.h"
#include "shaders/shared/transmittance.h"
#include "tests/gpu/light_passes.h"
#include "tests/gpu/shown.h"
#include "tests/layer.h"

namespace brume::test::show_test {
namespace {

// A particle's tetrahedron on a ray, m along it; .y < .x: it is beside it. In double, by its four faces' planes, each
// from the three vertices that it has.
glm::dvec2 inTetrahedron(const gpu::Particle& p, glm::dvec3 eye, glm::dvec3 w) {
    const double a = 0.57735026919;
    const glm::dvec3 vertices[]{{a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}};
    glm::dvec2 interval(-1e9, 1e9);
    for (int face = 0; face < 4; ++face) {
        const glm::dvec3 from = glm::dvec3(p.centre) + double(p.scale) * vertices[(face + 1) % 4];
        const glm::dvec3 outward = -vertices[face]; // the face opposite to a vertex of a regular one
        const double away = glm::dot(outward, w), t = glm::dot(outward, from - eye) / away;
        if (away < 0)
            interval.x = std::max(interval.x, t);
        else
            interval.y = std::min(interval.y, t);
    }
    return interval;
}

TEST_F(ShowTest, OneTetrahedronCoversItsProjectionOnce) {
    const Scene scene = dense({{{0, 0, 0}, 2, 1}});
    const gpu::Particle p = particlesOf(scene).front();
    const Shown shown = see(scene, gpu::kShowOverdraw), picture = see(scene, gpu::kShowPicture);
    size_t inside = 0, outside = 0;
    eachPixel([&](uint32_t x, uint32_t y, glm::dvec3 w) {
        const glm::dvec2 interval = inTetrahedron(p, kEye, w);
        if (std::abs(interval.y - interval.x) < 0.02) return; // its outline: rounding decides
        const bool covered = interval.y > interval.x;
        ++(covered ? inside : outside);
        const glm::dvec3 expected = covered ? colourOf(gpu::kShowOverdraw, 1) : 0.35 * glm::dvec3(picture.at(x, y));
        ASSERT_LE(apart(shown.at(x, y), expected), kLevels) << x << ' ' << y << ' ' << covered;
    });
    EXPECT_GT(inside, 2000u);
    EXPECT_GT(outside, 20000u);
}

// Of many: how many cover a pixel, and how many of them are below the cut there. Both are told apart by their colours.
// Tetrahedra that do not fade count all: also those whose Gaussians no ray would meet.
TEST_F(ShowTest, DrawnAndWastedTogetherAreAll) {
    std::vector<Point> points = randomPoints(30, 2.5f, 0.9f, 2, 7);
    for (const Point& thin : randomPoints(20, 2.5f, 0.9f, 2e-5f, 8)) points.push_back(thin);
    Scene scene = dense(points);
    scene.render.cutoff = 0.1f;
    const std::vector<gpu::Particle> particles = particlesOf(scene);
    const gpu::Tick tick = tickOf(scene, particles);
    for (const std::pair<bool, bool>& way : {std::pair(true, false), {false, false}, {true, true}}) {
        const bool fading = way.first, printed = way.second;
        scene.render.isv.fading = fading;
        scene.render.isv.orientation = printed ? "random" : "aligned";
        scene.render.isv.early_return = printed ? "fixed" : "sum";
        scene.render.isv.near = printed ? "drop" : "clip";
        const double least = printed ? 1e-3 : double(tick.cut);
        SCOPED_TRACE(testing::Message() << fading << ' ' << printed);
        const Shown overdraw = see(scene, gpu::kShowOverdraw), wasted = see(scene, gpu::kShowWasted);
        size_t pixels = 0, wrong = 0, drawn_ones = 0, wasted_ones = 0;
        eachPixel([&](uint32_t x, uint32_t y, glm::dvec3 w) {
            int all = 0, below = 0;
            bool close = false; // True: rounding decides
            for (uint32_t i = 0; i < particles.size(); ++i) {
                const gpu::Particle& p = particles[i];
                if (printed && -(p.centre.z - kEye.z) - p.scale < 0.05f) continue;
                const double u = double(p.scale) * double(tick.falloff);
                if (fading && physics::supportRadius(double(p.sigma_t), u, double(tick.cut)) < 0) continue;
                const glm::vec4 turn = printed ? gpu::orientationOf(i) : glm::vec4(0, 0, 0, 1);
                const glm::vec3 eye = p.centre + gpu::turnedBack(turn, kEye - p.centre);
                const glm::dvec2 interval = inTetrahedron(p, eye, gpu::turnedBack(turn, glm::vec3(w)));
                const double length = interval.y - interval.x;
                close = close || std::abs(length) < 0.01;
                if (!(length > 0)) continue;
                ++all;
                const double k = physics::gaussianK(double(p.scale), double(tick.falloff));
                const glm::dvec3 c = glm::dvec3(p.centre) - glm::dvec3(kEye);
                const double closest = glm::dot(c, w), b2 = glm::dot(c, c) - closest * closest;
                double depth = double(p.sigma_t) * length;
                if (fading)
                    depth = physics::segmentDepth(double(p.sigma_t), k, b2, k * (interval.x - closest), k * length);
                close = close || std::abs(depth / least - 1) < 0.01;
                below += depth < least;
            }
            if (close || all == 0) return;
            ++pixels, drawn_ones += size_t(all - below), wasted_ones += size_t(below);
            wrong += apart(overdraw.at(x, y), colourOf(gpu::kShowOverdraw, all)) > kLevels ||
                     apart(wasted.at(x, y), colourOf(gpu::kShowWasted, double(below) / all)) > kLevels;
        });
        EXPECT_EQ(wrong, 0u) << fading;
        EXPECT_GT(pixels, 5000u);
        EXPECT_GT(drawn_ones, printed ? 3000u : 5000u); // more are below the fixed depth
        EXPECT_GT(wasted_ones, 5000u);
    }
}

// Through all of one Gaussian, and through the half of it that lies before a box.
TEST_F(ShowTest, DepthIsTheClosedForm) {
    for (const bool box : {false, true}) {
        Scene scene = dense({{{0, 0, 0}, 5, 1.5f}});
        if (box) scene.boxes.push_back({.centre = {0, 0, -1}, .size = {40, 40, 2}}); // its face is at z = 0
        const gpu::Particle p = particlesOf(scene).front();
        const double k = physics::gaussianK(double(p.scale), double(scene.medium.falloff));
        const Shown shown = see(scene, gpu::kShowDepth);
        size_t deep = 0;
        eachPixel([&](uint32_t x, uint32_t y, glm::dvec3 w) {
            const glm::dvec3 c = glm::dvec3(p.centre) - glm::dvec3(kEye);
            const double closest = glm::dot(c, w), b2 = glm::dot(c, c) - closest * closest;
            const double end = box ? double(kEye.z) / -w.z : 1e4;
            const double depth =
                physics::segmentDepth(double(p.sigma_t), k, b2, k * (0.05 - closest), k * (end - 0.05));
            if (depth < 0.0102) return; // what is behind shows, dimmed
            ++deep;
            ASSERT_LE(apart(shown.at(x, y), colourOf(gpu::kShowDepth, depth)), kLevels) << x << ' ' << y << ' ' << box;
        });
        EXPECT_GT(deep, 1000u);
    }
}

// Views of the sun's light say that there is none, where there is none.
TEST_F(ShowTest, WithoutASunItsViewsSaySo) {
    Scene scene = dense(randomPoints(20, 2, 0.5f, 2, 3));
    for (const bool sun : {true, false}) {
        scene.lights.front().irradiance = sun ? glm::vec3(3) : glm::vec3(0);
        for (const auto& [show, legend] : {std::pair(gpu::kShowShadow, LegendOf::no_sun_shadow),
                                           std::pair(gpu::kShowLight, LegendOf::no_sun_light)}) {
            const Shown shown = see(scene, show);
            const LegendPicture drawn = drawLegend(legendOf(legend));
            size_t ink = 0, found = 0;
            for (uint32_t y = 0; y < drawn.size.y; ++y)
                for (uint32_t x = 0; x < drawn.size.x; ++x) {
                    if (drawn.pixels[y * drawn.size.x + x] != 0xfff0f0f0) continue;
                    ++ink;
                    found += apart(shown.at(4 + x, kHeight - 4 - drawn.size.y + y), glm::dvec3(0xf0)) < 30;
                }
            if (sun)
                EXPECT_LT(found, ink / 2) << show;
            else
                EXPECT_EQ(found, ink) << show;
            if (show != gpu::kShowLight) continue;
            const Shown picture = see(scene, gpu::kShowPicture);
            size_t discs = 0;
            eachPixel([&](uint32_t x, uint32_t y, glm::dvec3) {
                discs += apart(shown.at(x, y), 0.35 * glm::dvec3(picture.at(x, y))) > kLevels;
            });
            if (sun)
                EXPECT_GT(discs, 300u);
            else
                EXPECT_EQ(discs, 0u) << "a colour of a sun that is not there";
        }
    }
}

// Plane after plane, from the one next to the light on.
TEST_F(ShowTest, ShadowShowsTheTexels) {
    Scene scene = dense(randomPoints(20, 2, 2.5f, 2, 3));
    scene.render.shadow_size = 16;
    scene.render.shadow_slices = 6;
    const std::vector<gpu::Particle> particles = particlesOf(scene);
    const gpu::Tick tick = tickOf(scene, particles);
    ShadowVolume volume(device(), uint32_t(particles.size()));
    recordAndWait(device(), tick, "Particles", particles,
                  [&](gpu::Commands& commands, gpu::Resources& shared) { volume.record(commands, shared, tick); });
    const std::vector<float> stored = readImage(device(), volume.image(), 4);
    const Shown shown = see(scene, gpu::kShowShadow);
    const glm::uvec2 texels = tick.map.texels;
    ASSERT_EQ(tick.map.slices, 6u);
    // The colour of every texel is somewhere, in blocks whose width is the picture's over that of a row of planes.
    size_t found = 0, deep = 0;
    for (uint32_t across = 1; across <= 6 && found == 0; ++across) {
        const uint32_t down = (6 + across - 1) / across;
        for (uint32_t legend = 40; legend < kLegendHigh && found == 0; ++legend) {
            const double size = std::min(double(kWidth) / (across * (texels.x + 1)),
                                         double(kHeight - legend) / (down * (texels.y + 1)));
            size_t right = 0;
            deep = 0;
            for (uint32_t plane = 0; plane < 6; ++plane)
                for (uint32_t y = 0; y < texels.y; ++y)
                    for (uint32_t x = 0; x < texels.x; ++x) {
                        const uint32_t layer = std::min(plane / 3, 1u);
                        const float value =
                            stored[((size_t(layer) * texels.y + y) * texels.x + x) * 4 + plane - 3 * size_t(layer)];
                        const uint32_t column = plane % across, row = plane / across;
                        const auto px = uint32_t((column * (texels.x + 1) + x + 0.5) * size),
                                   py = uint32_t((row * (texels.y + 1) + y + 0.5) * size);
                        right += apart(shown.at(px, py), colourOf(gpu::kShowShadow, double(value))) <= kLevels;
                        deep += value > 0.1f;
                    }
            if (right == size_t(6) * texels.x * texels.y) found = right;
        }
    }
    EXPECT_GT(found, 0u);
    EXPECT_GT(deep, 50u);
}

// Without extinction all light arrives. A particle behind another gets what that one lets through, and its own half.
TEST_F(ShowTest, LightIsThePartThatArrives) {
    const auto partAt = [](const Scene& scene, glm::vec3 centre) {
        const Shown shown = see(scene, gpu::kShowLight);
        const glm::mat3 axes = glm::mat3_cast(pose().orientation);
        const glm::vec3 c = glm::transpose(axes) * (centre - kEye);
        const float high = std::tan(0.3f), wide = high * float(kWidth) / float(kHeight);
        const auto x = uint32_t(0.5f * (1 + c.x / -c.z / wide) * float(kWidth)),
                   y = uint32_t(0.5f * (1 - c.y / -c.z / high) * float(kHeight));
        double best = -1, least = 1e9;
        for (int i = 0; i <= 1000; ++i)
            if (const double off = apart(shown.at(x, y), colourOf(gpu::kShowLight, i / 1000.0)); off < least)
                best = i / 1000.0, least = off;
        EXPECT_LE(least, kLevels);
        return best;
    };
    const glm::vec3 to_light = dense({{}}).lights.front().to_light, behind = -1.5f * to_light;
    Scene clear = dense({{{0, 0, 0}, 1, 1e-4f}, {behind, 1, 1e-4f}});
    clear.render.cutoff = 1e-9f;
    EXPECT_NEAR(partAt(clear, {0, 0, 0}), 1, 0.01);
    EXPECT_NEAR(partAt(clear, behind), 1, 0.01);
    const Scene two = dense({{{0, 0, 0}, 1, 4}, {behind, 1, 4}});
    const double column = std::sqrt(2 * kPi) * 4 * 0.1 * 0.5; // optical depth of one, through its middle
    EXPECT_NEAR(partAt(two, {0, 0, 0}), std::exp(-0.5 * column), 0.02);
    EXPECT_NEAR(partAt(two, behind), std::exp(-1.5 * column), 0.02);
    Scene shadowed = two; // by a box between them and the light
    shadowed.boxes.push_back({.centre = 4.0f * to_light, .size = {3, 0.4f, 3}});
    EXPECT_NEAR(partAt(shadowed, {0, 0, 0}), 0, 0.01);
}

TEST_F(ShowTest, ParticlesAreCountedTileByTile) {
    std::vector<Point> points(10, Point{{0, 0, 0}, 0.05f, 10});
    const Shown shown = see(dense(points), gpu::kShowParticles);
    size_t ten = 0, other = 0;
    eachPixel([&](uint32_t x, uint32_t y, glm::dvec3) {
        const bool is_ten = apart(shown.at(x, y), colourOf(gpu::kShowParticles, 10)) <= kLevels;
        ++(is_ten ? ten : other);
        if (x % 16 != 0 && x > 0) { // a tile has one colour where the picture behind is black
            EXPECT_EQ(is_ten, apart(shown.at(x / 16 * 16, y), colourOf(gpu::kShowParticles, 10)) <= kLevels);
        }
    });
    EXPECT_GE(ten, 256u);     // the tile that they are in
    EXPECT_LE(ten, 4 * 256u); // and those that their rims reach
    EXPECT_EQ(ten % 256, 0u);
    EXPECT_GT(other, 10000u);
}

TEST_F(ShowTest, RaysHaveAsManySlabsAsTheMediumReaches) {
    Scene scene = dense({{{0, 0, 0}, 4, 1.5f}}, "slabs");
    scene.render.rate = 8;
    scene.render.slabs = 64;
    const Shown shown = see(scene, gpu::kShowRays);
    double most = 0; // slabs of a ray
    size_t lit = 0;
    eachPixel([&](uint32_t x, uint32_t y, glm::dvec3) {
        if (x % 8 == 0 && y % 8 == 0) return; // the ray itself is white
        for (int slabs = 1; slabs <= 64; ++slabs)
            if (apart(shown.at(x, y), 0.9 * colourOf(gpu::kShowRays, slabs)) <= 1.5) {
                most = std::max(most, double(slabs));
                ++lit;
                break;
            }
    });
    EXPECT_GT(lit, 3000u);
    EXPECT_GE(most, 56); // the slabs are between the nearest and the furthest of the particle
    const Shown none = see(dense({{{0, 0, 0}, 2, 1.5f}}, "isv"), gpu::kShowRays);
    const Shown picture = see(dense({{{0, 0, 0}, 2, 1.5f}}, "isv"), gpu::kShowPicture);
    eachPixel([&](uint32_t x, uint32_t y, glm::dvec3) {
        ASSERT_LE(apart(none.at(x, y), 0.35 * glm::dvec3(picture.at(x, y))), 1.0);
    });
}

TEST_F(ShowTest, MeasuredPixelsAreDiscs) {
    const Scene scene = dense({{{0, 0, 0}, 2, 1}});
    const gpu::ErrorDisc discs[]{{{0.25f, 0.25f}, 0.03f}, {{0.75f, 0.5f}, 1e-3f}};
    const Shown shown = see(scene, gpu::kShowError, discs), none = see(scene, gpu::kShowError);
    EXPECT_LE(apart(shown.at(80, 60), colourOf(gpu::kShowError, 0.03)), kLevels);
    EXPECT_LE(apart(shown.at(240, 120), colourOf(gpu::kShowError, 1e-3)), kLevels);
    size_t differ = 0;
    eachPixel([&](uint32_t x, uint32_t y, glm::dvec3) { differ += shown.at(x, y) != none.at(x, y); });
    EXPECT_GE(differ, 8u); // two discs of a radius of two pixels, with black rims before black
    EXPECT_LT(differ, 40u);
}

// Who looks at the picture gets it bit for bit, whoever looks at something else beside.
TEST_F(ShowTest, ThePictureStaysAsItIs) {
    BRUME_WHOLE_LAYER_ONLY();
    for (const char* method : {"isv", "slabs", "sphere"})
        for (const bool full : {false, true}) {
            SCOPED_TRACE(testing::Message() << method << ' ' << full);
            Scene scene = loadScene("server/scenes/props.toml");
            scene.render.method = method;
            scene.render.shadow_size = 64;
            const Simulation simulation(scene);
            const Pose camera = lookAt(scene.camera.position, scene.camera.target, 0.8f);
            std::vector<EyeRequest> eyes{{camera, 160, 91}, {camera, 160, 91}, {camera, 97, 64}};
            const auto draw = [&] {
                Renderer renderer(device(), scene, simulation.capacity());
                Submission submission(device(), "three");
                renderer.submit(submission, simulation, eyes, nullptr, full);
                waitFor(submission.commands);
                std::vector<std::vector<uint8_t>> all;
                for (const PictureView& one : submission.pictures())
                    all.emplace_back(one.bytes, one.bytes + one.layout.bytes());
                return all;
            };
            const auto plain = draw();
            eyes[1].show = gpu::kShowOverdraw;
            const auto shown = draw();
            EXPECT_EQ(plain[0], shown[0]);
            EXPECT_EQ(plain[2], shown[2]);
            EXPECT_NE(plain[1], shown[1]);
        }
}

// Every view draws something, in pictures of odd sizes, and its legend.
TEST_F(ShowTest, EveryViewIsDrawn) {
    Scene scene = loadScene("server/scenes/props.toml");
    scene.render.shadow_size = 64;
    const Simulation simulation(scene);
    const Pose camera = lookAt(scene.camera.position, scene.camera.target, 0.8f);
    Renderer renderer(device(), scene, simulation.capacity());
    for (const bool full : {false, true}) {
        const char* method = full ? "tiles" : "slabs";
        scene.render.method = method;
        std::vector<EyeRequest> eyes;
        for (uint32_t show = 0; show < gpu::kShows; ++show) {
            eyes.push_back({camera, 321, 181});
            eyes.back().show = show;
        }
        Submission submission(device(), "all");
        renderer.submit(submission, simulation, eyes, &scene.render, full);
        waitFor(submission.commands);
        const std::span<const PictureView> pictures = submission.pictures();
        for (uint32_t show = 1; show < gpu::kShows; ++show) {
            SCOPED_TRACE(testing::Message() << method << ' ' << full << ' ' << show);
            const PlaneLayout& layout = pictures[show].layout;
            const uint8_t *shown = pictures[show].bytes, *plain = pictures[0].bytes;
            size_t differ = 0, ink = 0;
            for (size_t y = 0; y < layout.height; ++y)
                for (size_t x = 0; x < layout.width; ++x) {
                    const size_t i = y * layout.lumaStride() + x;
                    differ += shown[i] != plain[i];
                    ink += y + kLegendHigh > layout.height && shown[i] == 0xf0;
                }
            EXPECT_GT(differ, layout.lumaBytes() / 2);
            EXPECT_GT(ink, 200u); // its title
        }
    }
}

TEST_F(ShowTest, TetrahedraAreNotShownAsGaussians) {
    const Scene scene = sceneOf({{.centre = {-2, -2, 0}, .scale = 2},
                                 {.centre = {2, -2, 0}, .scale = 2},
                                 {.centre = {0, 2, -2}, .scale = 2},
                                 {.centre = {0, 2, 2}, .scale = 2}},
                                1, {glm::uvec4(0, 1, 2, 3)});
    const size_t above = size_t(kWidth) * (kHeight - kLegendHigh);
    const auto top = [&](uint32_t show) {
        const Shown shown = see(scene, show);
        return std::vector(shown.pixels.begin(), shown.pixels.begin() + ptrdiff_t(above));
    };
    const std::vector<glm::ivec3> dimmed = top(gpu::kShowRays);
    for (const uint32_t show : {gpu::kShowWasted, gpu::kShowOverdraw, gpu::kShowParticles, gpu::kShowDepth})
        EXPECT_EQ(top(show), dimmed) << show;
    EXPECT_NE(top(gpu::kShowLight), dimmed);
    EXPECT_NE(top(gpu::kShowShadow), dimmed);
}

} // namespace
} // namespace brume::test::show_test
