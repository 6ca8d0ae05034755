// Views of how a picture is made, as pixels.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "shaders/shared/show_colours.h"
#include "tests/gpu/closed_form.h"

namespace brume::test {

class ShowTest : public GpuTest {
protected:
    static constexpr uint32_t kWidth = 320, kHeight = 240, kLegendHigh = 60; // pixels; a legend lies below the others
    static constexpr double kLevels = 2.5; // of 255: colours of float and of double, and rounding to a byte
    static constexpr glm::vec3 kEye{0.3f, 0.5f, 9};

    struct Shown {
        std::vector<glm::ivec3> pixels;
        glm::ivec3 at(uint32_t x, uint32_t y) const { return pixels[y * kWidth + x]; }
    };

    static glm::dvec3 colourOf(uint32_t show, double value) {
        return 255.0 * physics::shownColour(show, physics::shownPart(show, value));
    }
    static double apart(glm::ivec3 a, glm::dvec3 b) {
        const glm::dvec3 off = glm::abs(glm::dvec3(a) - b);
        return std::max({off.r, off.g, off.b});
    }

    static Scene dense(const std::vector<Point>& points, const char* method = "isv", float falloff = 0.5f) {
        Scene scene = sceneOf(points, falloff);
        scene.render.method = method;
        return scene;
    }
    static Pose pose() { return lookAt(kEye, {0, 0, 0}, 0.6f); }

    static Shown see(const Scene& scene, uint32_t show, std::span<const gpu::ErrorDisc> errors = {},
                     const Pose& from = pose()) {
        const Simulation simulation(scene);
        Renderer renderer(device(), scene, simulation.capacity());
        Submission submission(device(), "show");
        EyeRequest eye{from, kWidth, kHeight};
        eye.show = show;
        eye.errors = errors;
        renderer.submit(submission, simulation, {&eye, 1}, nullptr, true);
        waitFor(submission.commands);
        const PictureView picture = submission.pictures().front();
        Shown out;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const uint8_t* red = picture.bytes + size_t(y) * picture.layout.lumaStride() + x;
                const size_t plane = picture.layout.lumaBytes();
                out.pixels.emplace_back(red[0], red[plane], red[2 * plane]);
            }
        return out;
    }

    // Calls it for each pixel above the legend with the unit direction of the ray through its middle.
    template <class Visit>
    static void eachPixel(const Visit& visit, const Pose& from = pose()) {
        for (uint32_t y = 0; y < kHeight - kLegendHigh; ++y)
            for (uint32_t x = 0; x < kWidth; ++x)
                visit(x, y, glm::normalize(pixelDirection(from, kWidth, kHeight, x, y)));
    }
};

} // namespace brume::test
