// The criterion by which method gradients splits samples as printed: equation 5 of Ren et al. (2008), by hand values.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/gpu/judged.h"

namespace brume::test::shading_error_test {
namespace {

const Pose kPose = lookAt({2, 1.5f, 7}, {0, 0, 0}, 0.9f);

class ShadingErrorTest : public JudgedTest {
protected:
    // Samples that are kept, of pictures by one renderer.
    class Samples {
    public:
        explicit Samples(const Scene& scene) : renderer_(device(), scene, 600), submission_(device(), "test") {}
        uint64_t of(const Scene& scene) {
            const std::vector<EyeRequest> eyes{{.pose = kPose, .width = 96, .height = 64}};
            const LightWork before = renderer_.countLightWork();
            submitAndWait(renderer_, submission_, Simulation(scene), eyes);
            return (renderer_.countLightWork() - before).samples;
        }

    private:
        Renderer renderer_;
        Submission submission_;
    };
};

// Fog that is the same everywhere, and a point in the middle of the nodes: the printed criterion in double, of eight
// samples in strata and of those of grids.
class ShadingErrors {
public:
    static constexpr double kSpacing = 0.5, kSigma = 0.05, kIntensity = 90, kRadius = 0.3;
    static constexpr int kFirsts = 8, kCells = 16;

    static Scene scene() {
        Scene scene;
        scene.medium.layout = Layout::none;
        scene.fogs = {{.extinction = float(kSigma), .albedo = glm::vec3(0.9f)}};
        scene.lights = {{.type = kPoint,
                         .position = {0, 0, 0},
                         .intensity = glm::vec3(float(kIntensity)),
                         .radius = float(kRadius)}};
        scene.render.method = "gradients";
        scene.render.froxels = {.pixels = 16, .slices = 8};
        // Nine: the cube root of eight could be rounded up.
        scene.render.radiance = {.interpolation = "gradient",
                                 .quantity = "radiance",
                                 .criterion = "printed",
                                 .near = 0,
                                 .spacing = float(kSpacing),
                                 .samples = 9};
        return scene;
    }

    // Nodes reach 10 m around the light, in whole bricks.
    const glm::dvec3 origin{-10};
    const double size = 47 * kSpacing, cell = size / kCells, box = 48 * kSpacing;

    static double light(glm::dvec3 x) {
        const double d = glm::length(x);
        return kIntensity * std::exp(-kSigma * d) / (d * d + kRadius * kRadius);
    }
    static double through(glm::dvec3 x) { return std::exp(-kSigma * glm::distance(x, glm::dvec3(kPose.position))); }
    double errorOf(glm::dvec3 x, double radius, double passed) const {
        const double scale = kIntensity / std::pow(0.25 * size, 2); // the middle of the nodes is nearer
        double errors = 0;
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 apart(0), off(0);
            apart[axis] = kSpacing, off[axis] = radius;
            const double along = (light(x + apart) - light(x - apart)) / (2 * kSpacing);
            for (const double side : {1.0, -1.0})
                errors += std::abs(std::max(light(x) + side * radius * along, 0.0) - light(x + side * off)) / 6;
        }
        return std::pow(radius / box, 3) * errors / scale * kSigma * box * passed;
    }
    static glm::dvec3 jitterOf(glm::uvec3 v) { // pcg3d
        v = v * 1664525u + 1013904223u;
        v += glm::uvec3(v.y * v.z, v.z * v.x, v.x * v.y);
        v ^= v >> 16u;
        v += glm::uvec3(v.y * v.z, v.z * v.x, v.x * v.y);
        return glm::dvec3(v >> 8u) / 16777216.0;
    }
    glm::dvec3 first(uint32_t i) const {
        const glm::uvec3 at(i % 2, i / 2 % 2, i / 4);
        return origin + 0.5 * size * (glm::dvec3(at) + jitterOf(at));
    }
    const double first_radius = 0.5 * size * std::sqrt(3.0);
    glm::dvec3 vertex(int level, glm::ivec3 at) const { return origin + cell / (1 << level) * glm::dvec3(at); }
    template <class Visit>
    void eachVertex(int level, const Visit& visit) const {
        const int count = (kCells << level) + 1;
        for (int i = 0; i < count * count * count; ++i)
            visit(size_t(i), vertex(level, {i % count, i / count % count, i / count / count}));
    }
};

// Samples are split where equation 5 of Ren et al. (2008) is more than what is allowed, and nowhere else.
TEST_F(ShadingErrorTest, SplitsWhereEquation5IsLarger) {
    const ShadingErrors hand;
    Scene scene = ShadingErrors::scene();
    scene.render.radiance.levels = 1;
    Samples kept_of(scene);
    std::vector<std::pair<double, glm::dvec3>> firsts;
    for (uint32_t i = 0; i < ShadingErrors::kFirsts; ++i) {
        const glm::dvec3 x = hand.first(i);
        firsts.emplace_back(hand.errorOf(x, hand.first_radius, ShadingErrors::through(x)), x);
    }
    std::sort(firsts.begin(), firsts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    uint64_t before = 0;
    for (size_t kept = 0; kept <= firsts.size(); ++kept) {
        const double below = kept > 0 ? firsts[kept - 1].first : 0,
                     above = kept < firsts.size() ? firsts[kept].first : 2 * below;
        if (above / std::max(below, 1e-9) < 1.001) continue;
        scene.render.radiance.error = float(0.5 * (below + above));
        uint64_t expected = kept;
        hand.eachVertex(0, [&](size_t, glm::dvec3 x) {
            bool wanted = false;
            for (size_t i = kept; i < firsts.size(); ++i)
                wanted = wanted || glm::distance(x, firsts[i].second) <= hand.first_radius;
            expected += wanted;
        });
        const uint64_t samples = kept_of.of(scene);
        std::printf("%zu kept below %.4g: %llu samples\n", kept, 0.5 * (below + above), (unsigned long long)samples);
        EXPECT_EQ(samples, expected) << kept;
        EXPECT_NE(samples, before);
        before = samples;
    }
    EXPECT_GT(before, 0u);
}

// Samples of grids have the transmittance of the first spheres around them, the largest, and not that of their own.
TEST_F(ShadingErrorTest, SamplesOfGridsInheritTheTransmittance) {
    const ShadingErrors hand;
    // Error of each vertex of the first grid by the transmittance of its own, and by that of the first spheres.
    std::vector<double> own, inherited;
    hand.eachVertex(0, [&](size_t, glm::dvec3 x) {
        double passed = 0;
        for (uint32_t i = 0; i < ShadingErrors::kFirsts; ++i)
            if (glm::distance(x, hand.first(i)) <= hand.first_radius)
                passed = std::max(passed, ShadingErrors::through(hand.first(i)));
        own.push_back(hand.errorOf(x, hand.cell, passed > 0 ? ShadingErrors::through(x) : 0));
        inherited.push_back(hand.errorOf(x, hand.cell, passed));
    });
    // In the middle of the widest gap of errors about the median, so that rounding splits no other samples.
    std::vector<double> sorted = inherited;
    std::sort(sorted.begin(), sorted.end());
    double allowed = 0, widest = 1;
    for (size_t i = sorted.size() * 2 / 5; i < sorted.size() * 3 / 5; ++i)
        if (sorted[i + 1] / sorted[i] > widest)
            widest = sorted[i + 1] / sorted[i], allowed = 0.5 * (sorted[i] + sorted[i + 1]);
    ASSERT_GT(widest, 1.0001);
    // Samples that are kept if those are split: of the first grid, and of the next one in the spheres of others.
    // Whether these hold the six that are on them is a matter of rounding.
    struct Count {
        uint64_t least = 0, most = 0;
    };
    const auto countOf = [&](const std::vector<double>& errors) {
        constexpr int kFine = 2 * ShadingErrors::kCells + 1, kCoarse = ShadingErrors::kCells + 1;
        std::vector<char> inside(size_t(kFine * kFine * kFine)), on = inside;
        Count count;
        for (int v = 0; v < kCoarse * kCoarse * kCoarse; ++v) {
            const bool known = errors[size_t(v)] > 0, kept = errors[size_t(v)] <= allowed;
            if (known && kept) ++count.least;
            if (kept) continue;
            const glm::ivec3 at = 2 * glm::ivec3(v % kCoarse, v / kCoarse % kCoarse, v / kCoarse / kCoarse);
            for (int n = 0; n < 125; ++n) {
                const glm::ivec3 off = glm::ivec3(n % 5, n / 5 % 5, n / 25) - 2, other = at + off;
                const int square = off.x * off.x + off.y * off.y + off.z * off.z;
                if (square > 4 || std::min({other.x, other.y, other.z}) < 0 ||
                    std::max({other.x, other.y, other.z}) >= kFine)
                    continue;
                (square < 4 ? inside : on)[(size_t(other.z) * kFine + size_t(other.y)) * kFine + size_t(other.x)] = 1;
            }
        }
        count.most = count.least;
        for (size_t i = 0; i < inside.size(); ++i) count.least += inside[i], count.most += inside[i] || on[i];
        return count;
    };
    const Count expected = countOf(inherited), other = countOf(own);
    ASSERT_TRUE(other.most < expected.least || other.least > expected.most) << "this test cannot tell";
    Scene scene = ShadingErrors::scene();
    scene.render.radiance.levels = 2;
    scene.render.radiance.error = float(allowed);
    const uint64_t samples = Samples(scene).of(scene);
    std::printf("%llu samples, expected %llu to %llu, of their own %llu to %llu\n", (unsigned long long)samples,
                (unsigned long long)expected.least, (unsigned long long)expected.most, (unsigned long long)other.least,
                (unsigned long long)other.most);
    EXPECT_GE(samples, expected.least);
    EXPECT_LE(samples, expected.most);
}

} // namespace
} // namespace brume::test::shading_error_test
