#include "server/net/outgoing.h"

#include <algorithm>

#include "server/net/convert.h"
#include "server/sim/simulation.h"
#include "shaders/shared/depth_layers.h"

namespace brume::net {
namespace {

using Builder = flatbuffers::FlatBufferBuilder;

auto packStrings(Builder& b, const std::vector<std::string>& strings) { return b.CreateVectorOfStrings(strings); }
auto packText(Builder& b, std::string_view text) { return b.CreateString(text.data(), text.size()); }

// Of all methods, for viewers older than Welcome.settings.
std::vector<std::string> quadratureNames() {
    std::vector<std::string> names;
    for (const SceneSetting* setting : liveSettings())
        if (setting->key() == "quadrature") names.insert(names.end(), setting->choices.begin(), setting->choices.end());
    return names;
}

auto packPlan(Builder& b, const SceneReport& report) {
    const auto& plan = report.plan;
    const auto method = packText(b, plan.method), quadrature = packText(b, plan.quadrature),
               text = packText(b, plan.text);
    return wire::CreatePlan(b, method, quadrature, plan.rate, plan.slabs, float(plan.error), float(plan.ms),
                            plan.relaxed, text, float(plan.promised));
}

wire::SettingKind kindOf(const SceneSetting& setting) {
    const SettingValue value = defaultOf(setting);
    if (std::holds_alternative<bool>(value)) return wire::SettingKind::boolean;
    if (std::holds_alternative<uint32_t>(value)) return wire::SettingKind::whole;
    if (std::holds_alternative<float>(value)) return wire::SettingKind::number;
    if (std::holds_alternative<std::string>(value)) return wire::SettingKind::text;
    return setting.form == Form::direction ? wire::SettingKind::direction
           : setting.form == Form::colour  ? wire::SettingKind::colour
                                           : wire::SettingKind::vector;
}

auto packSetting(Builder& b, const SceneSetting& setting, const ServerFacts& facts) {
    const auto path = packText(b, setting.path), help = packText(b, setting.help);
    const auto unit = setting.unit.empty() ? 0 : packText(b, setting.unit);
    const std::vector<std::string> choices = facts.choicesOf(setting);
    const bool only_spots = setting.in_list && setting.table() == "light" && !has({.type = kPoint}, setting.key());
    const auto only_type = only_spots ? packText(b, kSpot) : 0;
    const wire::Role role =
        setting.changed_by == ChangedBy::controllers ? wire::Role::controller : wire::Role::operator_;
    return wire::CreateSetting(b, path, kindOf(setting), unit, help, role, float(setting.allowed.lo),
                               float(setting.allowed.hi), float(setting.slider().lo), float(setting.slider().hi),
                               choices.empty() ? 0 : packStrings(b, choices), only_type);
}

auto packSettings(Builder& b, std::span<const SceneSetting* const> all, const ServerFacts& facts) {
    std::vector<flatbuffers::Offset<wire::Setting>> settings;
    for (const SceneSetting* setting : all) settings.push_back(packSetting(b, *setting, facts));
    return b.CreateVector(settings);
}

auto packLists(Builder& b, const ServerFacts& facts) {
    std::vector<flatbuffers::Offset<wire::List>> lists;
    for (const SceneList list : kSceneLists) {
        const auto name = packText(b, nameOf(list));
        const auto settings = packSettings(b, liveSettings(list), facts);
        lists.push_back(wire::CreateList(b, name, uint32_t(mostOf(list)), settings));
    }
    return b.CreateVector(lists);
}

// Appends a value as Elements.values has it.
struct AppendTo {
    std::vector<float>& values;
    const std::vector<std::string>& choices;

    void operator()(const glm::vec3& vector) const { values.insert(values.end(), {vector.x, vector.y, vector.z}); }
    void operator()(const std::string& text) const {
        values.push_back(float(std::ranges::find(choices, text) - choices.begin()));
    }
    template <class Number>
    void operator()(Number number) const {
        values.push_back(float(number));
    }
};

auto packElements(Builder& b, SceneLists lists, const ServerFacts& facts) {
    std::vector<flatbuffers::Offset<wire::Elements>> all;
    std::vector<float> values;
    for (const SceneList list : kSceneLists) {
        std::vector<std::vector<std::string>> choices;
        for (const SceneSetting* setting : liveSettings(list)) choices.push_back(facts.choicesOf(*setting));
        values.clear();
        for (uint32_t element = 0; element < lists.size(list); ++element)
            for (size_t i = 0; i < choices.size(); ++i)
                std::visit(AppendTo{values, choices[i]},
                           valueOf(*liveSettings(list)[i], partsOf(lists, list, element)));
        all.push_back(wire::CreateElements(b, b.CreateVector(values)));
    }
    return b.CreateVector(all);
}

struct PackValue {
    Builder& b;

    auto operator()(const glm::vec3& vector) const {
        const wire::Vec3 packed = toWire(vector);
        return wire::CreateValue(b, {}, &packed);
    }
    auto operator()(const std::string& text) const { return wire::CreateValue(b, {}, nullptr, packText(b, text)); }
    template <class Number>
    auto operator()(Number number) const {
        return wire::CreateValue(b, double(number));
    }
};

auto packValues(Builder& b, const std::vector<SettingValue>& settings) {
    std::vector<flatbuffers::Offset<wire::Value>> values;
    values.reserve(settings.size());
    for (const SettingValue& value : settings) values.push_back(std::visit(PackValue{b}, value));
    return b.CreateVector(values);
}

// The value of a live setting in a report that has those of all.
template <class T>
const T& valueIn(const SceneReport& report, std::string_view path) {
    const auto live = liveSettings();
    const auto found =
        std::find_if(live.begin(), live.end(), [&](const auto* setting) { return setting->path == path; });
    return std::get<T>(report.settings.at(size_t(found - live.begin())));
}

flatbuffers::Offset<flatbuffers::Vector<const wire::CameraKey*>> packKeys(Builder& b,
                                                                          const std::vector<CameraKey>& keys) {
    if (keys.empty()) return 0;
    std::vector<wire::CameraKey> all;
    for (const CameraKey& key : keys)
        all.emplace_back(toWire(key.position), toWire(key.target), key.fov_y, all.empty() ? 0 : key.seconds);
    return b.CreateVectorOfStructs(all);
}

auto packLayers(Builder& b, const FrameLayers& layers) {
    const uint32_t lengths[wire::kLayerPictures] = {uint32_t(layers.colours.size()), uint32_t(layers.data.size()),
                                                    uint32_t(layers.surface.size())};
    return wire::CreateDepthLayers(b, layers.count, layers.columns, layers.rows, layers.block_rows, layers.spacing,
                                   layers.first, layers.near, layers.far, layers.exposure, layers.filmic,
                                   gpu::kNearSurface, gpu::kFarSurface, layers.nearest,
                                   b.CreateVector(lengths, std::size(lengths)));
}

} // namespace

wire::Packed packWelcome(const Viewer& viewer, const PoseRequest& granted, const Audience& audience,
                         const SceneFacts& shown, wire::Role role) {
    return wire::pack([&](Builder& b) {
        const ServerFacts& facts = audience.facts();
        const SceneCamera& own = shown.scene.camera;
        const wire::Vec3 position = toWire(own.position), target = toWire(own.target);
        const auto camera = wire::CreateCamera(b, &position, &target, own.fov_y);
        const auto server = b.CreateString("brume " BRUME_VERSION);
        const auto scene = packText(b, shown.scene.name), device = packText(b, facts.device);
        const auto methods = packStrings(b, facts.methods), quadratures = packStrings(b, quadratureNames());
        const auto settings = packSettings(b, liveSettings(), facts);
        const auto resume = packText(b, viewer.key());
        const auto starts = packValues(b, shown.starts);
        const auto scenes = packStrings(b, shown.others);
        const auto lists = packLists(b, facts);
        const auto medium = packText(b, shown.scene.medium.model);
        const auto path = packKeys(b, shown.scene.camera_keys);
        return wire::CreateWelcome(b, viewer.id(), server, scene, device, granted.width, granted.height, granted.views,
                                   float(1 / kTickSeconds), uint8_t(std::min(audience.maxInFlight(), 255u)), camera,
                                   methods, quadratures, resume, viewer.resumed(), role, settings, starts, scenes,
                                   lists, medium, path, true);
    });
}

wire::Packed packSceneState(const SceneReport& report, uint32_t viewers, const ServerFacts* lists_for) {
    return wire::pack([&](Builder& b) {
        std::vector<flatbuffers::Offset<wire::PassTime>> passes;
        passes.reserve(report.passes.size());
        for (const PassTime& pass : report.passes)
            passes.push_back(wire::CreatePassTime(b, packText(b, pass.name), pass.ms));
        const auto packed_passes = b.CreateVector(passes);
        const auto packed_values = packValues(b, report.settings);
        const auto plan = packPlan(b, report);
        const auto lists = lists_for ? packElements(b, report.lists, *lists_for) : 0;
        const auto standstill = report.standstill.empty() ? 0 : packText(b, report.standstill);
        const auto not_drawable = report.not_drawable.empty() ? 0 : packText(b, report.not_drawable);
        const auto preparing = report.preparing.empty() ? 0 : packText(b, report.preparing);
        const auto undo = report.undo.empty() ? 0 : packText(b, report.undo);
        // For viewers older than SceneState.settings: what there was then. New settings need nothing here.
        const auto number = [&](const char* path) { return valueIn<float>(report, path); };
        const auto vector = [&](const char* path) { return toWire(valueIn<glm::vec3>(report, path)); };
        const auto& asked = valueIn<std::string>(report, "render.method");
        const auto method = packText(b, asked);
        const auto quadrature = packText(b, valueIn<std::string>(report, "render.isv.quadrature"));
        const wire::Vec3 to_light = vector("light.to_light"), irradiance = vector("light.irradiance");
        const wire::Vec3 albedo = vector("medium.albedo"), lo = toWire(report.lo), hi = toWire(report.hi);
        return wire::CreateSceneState(
            b, report.tick, report.state_hash, viewers, report.particles, valueIn<bool>(report, "simulation.paused"),
            &to_light, &irradiance, number("light.rotate"), number("medium.extinction"), number("medium.falloff"),
            number("medium.anisotropy"), number("medium.asymmetry"), &albedo, method, quadrature,
            valueIn<uint32_t>(report, "render.isv.steps"), number("render.exposure"), packed_passes, plan,
            packed_values, &lo, &hi, lists, standstill, preparing, not_drawable, undo);
    });
}

wire::Packed packPeople(const People::Now& now, bool cameras) {
    return wire::pack([&](Builder& b) {
        std::vector<flatbuffers::Offset<wire::Person>> people;
        for (const Person& one : now.people) {
            wire::Look look;
            if (one.look) {
                const Frustum f =
                    frustumOf(eyePose(one.look->pose, 0, one.look->views), one.look->width, one.look->height);
                look = wire::Look(toWire(one.look->pose.position), toWire(one.look->pose.orientation),
                                  0.5f * (f.left + f.right), 0.5f * (f.up + f.down));
            }
            const wire::Vec3 pointer = toWire(one.pointer.value_or(glm::vec3(0)));
            people.push_back(wire::CreatePerson(
                b, one.id, packText(b, one.name), one.known, one.colour, wire::Role(one.role), one.follows,
                cameras && one.look ? &look : nullptr, one.pointer ? &pointer : nullptr));
        }
        return wire::CreatePeople(b, b.CreateVector(people), now.count, now.presenter);
    });
}

wire::Packed packFrameHeader(const EncodedFrame& frame, float queue_ms) {
    return wire::pack([&](Builder& b) {
        const PoseRequest& request = frame.request;
        const wire::Vec3 position = toWire(request.pose.position);
        const wire::Quat orientation = toWire(request.pose.orientation);
        const wire::Stages stages(frame.wait_ms, frame.render_ms, frame.encode_ms, queue_ms, frame.gpu_ms);
        uint32_t lengths[wire::kMaxViews];
        for (uint32_t view = 0; view < request.views; ++view) lengths[view] = uint32_t(frame.jpeg[view]->size());
        const auto jpeg_bytes = b.CreateVector(lengths, request.views);
        wire::Frustum drawn[wire::kMaxViews];
        const wire::Frustum* frusta[wire::kMaxViews]{};
        for (int view = 0; view < request.views; ++view) {
            const Pose eye = eyePose(request.pose, view, request.views);
            if (eye.frustum == Frustum{}) continue;
            drawn[view] = toWire(frustumOf(eye, request.width, request.height));
            frusta[view] = &drawn[view];
        }
        std::vector<flatbuffers::Offset<wire::DepthLayers>> layers;
        for (const LayersPtr& one : frame.layers)
            if (one) layers.push_back(packLayers(b, *one));
        const auto packed_layers = layers.empty() ? 0 : b.CreateVector(layers);
        return wire::CreateFrame(
            b, frame.id, frame.tick, frame.state_hash, request.seq, request.client_time_us, &position, &orientation,
            request.pose.fov_y, request.width, request.height, request.quality, &stages, jpeg_bytes, frusta[0],
            frusta[1], frame.png ? wire::Encoding::png : wire::Encoding::jpeg, frame.measured.rmse, frame.measured.low,
            frame.measured.high, wire::Reduced(request.reduced), packed_layers, request.follows);
    });
}

wire::Packed packLitHeader(const EncodedFrame& frame, float queue_ms) {
    return wire::pack([&](Builder& b) {
        const LitTick& lit = *frame.lit;
        const lit::PackedRows& rows = frame.rows();
        const gpu::Tick& scene = lit.scene;
        std::vector<wire::Hue> hues;
        for (const LitTick::Hue& hue : lit.hues) hues.emplace_back(hue.channels, hue.extinction);
        const auto packed_hues = b.CreateVectorOfStructs(hues);
        const float phase[] = {scene.phase.part, scene.phase.asymmetry, scene.phase.draine, scene.phase.second};
        const auto packed_phase = b.CreateVector(phase, std::size(phase));
        std::vector<wire::Object> objects;
        for (const gpu::Opaque& o : lit.objects) {
            objects.emplace_back(wire::ObjectKind(o.kind), toWire(o.centre), toWire(o.half_size),
                                 std::atan2(o.yaw_sin, o.yaw_cos), toWire(o.albedo));
        }
        const auto packed_objects = objects.empty() ? 0 : b.CreateVectorOfStructs(objects);
        const wire::Vec3 origin = toWire(lit.origin), to_light = toWire(scene.sun.to_light),
                         irradiance = toWire(scene.sun.irradiance), ambient = toWire(scene.ambient),
                         straight = toWire(scene.multiple.passed), zenith = toWire(scene.sky_zenith),
                         horizon = toWire(scene.sky_horizon), emission = toWire(scene.emission),
                         cold_albedo = toWire(scene.cold_albedo);
        const bool emits = scene.emission != glm::vec3(0);
        return wire::CreateLitParticles(
            b, frame.id, lit.tick, lit.state_hash, lit.number, frame.lit_whole ? 0 : lit.reference, lit.first,
            lit.count, rows.present, &origin, lit.step, scene.falloff, &to_light, &irradiance, packed_phase, &ambient,
            packed_hues, &straight, scene.multiple.mean_cosine, &zenith, &horizon, scene.haze, lit.exposure, lit.filmic,
            packed_objects, lit.predicted, frame.measured.rmse, frame.measured.low, frame.measured.high,
            uint32_t(rows.bytes.size()), frame.render_ms + frame.encode_ms + queue_ms, emits ? &emission : nullptr,
            emits ? &cold_albedo : nullptr);
    });
}

wire::Packed packError(wire::ErrorCode code, std::string_view text, uint32_t input_seq) {
    return wire::pack([&](Builder& b) { return wire::CreateError(b, code, packText(b, text), input_seq); });
}

wire::Packed packGoodbye(std::string_view reason, float retry_after_s, std::string_view go_to) {
    return wire::pack([&](Builder& b) {
        const auto text = packText(b, reason);
        return wire::CreateGoodbye(b, text, retry_after_s, go_to.empty() ? 0 : packText(b, go_to));
    });
}

wire::Packed packPing(uint32_t nonce, uint64_t time_us) {
    return wire::pack([&](Builder& b) { return wire::CreatePing(b, nonce, time_us); });
}

wire::Packed packPong(uint32_t nonce, uint64_t time_us) {
    return wire::pack([&](Builder& b) { return wire::CreatePong(b, nonce, time_us); });
}

} // namespace brume::net
