#include "tools/random_scene/random_scene.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "common/scene_limits.h"
#include "common/scene_text.h"
#include "tools/random_scene/random_cameras.h"
#include "tools/random_scene/random_layout.h"
#include "tools/random_scene/random_lights.h"

namespace brume {
namespace {

// One stream of random numbers for each part: what one part draws does not move another's.
enum Part : uint64_t { features, positions, colours, lights, views, objects, fogs, local_lights, casters };

// exp(-x) for x >= 0, 3 % less at x = 4; from exact operations only.
double fading(double x) {
    double factor = std::max(1 - x / 256, 0.0);
    for (int i = 0; i < 8; ++i) factor *= factor;
    return factor;
}

// Mean optical depth of lines along the axes through up to 32 points. `extinction`: of each, at its centre.
double meanDepth(const RandomPoints& points, const std::vector<float>& extinction) {
    constexpr double kRootOfTwoPi = 2.5066282746310002;
    const size_t stride = (points.position.size() + 31) / 32;
    double sum = 0, lines = 0;
    for (size_t i = 0; i < points.position.size(); i += stride)
        for (int axis = 0; axis < 3; ++axis) {
            for (size_t j = 0; j < points.position.size(); ++j) {
                glm::dvec3 off = points.position[j] - points.position[i];
                off[axis] = 0;
                const double s = points.deviation[j];
                sum += kRootOfTwoPi * s * double(extinction[j]) * fading(0.5 * glm::dot(off, off) / (s * s));
            }
            ++lines;
        }
    return sum / lines;
}

glm::vec3 randomColour(Random& random) {
    const float r = random.uniform(0.2f, 1), g = random.uniform(0.2f, 1);
    return {r, g, random.uniform(0.2f, 1)};
}

void addColours(RandomScene& out, Random random) {
    const uint64_t kind = random.bits() % 3; // grey, one colour, a colour for each point
    const glm::vec3 one = kind == 0 ? glm::vec3(random.uniform(0.3f, 1)) : randomColour(random);
    for (size_t i = 0; i < out.points.position.size(); ++i)
        out.points.albedo.push_back(kind == 2 ? randomColour(random) : one);
    Medium& medium = out.scene.medium;
    medium.albedo = one;
    if (random.bits() % 3 == 0) return; // scatters evenly
    medium.anisotropy = random.uniform();
    medium.asymmetry = random.uniform(-0.9f, 0.9f);
}

void addPoints(RandomScene& out, uint32_t layout, uint32_t count, float radius) {
    Random random(out.seed, positions);
    const RandomPoints points = randomPoints(layout, count, out.spread, random);
    std::vector<float> extinction;
    for (size_t i = 0; i < points.position.size(); ++i) extinction.push_back(random.uniform(0.5f, 1.5f));
    const auto sigma_t = float(double(out.depth) / (meanDepth(points, extinction) * double(radius)));
    const float falloff = out.scene.medium.falloff;
    for (size_t i = 0; i < points.position.size(); ++i) {
        out.points.position.push_back(radius * points.position[i]);
        out.points.scale.push_back(limits::kScale.clamp(10 * radius * points.deviation[i] / falloff));
        out.points.sigma_t.push_back(limits::kSigmaT.clamp(extinction[i] * sigma_t));
    }
}

// 1 to `most` boxes and spheres among the points.
void addBodies(Scene& scene, Random& random, uint64_t most, float radius) {
    const uint64_t count = 1 + random.bits() % most;
    for (uint64_t i = 0; i < count; ++i) {
        const glm::vec3 at = 1.2f * radius * random.inBall();
        const float half = radius * random.uniform(0.05f, 0.3f);
        const bool is_box = random.bits() % 2 == 0;
        if (glm::distance(at, scene.camera.position) < 3 * half) continue; // no eye is in or right before an object
        if (is_box)
            scene.boxes.push_back({at, glm::vec3(2 * half, random.uniform(0.5f, 3) * half, 2 * half),
                                   random.uniform(-3, 3), randomColour(random)});
        else
            scene.spheres.push_back({at, half, randomColour(random)});
    }
}

void addObjects(RandomScene& out, Random random, float radius) {
    if (random.bits() % 3 != 0) return;
    Scene& scene = out.scene;
    if (random.bits() % 2 == 0) {
        const float height = -radius * random.uniform(0.3f, 1);
        scene.planes.push_back({height, randomColour(random)});
        glm::vec3& to_light = scene.lights.front().to_light; // from below it would light nothing
        to_light.y = std::abs(to_light.y);
        glm::vec3& eye = scene.camera.position; // the ground is seen from above only
        if (eye.y < height + 0.1f * radius) eye.y = height + 0.1f * radius + (height + 0.1f * radius - eye.y);
    }
    addBodies(scene, random, 3, radius);
}

void write(std::ofstream& out, const glm::vec3& v) { out.write(reinterpret_cast<const char*>(&v), sizeof v); }
void write(std::ofstream& out, float v) { out.write(reinterpret_cast<const char*>(&v), sizeof v); }

std::string fileName(const RandomScene& random) {
    return (random.kind == RandomKind::lit ? "random-lit-" : "random-") + std::to_string(random.seed);
}

void addLit(RandomScene& out, float radius) {
    Random random(out.seed, casters);
    if (random.bits() % 2 == 0) addBodies(out.scene, random, 6, radius);
    const LitPlace place{out.points.position, radius};
    addRandomFogs(out.scene, place, Random(out.seed, fogs));
    addRandomLights(out.scene, place, Random(out.seed, local_lights));
}

} // namespace

RandomScene randomScene(uint64_t seed, RandomKind kind) {
    const bool lit = kind == RandomKind::lit;
    RandomScene out;
    out.seed = seed;
    out.kind = kind;
    Random random(seed, features);
    const auto layout = uint32_t(random.bits() % randomLayouts().size());
    const auto count = uint32_t(logUniform(random, 1, lit ? 2000 : 20'000));
    out.layout = randomLayouts()[layout];
    out.spread = logUniform(random, 1, 30);
    out.depth = logUniform(random, 0.01f, 100);
    const auto width = uint32_t(logUniform(random, 160, lit ? 480 : 1920));
    out.size = {width, width * 9 / 16};
    const float radius = logUniform(random, 2, 50); // m

    Scene& scene = out.scene;
    scene.name = fileName(out);
    scene.medium.layout = Layout::file;
    scene.medium.file = fileName(out) + ".ply";
    addPoints(out, layout, count, radius);
    addColours(out, Random(seed, colours));
    Random light(seed, lights);
    scene.lights.push_back({.to_light = light.direction(), .irradiance = 10.0f * randomColour(light)});
    Random view(seed, views);
    out.camera = placeRandomCamera(scene.camera, out.points.position, radius, view);
    addObjects(out, Random(seed, objects), radius);
    if (lit) addLit(out, radius);
    return out;
}

std::filesystem::path save(const RandomScene& random, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    std::filesystem::path toml = folder / (fileName(random) + ".toml");
    std::ofstream ply(folder / random.scene.medium.file, std::ios::binary);
    ply << "ply\nformat binary_little_endian 1.0\nelement vertex " << random.points.position.size() << '\n';
    for (const char* property : {"x", "y", "z", "scale", "sigma_t", "red", "green", "blue"})
        ply << "property float " << property << '\n';
    ply << "end_header\n";
    for (size_t i = 0; i < random.points.position.size(); ++i) {
        write(ply, random.points.position[i]);
        write(ply, random.points.scale[i]), write(ply, random.points.sigma_t[i]);
        write(ply, random.points.albedo[i]);
    }
    std::ofstream text(toml);
    text << sceneToml(random.scene);
    if (!ply.flush() || !text.flush()) throw std::runtime_error(toml.string() + ": cannot be written");
    return toml;
}

} // namespace brume
