#include "server/sim/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/scene_limits.h"
#include "common/tetrahedra.h"
#include "server/sim/homes.h"
#include "server/sim/kernels.h"
#include "server/sim/layout.h"
#include "server/sim/live.h"
#include "server/sim/plume.h"
#include "server/sim/sequence.h"
#include "server/sim/sine.h"
#include "server/sim/state.h"
#include "server/sim/state_hash.h"

namespace brume {

namespace {

constexpr float kDt = static_cast<float>(kTickSeconds);

bool finite(glm::vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

glm::vec3 clamped(glm::vec3 v, Limits to) { return {to.clamp(v.x), to.clamp(v.y), to.clamp(v.z)}; }

void copy(const SceneSetting& setting, const SceneParts& from, const SceneParts& to) {
    std::visit(
        [&]<class M>(M member) {
            if constexpr (std::is_pointer_v<M>) *std::get<M>(setting.member(to)) = *member;
        },
        setting.member(from));
}

// a / b, component by component; 1 where b is 0.
glm::vec3 quotient(glm::vec3 a, glm::vec3 b) {
    return {b.x > 0 ? a.x / b.x : 1, b.y > 0 ? a.y / b.y : 1, b.z > 0 ? a.z / b.z : 1};
}

// Of a small angle; the series are exact in float32 for the at most 10/60 rad of a step.
struct Turn {
    explicit Turn(float angle) {
        const float a2 = angle * angle;
        sine = angle * (1 - a2 / 6 * (1 - a2 / 20)), cosine = 1 - a2 / 2 * (1 - a2 / 12 * (1 - a2 / 30));
    }
    float sine, cosine;
};

// About +Y.
glm::vec3 turned(glm::vec3 v, float angle) {
    const Turn turn(angle);
    return {v.x * turn.cosine + v.z * turn.sine, v.y, v.z * turn.cosine - v.x * turn.sine};
}

// About the unit `axis`: what lies along it stays.
glm::vec3 turned(glm::vec3 v, float angle, glm::vec3 axis) {
    if (axis == glm::vec3(0, 1, 0)) return turned(v, angle);
    const Turn turn(angle);
    const glm::vec3 along = glm::dot(v, axis) * axis;
    return along + (v - along) * turn.cosine + glm::cross(axis, v) * turn.sine;
}

} // namespace

Simulation::State::State(const Scene& scene, uint64_t most_bytes)
    : sky_lights(scene.sky.lights), now{scene.medium, sunOf(scene), listsOf(scene), scene.render, scene.simulation} {
    if (scene.medium.layout == Layout::emitter) {
        rows = scene.medium.count;
        columns.emplace(rows);
        motion = std::make_unique<Plume>(scene.medium);
    } else if (scene.medium.layout == Layout::live || scene.medium.layout == Layout::none) {
        rows = scene.medium.layout == Layout::live ? scene.medium.count : 1; // nobody sets the one
        columns.emplace(rows);
        motion = std::make_unique<Live>(scene.medium, *columns);
    } else if (scene.medium.layout == Layout::sequence) {
        SequenceFiles files = loadSequence(scene.medium, scene.origin, most_bytes);
        cloud = files.facts;
        rows = now.medium.count = files.most;
        columns.emplace(rows);
        motion = std::make_unique<Sequence>(scene.medium, std::move(files), *columns);
    } else {
        Placement placed = place(scene.medium, scene.origin, scene.volume.get());
        rows = now.medium.count = static_cast<uint32_t>(placed.position.size());
        columns.emplace(rows);
        Columns& c = *columns;
        for (uint32_t i = 0; i < rows; ++i) {
            c[Column::home_x][i] = c[Column::x][i] = placed.position[i].x;
            c[Column::home_y][i] = c[Column::y][i] = placed.position[i].y;
            c[Column::home_z][i] = c[Column::z][i] = placed.position[i].z;
        }
        std::copy(placed.scale.begin(), placed.scale.end(), c[Column::scale]);
        if (placed.sigma_t.empty()) {
            std::transform(placed.multiplier.begin(), placed.multiplier.end(), c[Column::weight],
                           [](float m) { return m * 1e-4f; });
            motion = std::make_unique<Homes>(rows, std::move(placed.albedo));
        } else {
            std::copy(placed.sigma_t.begin(), placed.sigma_t.end(), c[Column::weight]);
            const float most = *std::max_element(placed.sigma_t.begin(), placed.sigma_t.end());
            const float times = static_cast<float>(limits::kSigmaT.hi) / most;
            if (placed.still)
                motion = std::make_unique<Still>(rows, std::move(placed.albedo), scene.medium.extinction, times);
            else
                motion = std::make_unique<Homes>(rows, std::move(placed.albedo), scene.medium.extinction, times);
        }
        axes = std::move(placed.axes);
        cloud = std::move(placed.cloud);
    }
    if (scene.medium.model == kUnionMedium && double(rows) > limits::kUnionCount.hi)
        throw SceneError("medium.model: \"union\" of " + std::to_string(rows) + " particles; allowed: up to " +
                         std::to_string(int(limits::kUnionCount.hi)));
    if (scene.tetrahedra && scene.tetrahedra->points != rows)
        throw SceneError(scene.medium.file.string() + ": it changed while it was read; open the scene again");
    if (scene.simulation.collide && motion->yields()) obstacles.emplace(scene);
    first_step = motion->runUp();
    while (steps < first_step) advance();
    now.light = sunOf(scene); // which the run-up has turned,
    now.lists.lights = localLightsOf(scene);
    lists_hash = hashOf(now.lists);
    StateHash all;
    all.add(scene.medium.seed);
    for (uint32_t c = 0; c < static_cast<uint32_t>(Column::count); ++c)
        for (const Rows run : motion->living())
            all.add(std::span((*columns)[static_cast<Column>(c)] + run.begin, run.end - run.begin));
    for (const glm::vec3& albedo : motion->albedos()) all.add(std::span(&albedo.x, 3));
    for (const gpu::EllipsoidAxes& one : axes) all.add(std::span(&one.a.x, 9));
    origin = all.value();
    eachLive<std::string>(partsOf(now), [](std::string& text) { text.reserve(kLongestName); });
    settle();
    first_columns = columns;
    motion->keepStart();
    first_now = now;
    if (scene.medium.model == kUnionMedium && motion->keepsPlaces()) past.emplace(rows);
}

std::string Simulation::State::apply(const Impulse& c) {
    const float length = glm::length(c.direction);
    if (!finite(c.origin) || !finite(c.push) || !std::isfinite(c.strength) || !(length > 1e-6f && length < 1e5f))
        return {};
    if (impulses++ >= kMostImpulses) return "too many pushes in one tick"; // CommandQueue refuses them before
    const float strength = limits::kStrength.clamp(c.strength);
    Push p{.origin = clamped(c.origin, limits::kPlace),
           .direction = c.direction / length,
           .radius = now.simulation.impulse_radius};
    if (c.push == glm::vec3(0)) {
        p.away = strength * now.simulation.impulse_strength;
        p.along = p.direction * (0.5f * p.away); // mostly outward, and away from who pushes
    } else {
        p.along = clamped(c.push, limits::kSpeed) * strength;
    }
    if (motion->yields())
        for (const Rows run : motion->living()) push(*columns, run, p);
    return {};
}

std::string Simulation::State::apply(const MoveVolume& c) {
    if (finite(c.offset)) keep({tick, false, MoveBack{moved}});
    if (finite(c.offset)) moved = clamped(moved + clamped(c.offset, limits::kPlace), limits::kPlace);
    return {};
}

std::string Simulation::State::apply(const Add& c) {
    std::string problem = change([&](SceneLists& lists) { return add(lists, c.list, c.changes); });
    if (problem.empty()) keep({tick, false, Remove{c.list, uint32_t(now.lists.size(c.list) - 1)}});
    return problem;
}

std::string Simulation::State::apply(const Remove& c) {
    SceneLists removed;
    std::string problem = change([&](SceneLists& lists) {
        if (c.element < lists.size(c.list)) insert(removed, c.list, 0, lists, c.element);
        return remove(lists, c.list, c.element);
    });
    if (problem.empty()) keep({tick, false, PutBack{c.list, c.element, std::move(removed)}});
    return problem;
}

std::string Simulation::State::apply(const Set& c) {
    Before was = before(c);
    std::string problem = give(c);
    if (problem.empty()) keep(std::move(was));
    return problem;
}

// All changes, or none.
std::string Simulation::State::give(const Set& c) {
    const auto darkens = [](const Change& one) {
        return one.setting->path == "render.scattering" && one.value != SettingValue(std::string("propagation"));
    };
    if (sky_lights && std::ranges::any_of(c.changes, darkens))
        return "the sky lights this scene's medium, for which render.scattering stays \"propagation\"";
    const bool lists = std::ranges::any_of(c.changes, [](const Change& one) { return one.setting->in_list; });
    std::string problem = lists ? change([&](SceneLists& to) { return set(to, c.changes); }) : "";
    if (!problem.empty()) return problem;
    for (const Change& one : c.changes)
        if (!one.setting->in_list) brume::apply(one, partsOf(now));
    ++settings_version;
    return problem;
}

// Everything as after loading, only the tick goes on.
std::string Simulation::State::apply(const Restart&) {
    columns->copyFrom(*first_columns);
    motion->restart();
    steps = first_step;
    changes.clear();
    moved = glm::vec3(0);
    now.lists = first_now.lists;
    lists_changed = true;
    for (const SceneSetting* setting : liveSettings()) copy(*setting, partsOf(first_now), partsOf(now));
    ++settings_version;
    return {};
}

// Of a recording they are not checked yet.
std::string Simulation::State::apply(const SetParticles& c) {
    if (problemOf(c, rows).empty())
        motion->set(*columns, c, {.number = steps, .volume = volume(), .settings = now.simulation});
    return {};
}

// Moved by commands, adrift and asway; a closed form of the number of steps, so that no rounding piles up.
glm::vec3 Simulation::State::volume() const {
    const double seconds = (static_cast<double>(steps) - static_cast<double>(first_step)) * kTickSeconds;
    const double turns = seconds / static_cast<double>(now.simulation.volume_period);
    const float sway = now.simulation.volume_swing * sineOfTurns(static_cast<float>(turns - std::floor(turns)));
    return clamped(moved + now.simulation.volume_velocity * static_cast<float>(seconds) + glm::vec3(sway, 0, 0),
                   limits::kPlace);
}

void Simulation::State::advance() {
    ++steps;
    motion->step(*columns, {.number = steps, .volume = volume(), .settings = now.simulation});
    if (obstacles) {
        obstacles->follow(now.lists, lists_hash);
        motion->settle(*columns, now.medium.extinction); // the scales are those of now
        const Obstacles::Widths widths{.clearance = Obstacles::clearanceOf(now.medium), .axes = axes};
        for (const Rows run : motion->living()) obstacles->stop(*columns, run, kDt, widths);
    }
    Light& sun = now.light;
    if (sun.rotate != 0) sun.to_light = glm::normalize(turned(sun.to_light, sun.rotate * kDt, sun.rotate_axis));
    for (Light& light : now.lists.lights)
        if (light.orbit != 0) light.position = light.pivot + turned(light.position - light.pivot, light.orbit * kDt);
}

void Simulation::State::settle() {
    motion->settle(*columns, now.medium.extinction);

    constexpr float kFar = std::numeric_limits<float>::max();
    bounds = {glm::vec3(kFar), glm::vec3(-kFar), 0, 0};
    for (const Rows run : motion->living()) widen(bounds, *columns, run);
    if (const auto source = motion->source(); source && motion->liveCount() == 0)
        bounds = {*source + volume(), *source + volume(), 0, 0};
    hash = hashed();
}

Simulation::Simulation(const Scene& scene, uint64_t most_bytes) : state_(std::make_unique<State>(scene, most_bytes)) {
    keepPast();
}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

void Simulation::countFrom(uint64_t tick) {
    state_->tick = tick;
    if (state_->past) state_->past.emplace(state_->rows);
    keepPast();
}

void Simulation::keepPast() {
    if (!state_->past) return;
    PastTick& one = state_->past->next(state_->tick);
    one.to_light = state_->now.light.to_light;
    write(one.particles);
}

void Simulation::step(std::span<const Command> commands) {
    State& s = *state_;
    ++s.tick;
    s.impulses = 0;
    s.refused.clear();
    for (const Command& command : commands)
        if (std::string why = std::visit([&](const auto& body) { return s.apply(body); }, command.body); !why.empty())
            s.refused.push_back({command.viewer, command.seq, std::move(why)});
    if (std::exchange(s.lists_changed, false)) s.lists_hash = hashOf(s.now.lists);
    if (!s.now.simulation.paused) s.advance();
    s.settle();
    keepPast();
}

uint64_t Simulation::tick() const { return state_->tick; }
uint64_t Simulation::stateHash() const { return state_->hash; }
uint64_t Simulation::origin() const { return state_->origin; }
std::span<const RefusedCommand> Simulation::refused() const { return state_->refused; }
uint64_t Simulation::listsHash() const { return state_->lists_hash; }
uint64_t Simulation::settingsVersion() const { return state_->settings_version; }
std::string Simulation::undoText() const { return state_->changes.text(); }
uint32_t Simulation::liveCount() const { return state_->motion->liveCount(); }
uint32_t Simulation::capacity() const { return state_->rows; }
uint64_t Simulation::bytes() const { return state_->columns->bytes() + state_->first_columns->bytes() + besides(); }
uint64_t Simulation::besides() const {
    return state_->motion->bytes() + (state_->past ? state_->past->bytes() : 0) +
           state_->axes.size() * sizeof(gpu::EllipsoidAxes);
}
const Bounds& Simulation::bounds() const { return state_->bounds; }
const SceneNow& Simulation::now() const { return state_->now; }
uint64_t Simulation::firstId() const { return state_->motion->firstId(); }
const Past* Simulation::past() const { return state_->past ? &*state_->past : nullptr; }
std::span<const gpu::EllipsoidAxes> Simulation::axes() const { return state_->axes; }
const PointCloudFacts* Simulation::pointCloud() const { return state_->cloud ? &*state_->cloud : nullptr; }

void Simulation::write(std::span<gpu::Particle> out, uint32_t every) const {
    const State& s = *state_;
    const Columns& c = *s.columns;
    // The medium's albedo acts on those that came with the points as a factor; nothing is relative to a start of 0.
    const std::span<const glm::vec3> albedos = s.motion->albedos();
    const glm::vec3 factor = quotient(s.now.medium.albedo, s.first_now.medium.albedo);
    size_t to = 0;
    uint32_t skip = 0; // rows of the next run
    for (const Rows run : s.motion->living()) {
        uint32_t i = run.begin + skip;
        for (; i < run.end; i += every)
            out[to++] = {{c[Column::x][i], c[Column::y][i], c[Column::z][i]},
                         c[Column::scale][i],
                         albedos.empty() ? s.now.medium.albedo : glm::min(albedos[i] * factor, 1.0f),
                         c[Column::sigma][i]};
        skip = i - run.end;
    }
}

} // namespace brume
