// The reference against exact answers, and against itself refined.
#include "tools/reference/medium_reference.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include "tools/reference/gauss_legendre.h"
#include "tools/reference/light_field.h"

namespace {

using namespace brume;
using namespace brume::reference;

constexpr Model kModels[] = {Model::overlapping, Model::sequential, Model::sequential_tetrahedron};

// Peak extinction that gives a Gaussian of this scale and falloff the optical depth `tau` through its centre.
float sigmaFor(double tau, double scale, double falloff) {
    return static_cast<float>(tau * std::sqrt(50.0) / (scale * falloff) / std::sqrt(kPi));
}

gpu::Particle particle(glm::vec3 centre, float scale, float sigma_t) { return {centre, scale, glm::vec3(1), sigma_t}; }

// rho p E = 1 for isotropic scattering.
Light unitLight(glm::vec3 to_light) {
    Light light;
    light.to_light = glm::normalize(to_light);
    light.irradiance = glm::vec3(static_cast<float>(4 * kPi));
    return light;
}

std::vector<gpu::Particle> randomCloud(int count, float extent, float scale, float sigma_t) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-0.5f, 0.5f);
    std::vector<gpu::Particle> particles;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 centre(unit(random), unit(random), unit(random));
        gpu::Particle p = particle(extent * centre, scale * (1 + unit(random)), sigma_t * (1 + unit(random)));
        p.albedo = glm::vec3(0.9f, 0.7f, 0.5f);
        particles.push_back(p);
    }
    return particles;
}

struct Pixel {
    double radiance, transmittance;
};
// Of the middle of a small picture.
Pixel look(std::span<const gpu::Particle> particles, double falloff, const Light& light, const Pose& pose, Model model,
           const Settings& settings = {}) {
    const Picture picture = render({particles, falloff, 0, 0}, light, pose, 1, 1, model, settings);
    return {picture.radiance[0].x, picture.transmittance[0]};
}

TEST(GaussLegendre, ExactForDegree2NMinus1) {
    for (const int n : {4, 8, 16}) {
        const GaussLegendre rule(n);
        double sum = 0;
        for (int i = 0; i < n; ++i)
            sum += rule.weight(i) * (std::pow(rule.node(i), 2 * n - 2) + std::pow(rule.node(i), 2 * n - 1));
        EXPECT_NEAR(sum, 2.0 / (2 * n - 1), 1e-14);
        GaussLegendre::Values<double> f{};
        for (int i = 0; i < n; ++i) f[i] = 1 + 3 * rule.node(i) - rule.node(i) * rule.node(i);
        EXPECT_NEAR(rule.coefficient(0, f), 1 - 1.0 / 3, 1e-14);
        EXPECT_NEAR(rule.coefficient(1, f), 3, 1e-14);
        EXPECT_NEAR(rule.coefficient(2, f), -2.0 / 3, 1e-14);
        EXPECT_NEAR(rule.coefficient(3, f), 0, 1e-14);
    }
}

TEST(ErfTable, AgainstLibm) {
    const ErfTable table;
    for (double q = -7; q < 7; q += 1e-4) {
        ASSERT_NEAR(table.at(q).erf, std::erf(q), 1e-13) << q;
        ASSERT_NEAR(table.at(q).gauss, std::exp(-q * q), 1e-13) << q;
        ASSERT_EQ(table.erf(q), table.at(q).erf);
    }
    EXPECT_EQ(table.erf(1e300), 1);
    EXPECT_EQ(table.erf(-kInfinity), -1);
}

TEST(LightField, EqualsTheWholeSum) {
    const auto cloud = randomCloud(200, 10, 3, 1.0f);
    const auto blobs = blobsOf(cloud, 1.6);
    const glm::dvec3 to_light = glm::normalize(glm::dvec3(0.3, 0.8, -0.4));
    const LightField field(blobs, to_light);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-8, 8);
    for (int i = 0; i < 300; ++i) {
        const glm::dvec3 x(unit(random), unit(random), unit(random));
        double sum = 0;
        for (const Blob& b : blobs) {
            const double s = glm::dot(x - b.centre, to_light), b2 = glm::dot(x - b.centre, x - b.centre) - s * s;
            sum += b.half_line * std::exp(-b.k * b.k * b2) * std::erfc(b.k * s);
        }
        EXPECT_NEAR(field.depth(x), sum, 1e-7);
    }
    EXPECT_EQ(field.depth({100, 100, 100}), 0);
}

TEST(PointField, EqualsTheWholeSum) {
    const auto blobs = blobsOf(randomCloud(200, 10, 3, 1.0f), 1.6);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-8, 8);
    for (const glm::dvec3 light : {glm::dvec3(0, 9, 2), glm::dvec3(0.5, 0.2, 0), glm::dvec3(-40, 3, 20)}) {
        const PointField field(blobs, light);
        double largest = 0;
        for (int i = 0; i < 300; ++i) {
            const glm::dvec3 x(unit(random), unit(random), unit(random)), w = glm::normalize(light - x);
            double sum = 0;
            for (const Blob& b : blobs) {
                const double s = glm::dot(b.centre - x, w), b2 = glm::dot(b.centre - x, b.centre - x) - s * s;
                sum += b.half_line * std::exp(-b.k * b.k * b2) *
                       (std::erf(b.k * (glm::length(light - x) - s)) - std::erf(-b.k * s));
            }
            EXPECT_NEAR(field.depth(x), sum, 1e-7);
            largest = std::max(largest, sum);
        }
        EXPECT_GT(largest, 1);
        EXPECT_EQ(field.depth(light), 0);
    }
}

TEST(OneGaussian, TransmittanceOfEveryPixel) {
    const gpu::Particle one = particle({0.4f, -0.3f, 0.2f}, 2, 1.3f);
    const Pose pose = lookAt({3, 4, 7}, {0, 0, 0}, 0.7f);
    const Picture picture = render({{&one, 1}, 1.6, 0, 0}, unitLight({0, 1, 0}), pose, 9, 5, Model::overlapping);
    const double k = std::sqrt(50.0) / (2 * 1.6f);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 9; ++x) {
            const double tan_y = std::tan(0.35);
            const glm::dvec3 in_view(((x + 0.5) / 9 * 2 - 1) * tan_y * 9 / 5, (1 - (y + 0.5) / 5 * 2) * tan_y, -1);
            const glm::dvec3 w = glm::normalize(glm::dquat(pose.orientation) * in_view);
            const glm::dvec3 across = glm::cross(glm::dvec3(one.centre) - glm::dvec3(pose.position), w);
            const double line = one.sigma_t * std::sqrt(kPi) / k * std::exp(-k * k * glm::dot(across, across));
            EXPECT_NEAR(picture.transmittance[static_cast<size_t>(y) * 9 + x], std::exp(-line), 1e-7) << x << " " << y;
        }
}

TEST(OneGaussian, LightFromBehindTheCameraAndTowardIt) {
    for (const double about : {1e-3, 0.5, 3.0, 40.0}) {
        const gpu::Particle one = particle({0, 0, 0}, 6, sigmaFor(about, 6, 1.6));
        const double tau = 2 * blobsOf({&one, 1}, 1.6)[0].half_line; // of the float extinction
        const Pose pose = lookAt({0, 0, 20}, {0, 0, 0}, 0.5f);
        for (const Model model : {Model::overlapping, Model::sequential}) {
            const Pixel with = look({&one, 1}, 1.6, unitLight({0, 0, 1}), pose, model);
            EXPECT_NEAR(with.radiance, (1 - std::exp(-2 * tau)) / 2, 3e-8 * with.radiance) << tau;
            EXPECT_NEAR(with.transmittance, std::exp(-tau), 1e-6 * with.transmittance) << tau;
            const Pixel against = look({&one, 1}, 1.6, unitLight({0, 0, -1}), pose, model);
            EXPECT_NEAR(against.radiance, tau * std::exp(-tau), 3e-8 * against.radiance) << tau;
        }
    }
}

TEST(OneGaussian, FromItsCentre) {
    const double tau = 2;
    const gpu::Particle one = particle({0, 0, 0}, 6, sigmaFor(tau, 6, 1.6));
    Pose pose; // looks along -z
    pose.position = {0, 0, 0};
    const Pixel pixel = look({&one, 1}, 1.6, unitLight({0, 0, 1}), pose, Model::overlapping);
    EXPECT_NEAR(pixel.transmittance, std::exp(-tau / 2), 1e-6);
    // Depth t seen and tau/2 + t shadowed.
    EXPECT_NEAR(pixel.radiance, std::exp(-tau / 2) * (1 - std::exp(-tau)) / 2, 1e-6);
}

TEST(TwoCoincident, OverlappingIsOneOfTwiceTheDensitySequentialIsNot) {
    const double tau = 1.2; // of each
    const gpu::Particle pair[2] = {particle({0, 0, 0}, 6, sigmaFor(tau, 6, 1.6)),
                                   particle({0, 0, 0}, 6, sigmaFor(tau, 6, 1.6))};
    const Pose pose = lookAt({0, 0, 20}, {0, 0, 0}, 0.5f);
    const Light light = unitLight({0, 0, 1});
    EXPECT_NEAR(look(pair, 1.6, light, pose, Model::overlapping).radiance, (1 - std::exp(-4 * tau)) / 2, 1e-6);
    // Each by itself: its own depth once for the view, both for the light.
    const double each = (1 - std::exp(-3 * tau)) / 3;
    EXPECT_NEAR(look(pair, 1.6, light, pose, Model::sequential).radiance, each * (1 + std::exp(-tau)), 1e-6);
}

// A lattice of Gaussians one standard deviation apart is a slab whose extinction depends on height alone.
TEST(LatticeOfGaussians, IsASlab) {
    const double tau = 1.7, light_cosine = 0.6, view_cosine = 0.85, scale = 1, falloff = 1.6;
    const double k = std::sqrt(50.0) / (scale * falloff), spacing = scale * falloff / 10;
    const auto sigma = static_cast<float>(tau * spacing * spacing / std::pow(std::sqrt(kPi) / k, 3));
    std::vector<gpu::Particle> sheet;
    for (int x = -30; x <= 30; ++x)
        for (int z = -30; z <= 30; ++z) {
            sheet.push_back(particle({static_cast<float>(x * spacing), 0, static_cast<float>(z * spacing)}, 1, sigma));
            sheet.back().albedo = glm::vec3(0.9f);
        }
    Light light;
    light.irradiance = glm::vec3(1);
    const auto view = static_cast<float>(view_cosine),
               side = static_cast<float>(std::sqrt(1 - view_cosine * view_cosine));
    const Pose above = lookAt(2.0f * glm::vec3(side, view, 0), {0, 0, 0}, 0.5f);
    const auto light_up = static_cast<float>(light_cosine);
    light.to_light = {0, light_up, 0.8f};
    const Pixel reflected = look(sheet, falloff, light, above, Model::overlapping);
    EXPECT_NEAR(reflected.transmittance, std::exp(-tau / view_cosine), 2e-6);
    EXPECT_NEAR(reflected.radiance, 0.0293998491338, 1e-7);
    light.to_light = {0, -light_up, 0.8f};
    EXPECT_NEAR(look(sheet, falloff, light, above, Model::overlapping).radiance, 0.0131526148731, 1e-7);
}

TEST(Furnace, ScatteredAndTransmittedSumToOne) {
    auto cloud = randomCloud(60, 10, 6, 0.5f);
    for (auto& p : cloud) p.albedo = glm::vec3(1);
    Settings settings;
    settings.shadows = false;
    for (const Pose& pose : {lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), lookAt({1, 0, 2}, {0, 0, 0}, 1.2f)}) {
        for (const Model model : kModels) {
            const Picture picture = render({cloud, 1.6, 0, 0}, unitLight({0, 1, 0}), pose, 16, 9, model, settings);
            for (size_t i = 0; i < picture.radiance.size(); ++i)
                ASSERT_NEAR(picture.radiance[i].x + picture.transmittance[i], 1, 2e-6)
                    << "model " << static_cast<int>(model);
        }
    }
}

TEST(Tetrahedron, ChordsOfAUniformOne) {
    const double sigma = 0.8, falloff = 1e4; // so wide that the extinction is constant inside
    const gpu::Particle one = particle({0, 0, 0}, 3, static_cast<float>(sigma));
    Settings settings;
    settings.shadows = false;
    const struct {
        glm::vec3 from;
        double chord;
    } views[] = {
        {glm::vec3(5), 4.0}, {glm::vec3(-5), 4.0}, {{0, 0, 9}, 6 / std::sqrt(3.0)}, {{0, 0, 0}, 3 / std::sqrt(3.0)}};
    for (const auto& view : views) {
        Pose pose = view.from == glm::vec3(0) ? Pose{} : lookAt(view.from, {0, 0, 0}, 0.5f);
        pose.position = view.from;
        const Pixel pixel =
            look({&one, 1}, falloff, unitLight({0, 1, 0}), pose, Model::sequential_tetrahedron, settings);
        EXPECT_NEAR(pixel.transmittance, std::exp(-sigma * view.chord), 1e-6) << view.chord;
        EXPECT_NEAR(pixel.radiance, 1 - std::exp(-sigma * view.chord), 1e-6);
    }
    // Past the vertex (1, -1, -1): nothing.
    const Pose beside = lookAt({4, 0, 9}, {4, 0, 0}, 0.5f);
    EXPECT_EQ(
        look({&one, 1}, falloff, unitLight({0, 1, 0}), beside, Model::sequential_tetrahedron, settings).transmittance,
        1);
}

TEST(Phase, ScalesTheRadiance) {
    const auto cloud = randomCloud(5, 4, 4, 0.5f);
    const Pose pose = lookAt({0, 0, 20}, {0, 0, 0}, 0.5f);
    const Light light = unitLight({0, 0, -1}); // travels straight at the camera
    const double g = 0.7, a = 0.4;
    const Picture isotropic = render({cloud, 1.6, 0, 0}, light, pose, 1, 1, Model::overlapping);
    const Picture forward = render({cloud, 1.6, a, g}, light, pose, 1, 1, Model::overlapping);
    const double expected = 1 - a + a * (1 - g * g) / std::pow(1 - g, 3);
    EXPECT_NEAR(forward.radiance[0].x / isotropic.radiance[0].x, expected, 1e-6 * expected);
    EXPECT_NEAR(isotropic.radiance[0].y / isotropic.radiance[0].x, 0.7 / 0.9, 1e-6)
        << "single scattering is linear in albedo";
}

TEST(Convergence, RefinementChangesNothing) {
    for (const float sigma_t : {0.5f, 3.0f}) {
        const auto cloud = randomCloud(60, 10, 5, sigma_t);
        const Pose pose = lookAt({0, 2, 22}, {0, 0, 0}, 0.6f);
        const Light light = unitLight({0.8f, 0.55f, 0.15f});
        Settings fine;
        fine.tolerance = 1e-10;
        for (const Model model : kModels) {
            const Picture coarse = render({cloud, 1.6, 0, 0}, light, pose, 24, 14, model);
            const Picture better = render({cloud, 1.6, 0, 0}, light, pose, 24, 14, model, fine);
            const double error = relativeRmse(coarse.radiance, better.radiance);
            std::printf("extinction %g, model %d: refinement changes the picture by %.2g\n",
                        static_cast<double>(sigma_t), static_cast<int>(model), error);
            EXPECT_LT(error, 1e-8);
        }
    }
}

TEST(Models, DifferWhereParticlesOverlap) {
    const auto cloud = randomCloud(100, 10, 6, 0.3f);
    const Pose pose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);
    const Light light = unitLight({0.8f, 0.55f, 0.15f});
    const Picture overlapping = render({cloud, 1.6, 0, 0}, light, pose, 32, 18, Model::overlapping);
    const Picture sequential = render({cloud, 1.6, 0, 0}, light, pose, 32, 18, Model::sequential);
    const double difference = relativeRmse(sequential.radiance, overlapping.radiance);
    std::printf("sequential against overlapping: %.3g\n", difference);
    EXPECT_GT(difference, 1e-3);
    EXPECT_LT(difference, 0.1);
    for (size_t i = 0; i < overlapping.transmittance.size(); ++i)
        EXPECT_DOUBLE_EQ(overlapping.transmittance[i], sequential.transmittance[i])
            << "transmittance does not depend on order";
}

TEST(World, OfASceneAsItIsNow) {
    Scene scene;
    scene.lights = {unitLight({0, 1, 0})};
    scene.planes = {{-2, glm::vec3(0.1f)}};
    scene.boxes = {{{1, 2, 3}, {2, 4, 6}, 0.5f, glm::vec3(0.2f)}};
    scene.spheres = {{{4, 5, 6}, 1.5f, glm::vec3(0.3f)}};
    scene.sky.ambient = glm::vec3(0.25f);
    const auto particles = randomCloud(3, 10, 6, 0.5f);
    brume::Medium medium = scene.medium; // both have changed since the start
    medium.falloff = 2;
    medium.asymmetry = 0.5f;
    brume::Light light = scene.lights[0];
    light.to_light = {0, 0, 1};
    const World world = worldOf(scene, particles, {medium, light, {}, {}});
    ASSERT_EQ(world.blobs.size(), 3u);
    EXPECT_NEAR(world.blobs[1].k, std::sqrt(50.0) / (2 * particles[1].scale), 1e-12);
    EXPECT_EQ(world.phase.asymmetry, 0.5);
    EXPECT_EQ(world.lights.at(0).to_light, glm::dvec3(0, 0, 1));
    EXPECT_EQ(world.ambient, glm::dvec3(0.25));
    ASSERT_EQ(world.obstacles.size(), 3u);
    EXPECT_EQ(nearest(world.obstacles, {{0, 9, 0}, {0, -1, 0}}).t, 11);
    EXPECT_NEAR(nearest(world.obstacles, {{1, 9, 3}, {0, -1, 0}}).t, 5, 1e-12) << "sizes are full lengths";
    EXPECT_NEAR(nearest(world.obstacles, {{4, 9, 6}, {0, -1, 0}}).t, 2.5, 1e-12);
}

TEST(RelativeRmse, CountsOnlyWhatIsBright) {
    const std::vector<glm::dvec3> reference = {glm::dvec3(1), glm::dvec3(0.5), glm::dvec3(1e-4)};
    const std::vector<glm::dvec3> value = {glm::dvec3(1.1), glm::dvec3(0.5), glm::dvec3(7)};
    EXPECT_NEAR(relativeRmse(value, reference), 0.1 / std::sqrt(1.25), 1e-12);
    EXPECT_EQ(relativeRmse(reference, reference), 0);
}

TEST(Nothing, IsBlackAndClear) {
    const Picture picture = render({{}, 1.6, 0, 0}, unitLight({0, 1, 0}), Pose{}, 2, 2, Model::sequential);
    EXPECT_EQ(picture.radiance[3], glm::dvec3(0));
    EXPECT_EQ(picture.transmittance[3], 1);
}

} // namespace
