#include "tests/hard/hard.h"
#include "tests/gpu/quadrature.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iomanip>

#include "server/inputs/tick_block.h"
#include "server/methods/grid/node_grid_plan.h"
#include "server/methods/plans.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

struct Row {
    std::string hard_case, way;
    double error, tolerance;
    std::string refused; // why there is no error
};

std::vector<Row>& rows() {
    static std::vector<Row> all;
    return all;
}

// At the end of the program: the Markdown table, where BRUME_HARD_TABLE asks for it.
class TableWriter : public testing::Environment {
    void TearDown() override {
        const char* file = std::getenv("BRUME_HARD_TABLE");
        if (!file) return;
        std::ofstream out(file);
        out << "# Hard cases\n\n"
               "Every method, in float32, on what breaks naive renderers: the largest error against an exact\n"
               "answer, and the tolerance that the test demands; of several, the pair nearest to failing. What is\n"
               "compared, why it is hard and where the tolerance comes from stands with each case in `tests/hard`.\n"
               "Where a tetrahedron's faces cut a Gaussian, the error is what exceeds the rounding of its vertices\n"
               "to 1/256 pixel. Methods that take samples along a ray have bars of their own\n"
               "(`tests/hard/sampled_bars.cpp`). Made by\n"
               "`BRUME_HARD_TABLE=docs/results/data/hard-cases.md build/release/tests/hard_tests`.\n\n"
               "| case | method | error | tolerance |\n|---|---|---|---|\n";
        out << std::setprecision(2);
        for (const Row& row : rows())
            if (!row.refused.empty())
                out << "| " << row.hard_case << " | " << row.way << " | " << row.refused << " | |\n";
            else
                out << "| " << row.hard_case << " | " << row.way << " | " << row.error << " | " << row.tolerance
                    << " |\n";
    }
};

const testing::Environment* const kTableWriter = testing::AddGlobalTestEnvironment(new TableWriter);

} // namespace

std::string Way::name() const {
    if (quadrature.empty()) return method;
    return method + ", " + quadrature + (steps == 0 ? "" : '-' + std::to_string(steps));
}

std::vector<Way> allWays() {
    std::vector<Way> all;
    for (const MethodPlan* method : methodPlans()) {
        RenderSettings named;
        named.method = method->name();
        if (!method->draws(kSumMedium)) continue;
        if (!method->hasClosedForms()) continue;
        const SceneSetting* choice = quadratureSetting(named);
        if (!choice) {
            all.push_back({named.method, "", 0});
            continue;
        }
        for (const std::string_view quadrature : choice->choices) {
            if (quadrature == "taylor") continue; // a control that fails: tests/gpu/isv_printed_test.cpp measures how
            const bool has_steps = quadrature == "simpson" || quadrature == "transmittance";
            all.push_back({named.method, std::string(quadrature), has_steps ? 2u : 0u});
        }
    }
    return all;
}

std::vector<Way> sampledWays() {
    std::vector<Way> all;
    for (const char* method : {"froxels", "lit", "gradients", "march"}) all.push_back({method, "", 0});
    return all;
}

bool isSampled(const Way& way) {
    return std::ranges::any_of(sampledWays(), [&](const Way& one) { return one.method == way.method; });
}

void choose(Scene& scene, const Way& way) {
    scene.render.method = way.method;
    // As fine as they come, so that float32 is tested and not the grids' resolution, which other tests and sweeps
    // measure.
    scene.render.rate = 1;
    scene.render.slabs = 256;
    scene.render.grid.spacing = 0.08f;
    scene.render.froxels = {.pixels = 1, .slices = 512};
    scene.render.march = {.samples = 256, .dither = "none", .jitter = "opacity", .blur = "none"};
    if (way.quadrature.empty()) return;
    setQuadrature(scene.render, way.quadrature);
    scene.render.isv.steps = std::max(way.steps, 1u);
}

bool isCut(const Way& way) { return way.method == "isv"; }

Interval supportOf(const Way& way, const reference::Blob& blob, const Ray& ray) {
    return isCut(way) ? insideTetrahedron(blob, ray) : wholeRay(ray);
}

namespace {

// The light that the tiles' cached quadrature sees on a particle: the polynomial of shaders/particle_light.comp.
struct CachedLight {
    double centre = 0, curvature = 0; // T_L; of k^2 r^2
    glm::dvec3 gradient{0};           // 1/m
    double deviation = 0;             // of the points from the fit
};

CachedLight fitted(const reference::Blob& blob, const std::function<double(glm::dvec3)>& light_depth) {
    CachedLight fit;
    const double reach = std::sqrt(1.5) / blob.k;
    fit.centre = std::exp(-light_depth(blob.centre));
    glm::dvec3 bend;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0);
        step[axis] = reach;
        const double above = std::exp(-light_depth(blob.centre + step)),
                     below = std::exp(-light_depth(blob.centre - step));
        fit.gradient[axis] = (above - below) / (2 * reach);
        bend[axis] = (above + below) / 2 - fit.centre;
    }
    const double mean = (bend.x + bend.y + bend.z) / 3;
    for (int axis = 0; axis < 3; ++axis) fit.deviation = std::max(fit.deviation, std::abs(bend[axis] - mean));
    fit.curvature = mean / 1.5;
    return fit;
}

} // namespace

double scatteredBy(const Way& way, const reference::Blob& blob, const Ray& ray,
                   const std::function<double(glm::dvec3)>& light_depth_at) {
    return scatteredBy(way, blob, ray, supportOf(way, blob, ray), light_depth_at);
}

double scatteredBy(const Way& way, const reference::Blob& blob, const Ray& ray, Interval inside,
                   const std::function<double(glm::dvec3)>& light_depth_at) {
    const auto light_depth = [&](double t) { return light_depth_at(ray.at(t)); };
    if (way.method == "sphere" || way.quadrature == "hermite") return twoPoints(blob, ray, inside, light_depth);
    if (way.quadrature == "cached") {
        const CachedLight light = fitted(blob, light_depth_at);
        if (light.deviation > double(TilesSettings().light_tolerance) || 2 * blob.half_line > 0.55)
            return twoPoints(blob, ray, inside, light_depth);
        const auto polynomial = [&](double t) {
            const glm::dvec3 r = ray.at(t) - blob.centre;
            return light.centre + glm::dot(light.gradient, r) + light.curvature * blob.k * blob.k * glm::dot(r, r);
        };
        // May be negative at some places, not as a whole: the integral of it and enough, less that of enough.
        constexpr double kEnough = 100;
        const double opacity = -std::expm1(-depthOn(blob, ray, inside));
        const double lit = scatteredOn(blob, ray, inside, [&](double t) { return -std::log(polynomial(t) + kEnough); });
        return std::clamp(lit - kEnough * opacity, 0.0, opacity);
    }
    if (way.method != "isv") return scatteredOn(blob, ray, inside, light_depth);
    if (!(inside.length() > 0)) return 0;
    if (way.quadrature == "transmittance") return transmittanceSpace(blob, ray, inside, int(way.steps), light_depth);
    const double in = light_depth(inside.begin), out = light_depth(inside.end);
    const auto linear = [&](double t) { return glm::mix(in, out, (t - inside.begin) / inside.length()); };
    if (way.quadrature == "simpson") return simpson(blob, ray, inside, int(way.steps), linear);
    if (way.quadrature != "analytic") return scatteredOn(blob, ray, inside, light_depth);
    const double depth = depthOn(blob, ray, inside), x = depth + out - in;
    return depth * std::exp(-in) * (std::abs(x) < 1e-6 ? 1 - x / 2 : -std::expm1(-x) / x);
}

double ruleError(const Way& way) {
    // Where the light is scattered on average is known to 0.02 / k where a line is cut, and T_L changes by itself
    // within 1/k.
    if (way.quadrature == "cached") return 0.02;
    return way.method == "sphere" || !way.quadrature.empty() ? 0 : 0.15;
}

std::vector<Way> HardTest::ways() {
    std::vector<Way> all = allWays();
    if (whole() || std::getenv("BRUME_HARD_TABLE")) return all;
    std::vector<Way> chosen, others;
    for (const Way& way : all) (way.method == "slabs" || way.method == "grid" ? chosen : others).push_back(way);
    chosen.push_back(others[nextCase() % others.size()]);
    return chosen;
}

std::vector<Way> HardTest::waysAndSampled() {
    std::vector<Way> chosen = ways(), others = sampledWays();
    if (!whole() && !std::getenv("BRUME_HARD_TABLE")) others = {others[nextCase() % others.size()]};
    chosen.insert(chosen.end(), others.begin(), others.end());
    return chosen;
}

bool HardTest::refused(const std::string& hard_case, const Way& way, const Scene& scene) {
    if (way.method != "grid" && !isSampled(way)) return false;
    const std::vector<gpu::Particle> particles = particlesOf(scene);
    const gpu::Tick tick = makeTick(scene, Simulation(scene).now(), particles, {});
    const std::string why = gridRefusal(mediumExtent(particles, tick.falloff, tick.cut), scene.render);
    if (!why.empty()) note(hard_case, way, "refused: " + why);
    return !why.empty();
}

void HardTest::note(const std::string& hard_case, const Way& way, const std::string& why) {
    const auto known = [&](const Row& row) { return row.hard_case == hard_case && row.way == way.name(); };
    if (std::ranges::none_of(rows(), known)) rows().push_back({hard_case, way.name(), 0, 0, why});
}

void HardTest::judge(const std::string& hard_case, const std::string& way, double error, double tolerance) {
    EXPECT_LE(error, tolerance) << hard_case << ": " << way;
    for (Row& row : rows()) {
        if (row.hard_case != hard_case || row.way != way) continue;
        // With a tolerance of 0 only the error tells.
        if (!(tolerance > 0 ? error / tolerance <= row.error / row.tolerance : error <= row.error))
            row = {hard_case, way, error, tolerance, {}};
        return;
    }
    const auto same_case = [&](const Row& row) {
        return row.hard_case == hard_case;
    }; // the rows of a case stand together
    const auto after = std::find_if(rows().rbegin(), rows().rend(), same_case).base();
    rows().insert(after == rows().begin() ? rows().end() : after, {hard_case, way, error, tolerance, {}});
}

double HardTest::rounding() { return std::max(0.0, subpixel(device()) - 1.0 / 256); }

double HardTest::drawnElsewhere(const Way& way, const reference::Blob& blob, const Pose& pose, uint32_t width,
                                uint32_t height, uint32_t x, uint32_t y, const std::function<double(Interval)>& value) {
    const bool crossed = verticesBehind({glm::vec3(blob.centre), float(blob.scale)}, pose) > 0;
    if (!isCut(way) || crossed || rounding() == 0) return 0;
    const double here = value(insideTetrahedron(blob, rayThrough(pose, width, height, x, y)));
    double most = 0;
    for (const double right : {-1.0, 0.0, 1.0})
        for (const double down : {-1.0, 0.0, 1.0}) {
            const glm::dvec2 off = rounding() * glm::dvec2(right, down);
            most = worse(most, std::abs(value(insideTetrahedronDrawn(blob, pose, width, height, x, y, off)) - here));
        }
    return most;
}

HardTest::Seen HardTest::transmittance(Stage& stage, Scene scene, const Way& way, const Pose& pose, uint32_t width,
                                       uint32_t height, uint32_t stride) {
    choose(scene, way);
    const auto blobs = blobsOf(scene);
    const bool rounded = isCut(way) && scene.medium.falloff > kInside;
    const auto exactly = [&](uint32_t x, uint32_t y) {
        const Ray ray = rayThrough(pose, width, height, x, y);
        double depth = 0;
        for (const reference::Blob& blob : blobs) depth += depthOn(blob, ray, supportOf(way, blob, ray));
        return std::exp(-depth);
    };
    Seen seen;
    forPixels(stage.see(scene, pose, width, height), pose, [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
        for (int c = 0; c < 4; ++c) seen.error = worse(seen.error, 0 * got[c]);
        if ((x + 7 * y) % stride != 0) return;
        const double here = exactly(x, y);
        double slope = 0; // per pixel
        for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)}) {
            const glm::uvec2 there = glm::uvec2(glm::ivec2(x, y) + step);
            if (rounded && there.x < width && there.y < height)
                slope = std::max(slope, std::abs(here - exactly(there.x, there.y)));
        }
        double elsewhere = 0; // optical depth
        for (const reference::Blob& blob : blobs)
            if (rounded)
                elsewhere += drawnElsewhere(way, blob, pose, width, height, x, y,
                                            [&](Interval inside) { return depthOn(blob, ray, inside); });
        seen.error = worse(seen.error, std::abs(got.a - here) - slope / 256 - here * std::expm1(elsewhere));
        seen.lowest = std::min(seen.lowest, here);
        seen.covered += here < 1 - 1e-3;
    });
    return seen;
}

double worse(double a, double b) { return b <= a || std::isnan(a) ? a : b; }

int differing(const Picture& a, const Picture& b) {
    int count = 0;
    using Bits = std::array<uint32_t, 4>; // also of what is no number
    for (size_t i = 0; i < a.pixels.size(); ++i)
        count += i >= b.pixels.size() || std::bit_cast<Bits>(a.pixels[i]) != std::bit_cast<Bits>(b.pixels[i]);
    return count;
}

} // namespace brume::test
