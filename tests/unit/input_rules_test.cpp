// What a viewer may do to the scene: the order, rate and limits of inputs, by the rules alone.
#include "tests/net/set_message.h"
#include "tests/unit/session_rules_fixture.h"

namespace brume::net {
namespace {

using test::set, wire::ErrorCode;

TEST_F(SessionRulesTest, InputsComeOneAfterAnother) {
    watch();
    EXPECT_EQ(only<EnqueueCommand>(restart(7)).seq, 7u) << "any number may be the first";
    only<EnqueueCommand>(restart(8));
    const auto repeated = restart(8);
    EXPECT_EQ(onlyError(repeated), ErrorCode::unexpected);
    EXPECT_EQ(only<SendError>(repeated).input_seq, 8u);
    only<EnqueueCommand>(restart(9));
    EXPECT_EQ(onlyError(restart(12)), ErrorCode::unexpected) << "a gap is told ...";
    only<EnqueueCommand>(restart(13)); // ... and gone on from
    SetUp();
    watch();
    only<EnqueueCommand>(restart(0xffffffff));
    only<EnqueueCommand>(restart(0)); // around the wrap
    EXPECT_EQ(onlyError(restart(0xffffffff)), ErrorCode::unexpected);
    only<EnqueueCommand>(restart(1));
}

TEST_F(SessionRulesTest, InputsOverTheRateAreRefusedByNumber) {
    watch();
    uint32_t seq = 0;
    for (double i = 0; i < options.input_rate * options.burst_s; ++i) only<EnqueueCommand>(restart(++seq));
    const auto refused = restart(++seq);
    EXPECT_EQ(onlyError(refused), ErrorCode::too_fast);
    EXPECT_EQ(only<SendError>(refused).input_seq, seq);
    now += 1s;
    only<EnqueueCommand>(restart(++seq)); // the refused number was used: the next one follows it
}

TEST_F(SessionRulesTest, CommandsArriveAsTheyWereSent) {
    watch();
    const wire::Vec3 origin(1, 2, 3), along(0, 0, -4), push(0, 5, 0);
    const auto impulse = std::get<Impulse>(only<EnqueueCommand>(input(1, [&](auto& b) {
                                               return wire::CreateImpulse(b, &origin, &along, &push, 2);
                                           })).body);
    EXPECT_EQ(impulse.origin, glm::vec3(1, 2, 3));
    EXPECT_EQ(impulse.direction, glm::vec3(0, 0, -4)) << "the simulation makes it a unit vector";
    EXPECT_EQ(impulse.push, glm::vec3(0, 5, 0));
    EXPECT_EQ(impulse.strength, 2);

    const auto moved = std::get<MoveVolume>(
        only<EnqueueCommand>(input(2, [&](auto& b) { return wire::CreateMoveVolume(b, &origin); })).body);
    EXPECT_EQ(moved.offset, glm::vec3(1, 2, 3));
}

// Any live setting by its path, of each type that there is.
TEST_F(SessionRulesTest, SettingsAreSetByTheirPaths) {
    watch();
    using Changes = std::vector<flatbuffers::Offset<wire::Change>>;
    uint32_t seq = 0;
    const auto answer = [&](auto&& build) {
        return input(++seq, [&](auto& b) {
            const Changes changes = build(b);
            return wire::CreateSetDirect(b, &changes);
        });
    };
    const wire::Vec3 up(0, 5, 0), zero(0, 0, 0);
    const auto all = answer([&](auto& b) {
        return Changes{
            wire::CreateChangeDirect(b, "medium.falloff", 1.5), wire::CreateChangeDirect(b, "render.isv.steps", 3),
            wire::CreateChangeDirect(b, "simulation.paused", 1), wire::CreateChangeDirect(b, "light.to_light", {}, &up),
            wire::CreateChangeDirect(b, "render.method", {}, nullptr, "isv")};
    });
    const std::vector<Change> changes = std::get<Set>(only<EnqueueCommand>(all).body).changes;
    const std::vector<SettingValue> values{1.5f, 3u, true, glm::vec3(0, 5, 0), "isv"};
    ASSERT_EQ(changes.size(), values.size());
    EXPECT_EQ(changes[0].setting->path, "medium.falloff");
    for (size_t i = 0; i < values.size(); ++i) EXPECT_EQ(changes[i].value, values[i]) << changes[i].setting->path;

    const auto refused = [&](const char* path, flatbuffers::Optional<double> number, const wire::Vec3* vector,
                             const char* text) {
        const auto actions = answer([&](auto& b) {
            return Changes{wire::CreateChangeDirect(b, "medium.falloff", 1.5),
                           wire::CreateChangeDirect(b, path, number, vector, text)};
        });
        EXPECT_EQ(only<SendError>(actions).input_seq, seq);
        return onlyError(actions);
    };
    const auto whyRefused = [&](const char* path) {
        const auto actions = answer([&](auto& b) { return Changes{wire::CreateChangeDirect(b, path, 1)}; });
        return only<SendError>(actions).text;
    };
    EXPECT_EQ(refused("medium.cuont", 1, nullptr, nullptr), ErrorCode::unknown_name);
    EXPECT_EQ(refused("medium.count", 1, nullptr, nullptr), ErrorCode::unknown_name) << "not live";
    EXPECT_EQ(whyRefused("medium.count"), "medium.count changes only with a restart");
    EXPECT_EQ(whyRefused("render.expsoure"), "no such live setting; did you mean render.exposure?");
    EXPECT_EQ(whyRefused("exposure"), "no such live setting; did you mean render.exposure?");
    EXPECT_EQ(whyRefused("weather"), "no such live setting; docs/scenes.md has those that there are");
    EXPECT_EQ(refused("render.method", {}, nullptr, "tetra"), ErrorCode::unknown_name);
    EXPECT_EQ(refused("medium.falloff", {}, nullptr, nullptr), ErrorCode::out_of_range) << "no value";
    EXPECT_EQ(refused("medium.falloff", 0, nullptr, nullptr), ErrorCode::out_of_range);
    EXPECT_EQ(refused("medium.falloff", 1e300, nullptr, nullptr), ErrorCode::out_of_range);
    EXPECT_EQ(refused("medium.falloff", kNan, nullptr, nullptr), ErrorCode::out_of_range);
    EXPECT_EQ(refused("medium.falloff", {}, nullptr, "1"), ErrorCode::out_of_range) << "another type";
    EXPECT_EQ(refused("medium.albedo", 1, nullptr, nullptr), ErrorCode::out_of_range);
    EXPECT_EQ(refused("render.method", 1, nullptr, nullptr), ErrorCode::out_of_range);
    EXPECT_EQ(refused("render.isv.steps", 2.5, nullptr, nullptr), ErrorCode::out_of_range);
    EXPECT_EQ(refused("render.isv.steps", -1, nullptr, nullptr), ErrorCode::out_of_range);
    EXPECT_EQ(refused("render.isv.steps", kNan, nullptr, nullptr), ErrorCode::out_of_range);
    EXPECT_EQ(refused("simulation.paused", 2, nullptr, nullptr), ErrorCode::out_of_range);
    EXPECT_EQ(refused("light.to_light", {}, &zero, nullptr), ErrorCode::out_of_range);
}

TEST_F(SessionRulesTest, CommandsBeyondTheirLimitsAreRefused) {
    watch();
    uint32_t seq = 0;
    const wire::Vec3 zero(0, 0, 0), one(1, 1, 1), nan(0, kNan, 0), far(1e9f, 0, 0), negative(-1, 0, 0), two(2, 0, 0);
    const auto refused = [&](auto&& build) {
        const auto actions = input(++seq, build);
        EXPECT_EQ(only<SendError>(actions).input_seq, seq);
        return onlyError(actions);
    };
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &nan, &one); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &one, &zero); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &one, &nan); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &one, &one, &far); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &one, &one, nullptr, 11); }),
              ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &one, &one, nullptr, kNan); }),
              ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateMoveVolume(b, &far); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("light.to_light", zero)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("light.irradiance", negative)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("light.rotate", kInf)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("medium.extinction", -1)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("medium.falloff", 0.0)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("medium.anisotropy", 1.5)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("medium.asymmetry", 1)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("medium.albedo", two)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("render.isv.steps", 0.0)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("render.isv.steps", 11)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("render.exposure", 0.0)), ErrorCode::out_of_range);
    EXPECT_EQ(refused(set("render.method", "tetra")), ErrorCode::unknown_name);
    EXPECT_EQ(refused(set("render.method", "")), ErrorCode::unknown_name);
    EXPECT_EQ(refused(set("render.isv.quadrature", "euler")), ErrorCode::unknown_name);
}

TEST_F(SessionRulesTest, ElementsOfListsAreChangedAddedAndRemoved) {
    watch();
    const auto body = [&](uint32_t seq, auto&& build) { return only<EnqueueCommand>(input(seq, build)).body; };
    const auto changes = [](auto& b, const char* path, const char* text) {
        return std::vector{wire::CreateChangeDirect(b, path, {}, nullptr, text)};
    };
    const auto set = std::get<Set>(body(1, [&](auto& b) {
        const std::vector all{wire::CreateChangeDirect(b, "fog[1].extinction", 0.5)};
        return wire::CreateSetDirect(b, &all);
    }));
    ASSERT_EQ(set.changes.size(), 1u);
    EXPECT_EQ(set.changes[0].path(), "fog[1].extinction");
    EXPECT_EQ(set.changes[0].value, SettingValue(0.5f));
    const auto add = std::get<Add>(body(2, [&](auto& b) {
        const auto all = changes(b, "light.type", "spot");
        return wire::CreateAddDirect(b, "light", &all);
    }));
    EXPECT_EQ(add.list, SceneList::lights);
    ASSERT_EQ(add.changes.size(), 1u);
    EXPECT_EQ(add.changes[0].value, SettingValue("spot"));
    EXPECT_TRUE(std::get<Add>(body(3, [](auto& b) { return wire::CreateAddDirect(b, "fog"); })).changes.empty());
    const auto removal = std::get<Remove>(body(4, [](auto& b) { return wire::CreateRemoveDirect(b, "fog[2]"); }));
    EXPECT_EQ(removal.list, SceneList::fogs);
    EXPECT_EQ(removal.element, 2u);

    uint32_t seq = 4;
    const auto why = [&](auto&& build) { return only<SendError>(input(++seq, build)).text; };
    const auto whyNotSet = [&](const char* path) {
        return why([&](auto& b) {
            const std::vector all{wire::CreateChangeDirect(b, path, 1)};
            return wire::CreateSetDirect(b, &all);
        });
    };
    EXPECT_EQ(whyNotSet("fog.extinction"), "extinction of which? fog[0].extinction is the first one's");
    EXPECT_EQ(whyNotSet("fog[0].extincton"), "no such live setting; did you mean extinction?");
    EXPECT_EQ(whyNotSet("objects[0].size"), "no such live setting; docs/scenes.md has those that there are");
    EXPECT_EQ(whyNotSet("fog[0].droplet"), "droplet must be 5 ... 50");
    EXPECT_EQ(why([](auto& b) { return wire::CreateAddDirect(b, "objects"); }),
              "no such list; there are light, fog, plane, box and sphere");
    EXPECT_EQ(why([&](auto& b) {
                  const auto all = changes(b, "light[0].type", "spot");
                  return wire::CreateAddDirect(b, "light", &all);
              }),
              "no setting of a new light; paths have no index: light.position");
    EXPECT_EQ(why([&](auto& b) {
                  const auto all = changes(b, "light.type", "directional");
                  return wire::CreateAddDirect(b, "light", &all);
              }),
              "no such type; there is point, spot");
    for (const char* path : {"fog", "fog[0].extinction", "objects[0]"})
        EXPECT_EQ(why([&](auto& b) { return wire::CreateRemoveDirect(b, path); }),
                  "no such element: fog[0] is the first fog");
}

using Floats = std::vector<float>;

auto setParticles(uint32_t first, const Floats& positions, const Floats& scales, const Floats& extinctions,
                  const Floats& albedos, uint32_t live, float seconds = 0) {
    return [=](auto& b) {
        return wire::CreateSetParticlesDirect(b, first, &positions, &scales, &extinctions,
                                              albedos.empty() ? nullptr : &albedos, live, seconds);
    };
}

TEST_F(SessionRulesTest, RowsOfParticlesArriveAsTheyWereSent) {
    watch();
    rules->shows({Layout::live, 10});
    const auto set =
        std::get<SetParticles>(only<EnqueueCommand>(input(1, setParticles(3, {1, 2, 3, 4, 5, 6}, {0.5f, 1}, {0, 7},
                                                                          {0, 0.5f, 1, 1, 1, 0}, 5, 0.25f)))
                                   .body);
    EXPECT_EQ(set.first, 3u);
    EXPECT_EQ(set.live, 5u);
    EXPECT_EQ(set.seconds, 0.25f);
    EXPECT_EQ(set.rows->positions, (std::vector<glm::vec3>{{1, 2, 3}, {4, 5, 6}}));
    EXPECT_EQ(set.rows->scales, (Floats{0.5f, 1}));
    EXPECT_EQ(set.rows->extinctions, (Floats{0, 7}));
    EXPECT_EQ(set.rows->albedos, (std::vector<glm::vec3>{{0, 0.5f, 1}, {1, 1, 0}}));
    const auto only_live = std::get<SetParticles>(only<EnqueueCommand>(input(2, [](auto& b) {
                                                      wire::SetParticlesBuilder builder(b);
                                                      builder.add_live(4);
                                                      return builder.Finish();
                                                  })).body);
    EXPECT_EQ(only_live.live, 4u);
    EXPECT_TRUE(only_live.rows->positions.empty());
}

TEST_F(SessionRulesTest, RowsOfParticlesBeyondTheirLimitsAreRefusedAndPushesToo) {
    watch();
    rules->shows({Layout::live, 10});
    uint32_t seq = 0;
    const auto refused = [&](auto&& build) {
        const auto actions = input(++seq, build);
        EXPECT_EQ(only<SendError>(actions).input_seq, seq);
        return onlyError(actions) == ErrorCode::out_of_range ? only<SendError>(actions).text : "another code";
    };
    EXPECT_EQ(refused(setParticles(0, {1, 2}, {1}, {1}, {}, 1)),
              "positions and albedos have three numbers for each row");
    EXPECT_EQ(refused(setParticles(0, {1, 2, 3}, {1}, {1}, {1}, 1)),
              "positions and albedos have three numbers for each row");
    EXPECT_EQ(refused(setParticles(0, {1, 2, 3}, {1, 1}, {1}, {}, 1)),
              "1 positions, 2 scales, 1 extinctions and 0 albedos; as many of each, or no albedos");
    EXPECT_EQ(refused(setParticles(10, {1, 2, 3}, {1}, {1}, {}, 1)),
              "rows 10 ... 11, 1 live: the scene has medium.count = 10 rows");
    EXPECT_EQ(refused(setParticles(0xffffffff, {1, 2, 3}, {1}, {1}, {}, 1)).find("rows 4294967295"), 0u);
    EXPECT_EQ(refused(setParticles(0, {}, {}, {}, {}, 11)).find("rows 0"), 0u);
    EXPECT_EQ(refused(setParticles(4, {1, kNan, 3}, {1}, {1}, {}, 1)),
              "the position of row 4 must be -50000 ... 50000");
    EXPECT_EQ(refused(setParticles(0, {1, 2, 3}, {0}, {1}, {}, 1)), "the scale of row 0 must be 0.001 ... 100000");
    EXPECT_EQ(refused(setParticles(0, {1, 2, 3}, {1}, {-1}, {}, 1)), "the extinction of row 0 must be 0 ... 10000");
    EXPECT_EQ(refused(setParticles(0, {1, 2, 3}, {1}, {1}, {0, 2, 0}, 1)), "the albedo of row 0 must be 0 ... 1");
    EXPECT_EQ(refused(setParticles(0, {}, {}, {}, {}, 1, 61)), "seconds must be 0 ... 60");
    EXPECT_EQ(refused(setParticles(0, {}, {}, {}, {}, 1, kNan)), "seconds must be 0 ... 60");
    rules->shows({Layout::live, 1'000'000});
    const Floats many(3001, 1.0f), places(size_t{3} * 3001, 1.0f);
    EXPECT_EQ(refused(setParticles(0, places, many, many, {}, 1)), "3001 rows in one message; at most 3000");

    const wire::Vec3 ahead(0, 0, -1);
    const auto push = input(++seq, [&](auto& b) { return wire::CreateImpulse(b, &ahead, &ahead); });
    EXPECT_EQ(onlyError(push), ErrorCode::unexpected);
    rules->shows({Layout::sequence, 10});
    EXPECT_EQ(onlyError(input(++seq, [&](auto& b) { return wire::CreateImpulse(b, &ahead, &ahead); })),
              ErrorCode::unexpected);
    rules->shows({Layout::cube, 10});
    const auto elsewhere = input(++seq, setParticles(0, {}, {}, {}, {}, 0));
    EXPECT_EQ(onlyError(elsewhere), ErrorCode::unexpected);
    EXPECT_NE(only<SendError>(elsewhere).text.find("layout \"live\""), std::string::npos);
}

// The largest messages are within the limit of the socket.
TEST(ParticleRows, FitAMessage) {
    const Floats each(kMostRows, 1.0f), three(3 * kMostRows, 1.0f), fewer(2000, 1.0f), three_fewer(6000, 1.0f);
    const auto bytes = [](const Floats& one, const Floats& three_of_them, const Floats* albedos) {
        return wire::pack([&](auto& b) {
                   const auto set = wire::CreateSetParticlesDirect(b, 0, &three_of_them, &one, &one, albedos, 0, 0.1f);
                   return wire::CreateInput(b, 1, 2, wire::Command::SetParticles, set.Union());
               })
            .size();
    };
    EXPECT_LE(bytes(each, three, nullptr), NetOptions().max_message_bytes);
    EXPECT_LE(bytes(fewer, three_fewer, &three_fewer), NetOptions().max_message_bytes);
}

TEST_F(SessionRulesTest, AnUnknownNameIsToldWhatThereIs) {
    watch();
    const auto actions = input(1, set("render.method", "tetra"));
    EXPECT_NE(only<SendError>(actions).text.find("sphere, isv"), std::string::npos);
}

// The least role of each command; a refusal uses up the input's number, as all do.
TEST_F(SessionRulesTest, ARoleMayDoWhatItIsFor) {
    NamedParticles medium;
    const auto answer = [&](wire::Role role, auto&& build) {
        rules.emplace(options, facts, now, Authorization{role, {}, {}});
        rules->shows(medium);
        watch();
        const Actions actions = input(1, build);
        EXPECT_EQ(actions.size(), 1u);
        if (std::holds_alternative<EnqueueCommand>(actions[0])) return std::string("taken");
        const auto& error = std::get<SendError>(actions[0]);
        EXPECT_EQ(error.input_seq, 1u);
        EXPECT_TRUE(std::holds_alternative<EnqueueCommand>(input(2, build).at(0)) ||
                    error.code == ErrorCode::forbidden);
        EXPECT_NE(error.text.find(nameOf(role)), std::string::npos) << error.text;
        return std::string(wire::EnumNameErrorCode(error.code));
    };
    const auto least = [&](auto&& build) {
        for (const wire::Role role : wire::EnumValuesRole()) {
            const std::string said = answer(role, build);
            if (said == "taken") return std::string(nameOf(role));
            EXPECT_EQ(said, "forbidden");
        }
        return std::string("nobody");
    };
    static const wire::Vec3 ahead(0, 0, -1);
    EXPECT_EQ(least([](auto& b) { return wire::CreateImpulse(b, &ahead, &ahead); }), "controller");
    EXPECT_EQ(least([](auto& b) { return wire::CreateMoveVolume(b, &ahead); }), "controller");
    EXPECT_EQ(least(set("light.to_light", ahead)), "controller");
    EXPECT_EQ(least(set("simulation.paused", true)), "controller");
    EXPECT_EQ(least(set("render.method", "isv")), "operator");
    const auto setAll = [](auto& b, std::initializer_list<const char*> paths) {
        std::vector<flatbuffers::Offset<wire::Change>> changes;
        for (const char* path : paths) changes.push_back(wire::CreateChangeDirect(b, path, 1));
        return wire::CreateSetDirect(b, &changes);
    };
    EXPECT_EQ(least([&](auto& b) { return setAll(b, {"medium.falloff", "light.rotate"}); }), "controller");
    EXPECT_EQ(least([&](auto& b) { return setAll(b, {"medium.falloff", "render.exposure"}); }), "operator");
    EXPECT_EQ(least([&](auto& b) { return setAll(b, {"fog[0].extinction"}); }), "controller");
    EXPECT_EQ(least([](auto& b) { return wire::CreateAddDirect(b, "light"); }), "controller");
    EXPECT_EQ(least([](auto& b) { return wire::CreateRemoveDirect(b, "light[0]"); }), "controller");
    EXPECT_EQ(least([](auto& b) { return wire::CreateUndo(b); }), "controller");
    EXPECT_EQ(least([](auto& b) { return wire::CreateRestart(b); }), "operator");
    medium.layout = Layout::live;
    EXPECT_EQ(least([](auto& b) { return wire::CreateSetParticles(b); }), "operator");
}

TEST_F(SessionRulesTest, AViewerLooksAndWhoTriesForbiddenThingsForEverIsClosed) {
    rules.emplace(options, facts, now, Authorization{wire::Role::viewer, {}, {}});
    watch();
    only<SetPose>(pose({.seq = 1}));
    only<AnswerPing>(say([](auto& b) { return wire::CreatePing(b, 1, 1); }));
    bool closed = false;
    for (uint32_t seq = 1; seq < 1000 && !closed; ++seq)
        for (const Action& action : restart(seq)) closed |= std::holds_alternative<Close>(action);
    EXPECT_TRUE(closed);
}

TEST_F(SessionRulesTest, ASessionEndsWithItsToken) {
    rules.emplace(options, facts, now, Authorization{wire::Role::viewer, now + 60s, {}});
    watch();
    only<SetPose>(pose({}));
    EXPECT_TRUE(tick(60s - 1ms).empty());
    const Actions actions = tick(1ms);
    EXPECT_EQ(only<Close>(actions).code, kClosePolicy);
    EXPECT_EQ(only<Close>(actions).reason, "the token has expired");
    EXPECT_TRUE(tick(1s).empty()) << "once";
}

} // namespace
} // namespace brume::net
