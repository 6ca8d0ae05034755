#include "tools/bench/stage.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <regex>
#include <stdexcept>

#include <glm/gtc/quaternion.hpp>

#include "server/sim/point_cloud.h"
#include "tools/bench/stand.h"

namespace brume::bench {
namespace {

Simulation stepped(const Scene& scene, uint32_t ticks) {
    Simulation simulation(scene);
    for (uint32_t i = 0; i < ticks; ++i) simulation.step({});
    return simulation;
}

} // namespace

Pose turnedAbout(const Pose& pose, glm::vec3 target, float angle) {
    const glm::quat turn = glm::angleAxis(angle, glm::vec3(0, 1, 0));
    Pose turned = pose;
    turned.position = target + turn * (pose.position - target);
    turned.orientation = turn * pose.orientation;
    return turned;
}

Scene sceneOf(const Case& wanted) {
    Scene scene = loadScene(findScene(wanted.scene, BRUME_SCENES), wanted.set);
    const std::string wrong = checkWanted(scene.render, wanted.scene, wanted.set);
    if (!wrong.empty()) throw SceneError(wrong);
    if (wanted.lights > 0) scene.lights.resize(std::min<size_t>(scene.lights.size(), wanted.lights));
    placeCamera(scene);
    return scene;
}

Pose poseOf(const std::string& camera, const Scene& scene, const Simulation& simulation) {
    const SceneCamera& own = scene.camera;
    const glm::vec3 way = glm::normalize(own.target - own.position);
    if (camera == "outside") return lookAt(own.position, own.target, own.fov_y);
    if (camera == "inside") {
        const glm::vec3 middle = 0.5f * (simulation.bounds().lo + simulation.bounds().hi);
        return lookAt(middle, middle + way, own.fov_y);
    }
    const std::string number = R"(([-+0-9.eE]+))", place = number + ',' + number + ',' + number;
    std::smatch found;
    if (std::regex_match(camera, found, std::regex(number + "m")))
        return lookAt(own.target - std::stof(found[1]) * way, own.target, own.fov_y);
    if (std::regex_match(camera, found, std::regex(place + "(:" + place + ")?"))) {
        const glm::vec3 from(std::stof(found[1]), std::stof(found[2]), std::stof(found[3]));
        if (!found[4].matched) return lookAt(from, own.target, own.fov_y);
        return lookAt(from, {std::stof(found[5]), std::stof(found[6]), std::stof(found[7])}, own.fov_y);
    }
    throw std::runtime_error("no camera \"" + camera +
                             "\"; there are: outside, inside, a distance like 20m, x,y,z, x,y,z:x,y,z");
}

std::vector<Pose> posesOf(const Case& wanted, const Scene& scene, const Simulation& simulation) {
    const Stand& stand = wanted.stand;
    if (stand.inside) return standInside(scene, simulation.bounds(), wanted.viewers);
    const Pose first = poseOf(wanted.camera, scene, simulation);
    std::vector<Pose> poses(wanted.viewers, first);
    for (uint32_t i = 0; i < wanted.viewers; ++i)
        if (stand.eyes_apart > 0)
            poses[i].position += float(i) * stand.eyes_apart * (first.orientation * glm::vec3(1, 0, 0));
        else if (stand.apart > 0)
            poses[i] = turnedAbout(first, first.position, glm::radians(stand.apart) * float(i));
        else
            poses[i] = turnedAbout(first, scene.camera.target,
                                   2 * std::numbers::pi_v<float> * float(i) / float(wanted.viewers));
    return poses;
}

bool isMediumAlone(const Scene& scene) {
    const glm::vec3 none(0);
    return scene.sky.zenith == none && scene.sky.horizon == none && scene.sky.ambient == none;
}

glm::uvec2 sizeOf(const std::string& text) {
    std::smatch found;
    if (std::regex_match(text, found, std::regex("([0-9]{1,5})x([0-9]{1,5})"))) {
        const glm::uvec2 size(std::stoul(found[1]), std::stoul(found[2]));
        if (size.x > 0 && size.y > 0 && size.x <= 8192 && size.y <= 8192) return size;
    }
    throw std::runtime_error("no size \"" + text + "\"; allowed: 1x1 to 8192x8192");
}

Stage::Stage(const gpu::Device& device, const Case& wanted, uint32_t ticks, const CostModel& costs)
    : device_(device), bytes_before_(device.memoryInUse()), scene_(sceneOf(wanted)),
      simulation_(stepped(scene_, ticks)), renderer_(device, scene_, simulation_.capacity(), wanted.besides),
      submission_(device, "bench") {
    for (const Pose& pose : posesOf(wanted, scene_, simulation_))
        eyes_.push_back(
            {.pose = pose, .width = wanted.size.x, .height = wanted.size.y, .history = uint64_t(eyes_.size() + 1)});
    PlanInputs inputs{.scene = planScene(scene_, simulation_), .methods = allMethods()};
    for (const EyeRequest& eye : eyes_) inputs.views.push_back({eye.pose, eye.width, eye.height});
    plan_ = makePlan(inputs, costs);
    if (scene_.render.method != kAutoMethod && plan_.chosen.settings.method != scene_.render.method)
        throw SceneError(wanted.scene + ": refused: " + plan_.refused);
}

void Stage::submit(std::span<const EyeRequest> eyes, bool full) {
    const bool open = scene_.render.method == kAutoMethod;
    renderer_.submit(submission_, simulation_, eyes, open ? &plan_.chosen.settings : nullptr, full);
    while (!submission_.commands.wait(1'000'000'000)) {
    }
    if (device_bytes_ == 0) device_bytes_ = device_.memoryInUse() - bytes_before_; // before other stages take theirs
}

FrameCost Stage::frame() {
    renderer_.forget(); // a frame costs what one of a medium that moves does
    return costOf(eyes_);
}

FrameCost Stage::nextFrame() {
    simulation_.step({});
    return costOf(eyes_);
}

uint64_t Stage::voxelRaysAlone() {
    uint64_t rays = 0;
    for (const EyeRequest& eye : eyes_)
        for (const bool counts : {false, true}) { // the first frame makes all that the last viewer did not see
            renderer_.forget();
            const uint64_t own = costOf({&eye, 1}).light.voxel_rays;
            rays += counts ? own : 0;
        }
    return rays;
}

FrameCost Stage::costOf(std::span<const EyeRequest> eyes) {
    const LightWork before = renderer_.countLightWork();
    const auto begin = std::chrono::steady_clock::now();
    submit(eyes);
    FrameCost cost;
    cost.wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    for (const gpu::PassSample& sample : submission_.commands.readTimes()) {
        cost.fragments += sample.fragments;
        const auto same = [&](const FrameCost::Pass& p) { return p.name == sample.name; };
        const auto known = std::find_if(cost.passes.begin(), cost.passes.end(), same);
        if (known != cost.passes.end())
            known->ms += double(sample.ms);
        else
            cost.passes.push_back({sample.name, sample.view == gpu::kShared, double(sample.ms)});
    }
    cost.light = renderer_.countLightWork() - before;
    return cost;
}

double Stage::deviceMs() {
    double ms = 0;
    for (const gpu::PassSample& sample : submission_.commands.readTimes()) ms += double(sample.ms);
    return ms;
}

double Stage::timed(const Pose& pose, glm::uvec2 size, uint64_t history) {
    const EyeRequest eye{.pose = pose, .width = size.x, .height = size.y, .history = history};
    submit({&eye, 1});
    return deviceMs();
}

RadianceImage Stage::picture(const Pose& pose, glm::uvec2 size, uint64_t history) {
    const EyeRequest eye{.pose = pose, .width = size.x, .height = size.y, .history = history};
    renderer_.keepRadiance(true);
    submit({&eye, 1});
    renderer_.keepRadiance(false);
    RadianceImage image{int(size.x), int(size.y), {}, {}};
    for (const glm::vec4& pixel : renderer_.readRadiance()) {
        image.radiance.emplace_back(pixel);
        image.transmittance.push_back(pixel.a);
    }
    image.medium_alone = isMediumAlone(scene_);
    return image;
}

std::vector<glm::u8vec3> Stage::shown(const Pose& pose, glm::uvec2 size, uint32_t show) {
    EyeRequest eye{pose, size.x, size.y};
    eye.show = show;
    submit({&eye, 1}, true);
    const PictureView picture = submission_.pictures().front();
    std::vector<glm::u8vec3> pixels;
    for (uint32_t y = 0; y < size.y; ++y)
        for (uint32_t x = 0; x < size.x; ++x) {
            const uint8_t* red = picture.bytes + size_t(y) * picture.layout.lumaStride() + x;
            const size_t plane = picture.layout.lumaBytes();
            pixels.emplace_back(red[0], red[plane], red[2 * plane]);
        }
    return pixels;
}

Stage::Layered Stage::layered(const Pose& pose, glm::uvec2 size, uint32_t count) {
    const EyeRequest eye{.pose = pose, .width = size.x, .height = size.y, .depth_layers = count};
    submit({&eye, 1});
    Layered out;
    out.ms = deviceMs();
    out.picture = submission_.pictures().front(), out.layers = submission_.layers().front();
    return out;
}

const Submission::Fits& Stage::fits() {
    const bool open = scene_.render.method == kAutoMethod;
    renderer_.submitLight(submission_, simulation_, open ? plan_.chosen.settings : simulation_.now().render);
    while (!submission_.commands.wait(1'000'000'000)) {
    }
    return submission_.fits();
}

std::span<const PictureView> Stage::planes() { return submission_.pictures(); }

std::vector<gpu::Particle> Stage::particles() const {
    std::vector<gpu::Particle> all(simulation_.liveCount());
    simulation_.write(all);
    return all;
}

double percentile(std::vector<double> values, double part) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const auto rank = size_t(std::ceil(part * double(values.size())));
    return values[std::clamp<size_t>(rank, 1, values.size()) - 1];
}

std::pair<size_t, size_t> intervalOfMedian(size_t count) {
    size_t low = 0;
    // Probability that no more than `low` values lie below the median, on either side.
    double one = std::pow(0.5, double(count)), outside = one;
    while (low + 1 < count / 2) {
        one *= double(count - low) / double(low + 1);
        if (2 * (outside + one) > 0.1) break;
        outside += one, ++low;
    }
    return {low, count - 1 - low};
}

} // namespace brume::bench
