#include "tests/unit/protocol_examples.h"

namespace brume::wire {
namespace {

using Builder = flatbuffers::FlatBufferBuilder;

template <class Build>
Example example(const char* name, Build&& build, std::span<const uint8_t> after = {}) {
    const Packed packed = pack(build);
    Example made{name, {packed.data(), packed.data() + packed.size()}};
    made.bytes.insert(made.bytes.end(), after.begin(), after.end());
    return made;
}

template <class Build>
Example input(const char* name, uint32_t seq, Build&& build) {
    return example(name, [&](Builder& b) {
        const auto command = build(b);
        using Table = typename std::remove_pointer_t<decltype(flatbuffers::GetTemporaryPointer(b, command))>;
        return CreateInput(b, seq, 1'234'567 + seq, CommandTraits<std::remove_const_t<Table>>::enum_value,
                           command.Union());
    });
}

const Frustum kLeft(1.25f, 0.75f, 1, 1.125f), kRight(0.75f, 1.25f, 1, 1.125f);

Example frame(const char* name, std::vector<uint32_t> lengths, std::span<const uint8_t> jpeg, bool frusta = false,
              Encoding encoding = Encoding::jpeg, float measured = 0) {
    const Vec3 position(1.5f, -2.25f, 26);
    const Quat orientation(0, 0.6f, 0, 0.8f);
    const Stages stages(3.5f, 12.25f, 0.75f, 0.125f, 9.5f);
    return example(
        name,
        [&](Builder& b) {
            return CreateFrameDirect(b, 41, 123'456'789'012, 0xfedc'ba98'7654'3210, 4'294'967'295,
                                     9'007'199'254'740'993, &position, &orientation, 0.75f, 1280, 720, 85, &stages,
                                     &lengths, frusta ? &kLeft : nullptr, frusta ? &kRight : nullptr, encoding,
                                     measured, measured * 0.75f, measured * 1.5f);
        },
        jpeg);
}

} // namespace

std::vector<Example> makeExamples() {
    // Not pictures: a viewer's codec must hand these bytes on as they are.
    const std::vector<uint8_t> jpeg{0xff, 0xd8, 0x01, 0x02, 0x03, 0xff, 0xd9, 0xff, 0xd8, 0x0a, 0x0b, 0xff, 0xd9};
    const Vec3 v(1.5f, -2.25f, 26), to_light(0.5f, 0.75f, 0.25f), irradiance(10, 9.5f, 8), albedo(0.5f, 0.75f, 1);
    const Quat turned(0, 0.6f, 0, 0.8f);

    std::vector<Example> all;
    all.push_back(example(
        "hello", [](Builder& b) { return CreateHelloDirect(b, "example 1.0 \xe2\x98\x81", 1280, 720, 2, 85); }));
    all.push_back(example("hello_defaults", [](Builder& b) { return CreateHello(b); }));
    all.push_back(example("pose", [&](Builder& b) {
        return CreatePose(b, 4'294'967'295, 9'007'199'254'740'993, &v, &turned, 0.75f, 0.0625f, 640, 360);
    }));
    all.push_back(input("input_impulse", 1, [&](Builder& b) {
        const Vec3 direction(0, 0, -1), push(0, 4, 0);
        return CreateImpulse(b, &v, &direction, &push, -2.5f);
    }));
    all.push_back(input("input_move_volume", 2, [&](Builder& b) { return CreateMoveVolume(b, &v); }));
    all.push_back(input("input_restart", 7, [](Builder& b) { return CreateRestart(b); }));
    all.push_back(input("input_set", 8, [&](Builder& b) {
        const std::vector<flatbuffers::Offset<Change>> changes{
            CreateChangeDirect(b, "medium.falloff", 1.5), CreateChangeDirect(b, "medium.albedo", {}, &albedo),
            CreateChangeDirect(b, "render.method", {}, nullptr, "isv")};
        return CreateSetDirect(b, &changes);
    }));
    all.push_back(input("input_set_particles", 9, [](Builder& b) {
        const std::vector<float> positions{1.5f, -2.25f, 26, 0, 0.5f, -1}, scales{0.5f, 2}, extinctions{0.125f, 8},
            albedos{0.5f, 0.75f, 1, 0, 0.25f, 1};
        return CreateSetParticlesDirect(b, 4000, &positions, &scales, &extinctions, &albedos, 4002, 0.125f);
    }));
    all.push_back(input("input_add", 10, [&](Builder& b) {
        const std::vector<flatbuffers::Offset<Change>> changes{CreateChangeDirect(b, "light.type", {}, nullptr, "spot"),
                                                               CreateChangeDirect(b, "light.position", {}, &v)};
        return CreateAddDirect(b, "light", &changes);
    }));
    all.push_back(input("input_remove", 11, [](Builder& b) { return CreateRemoveDirect(b, "fog[1]"); }));
    all.push_back(input("input_undo", 12, [](Builder& b) { return CreateUndo(b); }));
    all.push_back(example("ack", [](Builder& b) { return CreateAck(b, 41); }));
    all.push_back(example("ping", [](Builder& b) { return CreatePing(b, 7, 9'007'199'254'740'993); }));
    all.push_back(example("pong", [](Builder& b) { return CreatePong(b, 7, 9'007'199'254'740'993); }));
    all.push_back(example("goodbye", [](Builder& b) { return CreateGoodbyeDirect(b, "the server stops", 2.5f); }));
    all.push_back(example("goodbye_go_to", [](Builder& b) {
        return CreateGoodbyeDirect(b, "the server stops", 2, "wss://next.example/ws");
    }));
    all.push_back(example("welcome", [&](Builder& b) {
        const std::vector<flatbuffers::Offset<flatbuffers::String>> methods{b.CreateString("sphere"),
                                                                            b.CreateString("isv")};
        const std::vector<flatbuffers::Offset<flatbuffers::String>> quadratures{b.CreateString("simpson")};
        const Vec3 position(0, 2, 26), target(0, 0.5f, 0);
        const auto camera = CreateCamera(b, &position, &target, 0.75f);
        return CreateWelcomeDirect(b, 3, "brume 0.1.0", "plume", "llvmpipe", 1280, 720, 2, 60, 2, camera, &methods,
                                   &quadratures);
    }));
    all.push_back(example("scene_state", [&](Builder& b) {
        const std::vector<flatbuffers::Offset<PassTime>> passes{CreatePassTimeDirect(b, "sort", 0.5f),
                                                                CreatePassTimeDirect(b, "medium", 7.25f)};
        return CreateSceneStateDirect(b, 123'456'789'012, 0xfedc'ba98'7654'3210, 3, 65'535, true, &to_light,
                                      &irradiance, 0.25f, 15, 1.5f, 0.5f, -0.25f, &albedo, "sphere", "simpson", 2,
                                      1.25f, &passes);
    }));
    all.push_back(example("scene_state_plan", [&](Builder& b) {
        const auto plan = CreatePlanDirect(b, "slabs", "", 8, 32, 0.00390625f, 7.5f, 2);
        return CreateSceneStateDirect(b, 7, 8, 1, 500, false, &to_light, &irradiance, 0, 15, 1.5f, 0, 0, &albedo,
                                      "auto", "simpson", 2, 1, nullptr, plan);
    }));
    all.push_back(example("scene_state_promised", [&](Builder& b) {
        const auto plan = CreatePlanDirect(b, "slabs", "", 8, 32, 0.00390625f, 7.5f, 0, "slabs, 32 slabs", 0.0078125f);
        return CreateSceneStateDirect(b, 7, 8, 1, 500, false, &to_light, &irradiance, 0, 15, 1.5f, 0, 0, &albedo,
                                      "auto", "simpson", 2, 1, nullptr, plan);
    }));
    all.push_back(example("welcome_settings", [&](Builder& b) {
        const std::vector choices{b.CreateString("auto"), b.CreateString("isv")};
        const std::vector settings{CreateSettingDirect(b, "medium.albedo", SettingKind::colour, nullptr,
                                                       "Single-scattering albedo", Role::controller, 0, 1, 0, 1),
                                   CreateSettingDirect(b, "light.rotate", SettingKind::number, "rad/s",
                                                       "Turning of the light", Role::controller, -10, 10, -2, 2),
                                   CreateSettingDirect(b, "render.method", SettingKind::text, nullptr,
                                                       "How the medium is rendered", Role::operator_, 0, 0, 0, 0,
                                                       &choices)};
        const Vec3 position(0, 2, 26), target(0, 0.5f, 0);
        const auto camera = CreateCamera(b, &position, &target, 0.75f);
        return CreateWelcomeDirect(b, 3, "brume 0.1.0", "plume", "llvmpipe", 1280, 720, 1, 60, 2, camera, &choices,
                                   nullptr, nullptr, false, Role::controller, &settings);
    }));
    all.push_back(example("scene_state_settings", [&](Builder& b) {
        const auto plan = CreatePlanDirect(b, "isv", "simpson", 0, 0, 0.125f, 7.5f, 0, "isv, simpson 2");
        const std::vector values{CreateValue(b, {}, &albedo), CreateValue(b, 0.25),
                                 CreateValueDirect(b, {}, nullptr, "isv")};
        return CreateSceneStateDirect(b, 7, 8, 1, 500, false, &to_light, &irradiance, 0.25f, 15, 1.5f, 0, 0, &albedo,
                                      "isv", "simpson", 2, 1, nullptr, plan, &values);
    }));
    all.push_back(example("welcome_scenes", [&](Builder& b) {
        const std::vector settings{CreateSettingDirect(b, "light.rotate", SettingKind::number, "rad/s",
                                                       "Turning of the light", Role::controller, -10, 10, -2, 2)};
        const std::vector starts{CreateValue(b, 0.5)};
        const std::vector scenes{b.CreateString("cloud"), b.CreateString("plume")};
        const Vec3 position(0, 2, 26), target(0, 0.5f, 0);
        const auto camera = CreateCamera(b, &position, &target, 0.75f);
        return CreateWelcomeDirect(b, 3, "brume 0.1.0", "cloud", "llvmpipe", 1280, 720, 1, 60, 2, camera, nullptr,
                                   nullptr, nullptr, false, Role::operator_, &settings, &starts, &scenes);
    }));
    all.push_back(example("scene_state_box", [&](Builder& b) {
        const Vec3 lo(-5, -1, -4.5f), hi(5, 9, 4.25f);
        const std::vector values{CreateValue(b, 0.25)};
        return CreateSceneStateDirect(b, 7, 8, 1, 500, false, &to_light, &irradiance, 0.25f, 15, 1.5f, 0, 0, &albedo,
                                      "isv", "simpson", 2, 1, nullptr, 0, &values, &lo, &hi);
    }));
    all.push_back(example("welcome_lists", [&](Builder& b) {
        const std::vector choices{b.CreateString("point"), b.CreateString("spot")};
        const std::vector settings{CreateSettingDirect(b, "light.type", SettingKind::text, nullptr, "Kind of light",
                                                       Role::controller, 0, 0, 0, 0, &choices),
                                   CreateSettingDirect(b, "light.position", SettingKind::vector, "m", "Where it is",
                                                       Role::controller, -50000, 50000, -32, 32),
                                   CreateSettingDirect(b, "light.outer", SettingKind::number, "rad", "Its cone",
                                                       Role::controller, 0.125f, 1.5f, 0.125f, 1.5f, nullptr, "spot")};
        const std::vector lists{CreateListDirect(b, "light", 1024, &settings)};
        const Vec3 position(0, 2, 26), target(0, 0.5f, 0);
        const auto camera = CreateCamera(b, &position, &target, 0.75f);
        return CreateWelcomeDirect(b, 3, "brume 0.1.0", "cloud", "llvmpipe", 1280, 720, 1, 60, 2, camera, nullptr,
                                   nullptr, nullptr, false, Role::controller, nullptr, nullptr, nullptr, &lists);
    }));
    all.push_back(example("welcome_medium", [&](Builder& b) {
        const Vec3 position(0, 2, 26), target(0, 0.5f, 0);
        const auto camera = CreateCamera(b, &position, &target, 0.75f);
        return CreateWelcomeDirect(b, 3, "brume 0.1.0", "cloud", "llvmpipe", 1280, 720, 1, 60, 2, camera, nullptr,
                                   nullptr, nullptr, false, Role::controller, nullptr, nullptr, nullptr, nullptr,
                                   "union");
    }));
    all.push_back(example("welcome_path", [&](Builder& b) {
        const Vec3 position(0, 2, 26), target(0, 0.5f, 0);
        const auto camera = CreateCamera(b, &position, &target, 0.75f);
        const std::vector<CameraKey> path{{position, target, 0.75f, 0}, {v, target, 0.5f, 2.5f}};
        return CreateWelcomeDirect(b, 3, "brume 0.1.0", "cloud", "llvmpipe", 1280, 720, 1, 60, 2, camera, nullptr,
                                   nullptr, nullptr, false, Role::controller, nullptr, nullptr, nullptr, nullptr,
                                   nullptr, &path);
    }));
    all.push_back(example("scene_state_lists", [&](Builder& b) {
        // A spot and a point, each with its type, place and cone.
        const std::vector<float> lights{1, 1.5f, -2.25f, 26, 0.5f, 0, 0.5f, 0, -1, 0.25f};
        const std::vector lists{CreateElementsDirect(b, &lights)};
        return CreateSceneStateDirect(b, 7, 8, 1, 500, false, &to_light, &irradiance, 0.25f, 15, 1.5f, 0, 0, &albedo,
                                      "isv", "simpson", 2, 1, nullptr, 0, nullptr, nullptr, nullptr, &lists);
    }));
    all.push_back(example("scene_state_standstill", [&](Builder& b) {
        return CreateSceneStateDirect(b, 7, 8, 1, 500, false, &to_light, &irradiance, 0.25f, 15, 1.5f, 0, 0, &albedo,
                                      "isv", "simpson", 2, 1, nullptr, 0, nullptr, nullptr, nullptr, nullptr,
                                      "the log is away");
    }));
    all.push_back(example("scene_state_undo", [&](Builder& b) {
        return CreateSceneStateDirect(b, 7, 8, 1, 500, false, &to_light, &irradiance, 0.25f, 15, 1.5f, 0, 0, &albedo,
                                      "isv", "simpson", 2, 1, nullptr, 0, nullptr, nullptr, nullptr, nullptr, nullptr,
                                      nullptr, nullptr, "medium.extinction back to 1.2");
    }));
    all.push_back(frame("frame", {13}, jpeg));
    all.push_back(frame("frame_stereo", {7, 6}, jpeg));
    all.push_back(example("pose_frusta", [&](Builder& b) {
        return CreatePose(b, 8, 9, &v, &turned, 0.75f, 0.0625f, 512, 544, &kLeft, &kRight);
    }));
    all.push_back(example("pose_hidden", [&](Builder& b) {
        return CreatePose(b, 9, 10, &v, &turned, 0.75f, 0, 0, 0, nullptr, nullptr, true);
    }));
    all.push_back(example("pose_view", [&](Builder& b) {
        return CreatePoseDirect(b, 10, 11, &v, &turned, 0.75f, 0, 0, 0, nullptr, nullptr, false, "overdraw");
    }));
    all.push_back(frame("frame_frusta", {7, 6}, jpeg, true));
    all.push_back(frame("frame_png", {13}, jpeg, false, Encoding::png));
    all.push_back(frame("frame_measured", {13}, jpeg, false, Encoding::jpeg, 0.00390625f));
    all.push_back(
        example("hello_lossless", [](Builder& b) { return CreateHelloDirect(b, "x", 64, 48, 1, 0, nullptr, true); }));
    all.push_back(example(
        "error", [](Builder& b) { return CreateErrorDirect(b, ErrorCode::unknown_name, "no method \"tetra\"", 5); }));
    all.push_back(example(
        "hello_draws", [](Builder& b) { return CreateHelloDirect(b, "x", 64, 48, 1, 0, nullptr, false, false, 30); }));
    // Not columns: as above.
    all.push_back(example(
        "lit_particles",
        [&](Builder& b) {
            const std::vector<float> phase{0.7f, 0.3f, 0, 0.5f};
            const std::vector<Hue> hues{{3, 1}, {4, 0.5f}};
            const std::vector<Object> objects{{ObjectKind::box, v, albedo, 0.25f, to_light}};
            const Vec3 straight(1, 0.5f, 0.25f), ambient(0, 0.125f, 0.25f), zenith(0.5f, 0.25f, 1), horizon(1, 0.5f, 0);
            return CreateLitParticlesDirect(b, 41, 123'456'789'012, 0xfedc'ba98'7654'3210, 12, 8, 9'007'199'254'740'993,
                                            500, 0x2'0000'0101, &v, 0.0078125f, 1.5f, &to_light, &irradiance, &phase,
                                            &ambient, &hues, &straight, 0.75f, &zenith, &horizon, 0.015625f, 1.25f,
                                            true, &objects, 0.015625f, 0.00390625f, 0.001953125f, 0.0078125f,
                                            uint32_t(jpeg.size()), 2.5f);
        },
        jpeg));
    all.push_back(example(
        "lit_particles_glowing",
        [&](Builder& b) {
            const std::vector<float> phase{0.7f, 0.3f, 0, 0.5f};
            const std::vector<Hue> hues{{7, 1}};
            const Vec3 none(0, 0, 0), one(1, 1, 1), emission(32, 12.5f, 3), cold_albedo(0.5f, 0.5f, 0.25f);
            return CreateLitParticlesDirect(b, 42, 123'456'789'013, 0xfedc'ba98'7654'3210, 13, 0, 9'007'199'254'740'993,
                                            500, 0x101, &v, 0.0078125f, 1.5f, &to_light, &irradiance, &phase, &none,
                                            &hues, &one, 0, &none, &none, 0, 1, true, nullptr, 0, 0, 0, 0,
                                            uint32_t(jpeg.size()), 2.5f, &emission, &cold_albedo);
        },
        jpeg));
    all.push_back(example("presence", [&](Builder& b) {
        const Ray pointer(v, to_light);
        return CreatePresenceDirect(b, "Zo\xc3\xab", &pointer, 3, true);
    }));
    all.push_back(example("presence_of_nobody", [](Builder& b) { return CreatePresence(b); }));
    all.push_back(example("lead", [](Builder& b) { return CreateLead(b, 3); }));
    all.push_back(example("people", [&](Builder& b) {
        const Look look(v, turned, 0.75f, 0.5f);
        const std::vector<flatbuffers::Offset<Person>> people{
            CreatePersonDirect(b, 3, "ann", true, 0xe69f00, Role::presenter, 0, &look, &to_light),
            CreatePersonDirect(b, 4, "<b>bob</b>", false, 0x56b4e9, Role::viewer, 3)};
        return CreatePeopleDirect(b, &people, 70, 3);
    }));
    return all;
}

} // namespace brume::wire
