// GpuTest: tests on a device with validation and synchronization checks, shared by a program's tests. Every test
// requires zero validation messages.
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/render/renderer.h"

namespace brume::test {

// One eye's float radiance (RGB) and transmittance (A), row by row.
struct Picture {
    uint32_t width, height;
    std::vector<glm::vec4> pixels;
    const glm::vec4& at(uint32_t x, uint32_t y) const { return pixels[y * width + x]; }
};

// A renderer that is used again for many scenes with the same sky and objects, since compiling pipelines takes long.
class Stage {
public:
    Stage(const gpu::Device& device, const Scene& fixed, uint32_t capacity);
    // Renders `scene`, which may differ from the constructor's scene in medium, light and render settings.
    Picture see(const Scene& scene, const Pose& pose, uint32_t width, uint32_t height);

private:
    Renderer renderer_;
    Submission submission_;
};

class GpuTest : public testing::Test {
protected:
    static constexpr uint32_t kPlainCapacity = 600;

    GpuTest();

    // The methods that a test draws a case with: all in the whole layer. In the quick one slabs, grid and one of the
    // others, another one for each case.
    static std::vector<const char*> some(std::vector<const char*> methods);
    // The number of a case, by which the quick layer chooses: they differ among tests, and follow each other in a test.
    static size_t nextCase();

    static const gpu::Device& device(); // with mesh shaders if the device has them
    static const gpu::Device& deviceWithoutMesh();
    // Stages for scenes of at most kPlainCapacity particles without objects, sky and ambient light.
    static Stage& plain();
    static Stage& plainWithoutMesh();

    void TearDown() override;
};

// One particle of a test scene.
struct Point {
    glm::vec3 centre{0};
    float scale = 1, sigma_t = 1;
    glm::vec3 albedo{1};
};

// A scene of exactly these particles, one light of irradiance 1, no sky, and a negligible cut-off. `tetrahedra`: of
// which the particles are the corners; none: they are Gaussians.
Scene sceneOf(const std::vector<Point>& points, float falloff = 1, const std::vector<glm::uvec4>& tetrahedra = {});

// Random numbers that are equal on all machines.
class Random {
public:
    explicit Random(uint32_t seed) : bits_(seed) {}
    float uniform(float lo, float hi) { return lo + (hi - lo) * float(bits_() >> 8) / float(1 << 24); }
    glm::vec3 inCube(float half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
    glm::vec3 direction() { return glm::normalize(inCube(1)); }

private:
    std::mt19937 bits_;
};

// `count` particles at random positions in a cube of side `extent` (m) around the origin.
std::vector<Point> randomPoints(uint32_t count, float extent, float scale, float sigma_t, uint32_t seed = 1);

// Renders in one submission, and waits for it.
void submitAndWait(Renderer& renderer, Submission& submission, const Simulation& simulation,
                   std::span<const EyeRequest> eyes);
Picture render(const gpu::Device& device, const Scene& scene, const Pose& pose, uint32_t width, uint32_t height);

// Direction of the ray through a pixel's centre, scaled to unit view depth, in double.
glm::dvec3 pixelDirection(const Pose& pose, uint32_t width, uint32_t height, uint32_t x, uint32_t y);

// All layers of an RGBA32F or R32F image as floats, layer after layer, row after row.
std::vector<float> readImage(const gpu::Device& device, const gpu::Image& image, uint32_t channels);

// Waits until the last submission of `commands` is done.
void waitFor(const gpu::Commands& commands);

} // namespace brume::test
