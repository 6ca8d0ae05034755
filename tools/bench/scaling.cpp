#include "tools/bench/scaling.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "common/random.h"
#include "common/scene_text.h"
#include "tools/bench/stage.h"

namespace brume::bench {
namespace {

constexpr glm::uvec2 kSize{640, 360};
constexpr uint32_t kLights[] = {1, 4, 16, 64, 256, 1024}, kBoxCounts[] = {10, 100, 1000, 4000};
constexpr uint32_t kMostShadowed = 64; // lights that particles may dim
constexpr float kRange = 4;            // m, of lights that end
constexpr double kHidden = 0.005;      // ms: a pass that takes less in all rows has no column

// Rays and slabs alike in all rows: times tell what lights and objects cost, not what the plan makes of them.
RenderSettings fixedSettings() {
    RenderSettings settings;
    settings.method = "slabs", settings.rate = 4, settings.slabs = 48;
    return settings;
}

Scene groundAndFog() {
    Scene scene;
    scene.medium.layout = Layout::none;
    scene.planes = {{.height = -3}};
    scene.fogs = {{.extinction = 0.02f}};
    scene.camera = {.position = {0, 3, 24}, .target = {0, 0, 0}};
    scene.render = fixedSettings();
    return scene;
}

Scene cloud() {
    Scene scene;
    scene.medium.count = 500;
    scene.medium.extinction = 52;
    scene.planes = {{.height = -7}};
    scene.camera = {.position = {0, 2, 26}, .target = {0, 0, 0}};
    scene.render = fixedSettings();
    return scene;
}

// Points and spots by turns, evenly at random in a box of 20 x 5 x 20 m.
std::vector<Light> manyLights(uint32_t count, float range, bool shadows) {
    std::vector<Light> lights;
    for (uint32_t i = 0; i < count; ++i) {
        Random random(1, i);
        Light light;
        light.type = i % 2 == 0 ? kPoint : kSpot;
        light.position = glm::vec3(10, 2.5f, 10) * random.inBox();
        light.axis = random.direction();
        light.outer = 0.7f, light.inner = 0.5f;
        light.intensity = glm::vec3(20), light.radius = 0.05f;
        light.range = range, light.shadows = shadows;
        lights.push_back(light);
    }
    return lights;
}

// Boxes that stand on the ground, 70 x 70 m.
std::vector<Box> manyBoxes(uint32_t count) {
    std::vector<Box> boxes;
    for (uint32_t i = 0; i < count; ++i) {
        Random random(2, i);
        const glm::vec3 at = glm::vec3(35, 0, 35) * random.inBox();
        const float side = random.uniform(0.3f, 1.2f), height = random.uniform(0.3f, 4);
        boxes.push_back({{at.x, 0.5f * height, at.z}, {side, height, side}, random.uniform(-3, 3), glm::vec3(0.5f)});
    }
    return boxes;
}

Scene boxes(uint32_t count) {
    Scene scene;
    scene.medium.layout = Layout::none;
    scene.planes = {{}};
    scene.boxes = manyBoxes(count);
    scene.lights.emplace_back();
    scene.camera = {.position = {0, 14, 42}, .target = {0, 0, 0}};
    scene.render = fixedSettings();
    return scene;
}

// A lamp high above all boxes.
Light lamp(bool shadows) {
    Light light;
    light.type = kPoint;
    light.position = {5, 25, 8}, light.intensity = glm::vec3(2000), light.shadows = shadows;
    return light;
}

// Scenes that are timed in turns, and what they took.
class Rows {
public:
    Rows(const gpu::Device& device, std::filesystem::path folder) : device_(device), folder_(std::move(folder)) {}

    void add(std::string name, Scene scene) {
        scene.name = fmt::format("scaling-{}", rows_.size());
        const std::filesystem::path file = folder_ / (scene.name + ".toml");
        std::ofstream out(file);
        out << sceneToml(scene);
        if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
        const Case wanted{.scene = file.string(), .size = kSize};
        rows_.push_back({std::move(name), std::make_unique<Stage>(device_, wanted), {}});
    }

    void time(uint32_t frames) {
        for (Row& row : rows_) row.stage->frame(); // compiles shaders, fits buffers
        for (uint32_t i = 0; i < frames; ++i)
            for (Row& row : rows_) row.frames.push_back(row.stage->frame());
    }

    // Median ms of a view's passes of that name, or of all.
    double msOf(size_t row, std::string_view name) const {
        return sumOf(rows_[row], [&](const FrameCost::Pass& p) { return p.name == name; });
    }
    double viewMs(size_t row) const {
        return sumOf(rows_[row], [](const FrameCost::Pass& p) { return !p.shared; });
    }
    Stage& stage(size_t row) { return *rows_[row].stage; }

    // A row a scene: the view, what viewers share, and each pass that takes time.
    std::string table(std::string_view head) const {
        std::vector<std::string> names;
        for (const Row& row : rows_)
            for (const FrameCost::Pass& pass : row.frames.front().passes)
                if (std::ranges::find(names, pass.name) == names.end()) names.push_back(pass.name);
        std::erase_if(names, [&](const std::string& name) {
            return std::ranges::all_of(rows_, [&](const Row& row) {
                return sumOf(row, [&](const FrameCost::Pass& p) { return p.name == name; }) < kHidden;
            });
        });
        std::string text = fmt::format("| {} | a view, ms | shared, ms |", head), line = "\n|---|---|---|";
        for (const std::string& name : names) text += ' ' + name + " |", line += "---|";
        text += line + '\n';
        for (const Row& row : rows_) {
            text += fmt::format("| {} | {:.2f} | {:.2f} |", row.name,
                                sumOf(row, [](const FrameCost::Pass& p) { return !p.shared; }),
                                sumOf(row, [](const FrameCost::Pass& p) { return p.shared; }));
            for (const std::string& name : names)
                text += fmt::format(" {:.2f} |", sumOf(row, [&](const auto& pass) { return pass.name == name; }));
            text += '\n';
        }
        return text + '\n';
    }

    void say(std::string_view what) const {
        for (size_t i = 0; i < rows_.size(); ++i)
            std::fprintf(stderr, "  %.*s: %-24s %9.2f ms a view\n", int(what.size()), what.data(),
                         rows_[i].name.c_str(), viewMs(i));
    }

private:
    struct Row {
        std::string name;
        std::unique_ptr<Stage> stage;
        std::vector<FrameCost> frames;
    };
    template <class Counts>
    static double sumOf(const Row& row, Counts counts) {
        std::vector<double> all;
        for (const FrameCost& frame : row.frames) {
            double sum = 0;
            for (const FrameCost::Pass& pass : frame.passes)
                if (counts(pass)) sum += pass.ms;
            all.push_back(sum);
        }
        return median(all);
    }

    const gpu::Device& device_;
    std::filesystem::path folder_;
    std::vector<Row> rows_;
};

// Pixels whose surface the lamp reaches when nothing shadows it: each asks for one ray, and five where an edge is.
size_t pixelsLit(Stage& with, Stage& without) {
    const RadianceImage a = with.picture(with.pose(), kSize), b = without.picture(without.pose(), kSize);
    size_t count = 0;
    for (size_t i = 0; i < a.radiance.size(); ++i) count += a.radiance[i] != b.radiance[i];
    return count;
}

std::string lightTable(const gpu::Device& device, uint32_t frames, const std::filesystem::path& folder,
                       const char* what, const Scene& scene, std::span<const uint32_t> counts, float range,
                       bool shadows) {
    Rows rows(device, folder);
    rows.add("none", scene);
    for (const uint32_t count : counts) {
        Scene lit = scene;
        const std::vector<Light> lights = manyLights(count, range, shadows);
        lit.lights.insert(lit.lights.end(), lights.begin(), lights.end());
        rows.add(std::to_string(count), std::move(lit));
    }
    rows.time(frames);
    rows.say(what);
    return rows.table("points and spots");
}

std::string boxTable(const gpu::Device& device, uint32_t frames, const std::filesystem::path& folder) {
    Rows rows(device, folder);
    for (const uint32_t count : kBoxCounts) rows.add(fmt::format("{}", count), boxes(count));
    rows.time(frames);
    rows.say("boxes");
    return rows.table("boxes");
}

// What shadows of the lamp add to the surfaces' pass, by the pixels that ask for them.
std::string shadowRayTable(const gpu::Device& device, uint32_t frames, const std::filesystem::path& folder) {
    std::string out =
        "| boxes | surfaces, ms | with a lamp without shadows | with its shadows | pixels that it reaches "
        "| ns a pixel |\n|---|---|---|---|---|---|\n";
    for (const uint32_t count : kBoxCounts) {
        Rows rows(device, folder);
        const Scene plain = boxes(count);
        rows.add("the sun alone", plain);
        for (const bool shadows : {false, true}) {
            Scene lit = plain;
            lit.lights.push_back(lamp(shadows));
            rows.add(shadows ? "shadows" : "no shadows", std::move(lit));
        }
        rows.time(frames);
        rows.say(fmt::format("shadow rays, {} boxes", count));
        const size_t pixels = pixelsLit(rows.stage(1), rows.stage(0));
        const double free = rows.msOf(1, "opaque"), shadowed = rows.msOf(2, "opaque");
        out += fmt::format("| {} | {:.2f} | {:.2f} | {:.2f} | {} | {:.0f} |\n", count, rows.msOf(0, "opaque"), free,
                           shadowed, pixels, 1e6 * (shadowed - free) / double(std::max<size_t>(pixels, 1)));
    }
    return out + '\n';
}

} // namespace

std::string scalingTables(const gpu::Device& device, uint32_t frames, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    const std::span<const uint32_t> all = kLights, few = all.first(3);
    const auto shadowed = all.first(size_t(std::ranges::find(kLights, kMostShadowed) - std::begin(kLights)) + 1);
    std::string out =
        fmt::format("## Points and spots\n\nPoints and spots by turns, at random places of 20 x 5 x 20 m, "
                    "each with a range of {} m. So more of them overlap, the more there are.\n\n",
                    kRange);
    out += "Homogeneous fog over the ground, without particles:\n\n" +
           lightTable(device, frames, folder, "fog", groundAndFog(), all, kRange, true);
    out += "The same without a range: each light reaches every pixel.\n\n" +
           lightTable(device, frames, folder, "fog, no range", groundAndFog(), few, 0, true);
    out += "500 particles over the ground; neither objects nor particles shadow the lights:\n\n" +
           lightTable(device, frames, folder, "particles, no shadows", cloud(), all, kRange, false);
    out += fmt::format("The same with shadows. At most {} lights may have them among particles. Each has a volume of "
                       "the particles' depth, which is shared and made once a tick while they move:\n\n",
                       kMostShadowed) +
           lightTable(device, frames, folder, "particles, shadows", cloud(), shadowed, kRange, true);
    out += "## Boxes\n\nBoxes on 70 x 70 m of ground in the sun, seen from above their edge, without a medium. Aim: at "
           "most 15 ms a view with 4,000 boxes.\n\n" +
           boxTable(device, frames, folder);
    out += "A shadow ray: the same with one lamp above, which reaches all that is seen. What its shadows add to the "
           "surfaces' pass, over the pixels that the lamp reaches without them. Where an edge crosses, a pixel asks "
           "for up to five rays. Aim: at most 200 ns a ray.\n\n" +
           shadowRayTable(device, frames, folder);
    return out;
}

} // namespace brume::bench
