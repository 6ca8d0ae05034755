// Light cached on the particles: the fit against double precision, and which particles the edges of opaque shadows
// meet.
#include <algorithm>
#include <cmath>

#include "server/effects/particle_light/particle_light.h"
#include "server/effects/shadow_volume/shadow_volume.h"
#include "server/opaque/object_buffers.h"
#include "shaders/shared/support.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/light_passes.h"

namespace brume::test::particle_light_test {
namespace {

std::vector<gpu::ParticleLight> lightOf(const gpu::Device& device, const Scene& scene,
                                        const std::vector<gpu::Particle>& particles) {
    const gpu::Tick tick = tickOf(scene, particles);
    const ObjectBuffers objects(device, scene);
    const auto count = uint32_t(particles.size());
    const gpu::Buffer back(device, count * sizeof(gpu::ParticleLight), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                           gpu::Memory::readback, "light readback");
    ShadowVolume volume(device, count);
    ParticleLight light(device, count);
    const gpu::Sampler linear(device, VK_FILTER_LINEAR);
    recordAndWait(device, tick, "Particles", particles, [&](gpu::Commands& commands, gpu::Resources& shared) {
        volume.record(commands, shared, tick);
        shared.give(gpu::storageBuffer("Objects", objects.objects()));
        shared.give(gpu::sampledImage("shadow_volume", volume.image(), linear));
        light.record(commands, shared, count, scene.render.tiles.light_tolerance);
        gpu::computeToTransfer(commands.handle());
        const VkBufferCopy copy{0, 0, back.size()};
        vkCmdCopyBuffer(commands.handle(), light.buffer().handle(), back.handle(), 1, &copy);
        gpu::transferToHost(commands.handle());
    });
    back.invalidate();
    const auto mapped = back.mapped<gpu::ParticleLight>(count);
    return {mapped.begin(), mapped.end()};
}

// The mean and the gradient of the exact light at six points; and how near that is to least squares over the particle's
// Gaussian, of which 27 points of Gauss and Hermite tell the truth to fifth order.
TEST_F(GpuTest, ParticleLightIsTheLeastSquaresFit) {
    Scene scene = sceneOf(randomPoints(300, 8, 4, 0.05f), 1.6f);
    scene.render.tiles.light_tolerance = 1;
    const std::vector<gpu::Particle> particles = particlesOf(scene);
    for (const glm::vec3 to_light : {glm::vec3(0.3f, 0.8f, 0.5f), glm::vec3(0, 1, 0), glm::vec3(-1, 0.1f, 0.2f)}) {
        scene.lights[0].to_light = glm::normalize(to_light);
        const reference::LightField field(blobsOf(scene), glm::normalize(glm::dvec3(to_light)));
        const auto lights = lightOf(device(), scene, particles);
        double defined = 0, mean_error = 0, slope_error = 0, darkest = 1, steepest = 0;
        for (size_t i = 0; i < particles.size(); ++i) {
            const double deviation = 0.1 * double(particles[i].scale * scene.medium.falloff);
            const auto lightAt = [&](glm::dvec3 deviations) {
                return std::exp(-field.depth(glm::dvec3(particles[i].centre) + deviation * deviations));
            };
            double mean = 0, mean_of_six = 0;
            glm::dvec3 slope(0), slope_of_six(0); // per standard deviation
            for (int n = 0; n < 27; ++n) {
                const glm::ivec3 node(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
                double weight = 1;
                for (int axis = 0; axis < 3; ++axis) weight *= node[axis] == 0 ? 2.0 / 3 : 1.0 / 6;
                const glm::dvec3 at = std::sqrt(3.0) * glm::dvec3(node);
                const double light = lightAt(at);
                mean += weight * light;
                slope += weight * light * at;
                if (std::abs(node.x) + std::abs(node.y) + std::abs(node.z) != 1) continue;
                mean_of_six += light / 6;
                slope_of_six += light * at / 6.0;
            }
            const glm::dvec3 got = glm::dvec3(lights[i].gradient) * deviation;
            const double got_mean = double(lights[i].transmittance) + 1.5 * double(lights[i].curvature);
            defined = std::max({defined, std::abs(double(lights[i].transmittance) - lightAt(glm::dvec3(0))),
                                std::abs(got_mean - mean_of_six), glm::length(got - slope_of_six)});
            mean_error += std::pow(got_mean - mean, 2) / double(particles.size());
            slope_error += std::pow(glm::length(got - slope), 2) / double(particles.size());
            darkest = std::min(darkest, mean);
            steepest = std::max(steepest, glm::length(slope));
        }
        // Of 1: the volumetric shadow map is made for a typical error of 0.003, and has ten times that at worst.
        EXPECT_LT(defined, 0.03);
        EXPECT_LT(std::sqrt(mean_error), 0.01);
        EXPECT_LT(std::sqrt(slope_error), 0.015);
        EXPECT_LT(darkest, 0.4);
        EXPECT_GT(steepest, 0.1);
    }
}

// Whether the opaque objects hide the light from a point, in double.
bool isHidden(const Scene& scene, glm::dvec3 x) {
    const glm::dvec3 l(scene.lights[0].to_light);
    for (const Sphere& sphere : scene.spheres) {
        const glm::dvec3 c = glm::dvec3(sphere.centre) - x;
        const double along = glm::dot(c, l), r = double(sphere.radius);
        if (glm::dot(c, c) < r * r || (along > 0 && glm::length(c - along * l) < r)) return true;
    }
    for (const Box& box : scene.boxes) {
        const double c = std::cos(double(box.yaw)), s = std::sin(double(box.yaw));
        const auto toBox = [&](glm::dvec3 v) { return glm::dvec3(c * v.x - s * v.z, v.y, s * v.x + c * v.z); };
        const glm::dvec3 from = toBox(x - glm::dvec3(box.centre)), up = toBox(l);
        double begin = 0, end = 1e9;
        for (int axis = 0; axis < 3; ++axis) {
            const double half = 0.5 * double(box.size[axis]),
                         inverse = 1 / (std::abs(up[axis]) < 1e-12 ? 1e-12 : up[axis]);
            const double a = (-half - from[axis]) * inverse, b = (half - from[axis]) * inverse;
            begin = std::max(begin, std::min(a, b));
            end = std::min(end, std::max(a, b));
        }
        if (begin < end) return true;
    }
    return false;
}

// No particle of which a part is lit and a part is not has cached light; most of the others have, and dark ones none.
TEST_F(GpuTest, ParticlesOnTheEdgeOfAShadowAreFound) {
    Random random(23);
    int lit = 0, dark = 0, cut = 0, needless = 0;
    for (int round = 0; round < 6; ++round) {
        std::vector<Point> points;
        for (int i = 0; i < 200; ++i) points.push_back({random.inCube(6), random.uniform(0.3f, 2), 0.01f});
        Scene scene = sceneOf(points, 1.6f);
        scene.render.tiles.light_tolerance = 1;
        scene.lights[0].to_light = glm::normalize(random.inCube(1) + glm::vec3(0, 1.2f, 0));
        for (int i = 0; i < 4; ++i) {
            scene.boxes.push_back({random.inCube(5),
                                   {random.uniform(0.2f, 4), random.uniform(0.2f, 4), random.uniform(0.2f, 4)},
                                   random.uniform(-3, 3),
                                   glm::vec3(0.5f)});
            scene.spheres.push_back({random.inCube(5), random.uniform(0.2f, 2), glm::vec3(0.5f)});
        }
        scene.planes = {{-7, glm::vec3(0.5f)}};
        const std::vector<gpu::Particle> particles = particlesOf(scene);
        const gpu::Tick tick = tickOf(scene, particles);
        const auto lights = lightOf(device(), scene, particles);
        for (size_t i = 0; i < particles.size(); ++i) {
            const gpu::Particle& p = particles[i];
            const double radius =
                std::max(double(physics::supportRadius(p.sigma_t, p.scale * tick.falloff, tick.cut)), 0.0);
            int hidden = 0;
            constexpr int kSamples = 400;
            for (int n = 0; n < kSamples; ++n) {
                const glm::dvec3 at = glm::dvec3(random.direction()) * radius * std::cbrt(double(random.uniform(0, 1)));
                hidden += isHidden(scene, glm::dvec3(p.centre) + at);
            }
            const bool looked_up = lights[i].transmittance == gpu::kLookUp, is_dark = lights[i].transmittance == 0;
            if (hidden > 0 && hidden < kSamples) {
                EXPECT_TRUE(looked_up) << round << ' ' << i << ": " << hidden;
                ++cut;
            } else if (looked_up) {
                ++needless;
            } else {
                EXPECT_EQ(is_dark, hidden == kSamples) << round << ' ' << i;
                ++(is_dark ? dark : lit);
            }
        }
    }
    EXPECT_GT(lit, 200);
    EXPECT_GT(dark, 20);
    EXPECT_GT(cut, 200);
    EXPECT_LT(needless, (lit + dark) / 2); // those that an edge comes near to, or that several shadows cover together
}

} // namespace
} // namespace brume::test::particle_light_test
