// Commands as messages, as recordings and the log of a cluster keep them: bit for bit, and nothing else is one.
#include "server/net/command_message.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "server/sim/state_hash.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::net {
namespace {

constexpr float kTiny = std::numeric_limits<float>::denorm_min(), kThird = 1.0f / 3;

SetParticles rows(ParticleRows all, uint32_t first, uint32_t live, float seconds) {
    return {first, live, seconds, std::make_shared<const ParticleRows>(std::move(all))};
}

// Of every kind, with numbers that decimal digits or zeros that are left out would change.
const std::vector<CommandBody>& bodies() {
    static const std::vector<CommandBody> all{
        Impulse{{kTiny, kThird, -49999.996f}, {-0.0f, 0.1f, 16777.217f}, {1e-38f, -0.0f, -3}, -9.999999f},
        Impulse{{0, 0, 0}, {0, 0, -1}, {0, 0, 0}, -0.0f},
        MoveVolume{{kThird, -kThird, kTiny}},
        Set{},
        Set{{"light.to_light", glm::vec3(0.1f, kThird, -3)},
            {"light.irradiance", glm::vec3(10, kThird, 0)},
            {"light.rotate", -0.0f}},
        Set{{"medium.falloff", kThird}, {"medium.albedo", glm::vec3(0.1f, 0.2f, kTiny)}},
        Set{{"render.method", "isv \"x\"\n"}, {"render.isv.quadrature", "simpson"}, {"render.isv.steps", 10u}},
        Set{{"render.method", std::string("a\0b", 3)}},
        Set{{"simulation.paused", true}},
        Set{{"simulation.paused", false}},
        Set{{"fog[1].centre", glm::vec3(0.1f, 2, -3)}, {"light[3].type", "spot"}, {"light[3].shadows", true}},
        Set{{"box[4095].size", glm::vec3(0.1f, 2, 3)}, {"plane[0].height", 0.1f}},
        Restart{},
        SetParticles{},
        rows({{{kTiny, kThird, -kThird}, {-0.0f, 1, 2}}, {kThird, 2}, {0, kTiny}, {}}, 4, 6, kThird),
        rows({{{1, 2, 3}}, {4}, {5}, {{kThird, 0, kTiny}}}, 0, 1, -0.0f),
        Add{SceneList::lights, {{SceneList::lights, "light.type", "spot"}, {SceneList::lights, "light.range", 0.1f}}},
        Add{SceneList::fogs, {}},
        Add{SceneList::spheres, {{SceneList::spheres, "sphere.radius", 0.1f}}},
        Remove{SceneList::fogs, 3},
        Remove{SceneList::lights, 999'999},
        Undo{},
        Undo{true}};
    return all;
}

// The bits of all numbers and texts of a command.
struct BitsOf {
    StateHash& out;

    void operator()(const glm::vec3& v) const { out.add(std::span(&v.x, 3)); }
    void operator()(float v) const { out.add(std::span(&v, 1)); }
    void operator()(const std::string& text) const { out.add(std::string_view(text)); }
    void operator()(uint32_t v) const { out.add(uint64_t{v}); }
    void operator()(bool v) const { out.add(uint64_t{v}); }
    void operator()(const std::vector<Change>& changes) const {
        for (const Change& one : changes) {
            (*this)(one.path());
            std::visit(*this, one.value);
        }
    }
    template <class T>
    void list(const std::vector<T>& all) const {
        out.add(uint64_t{all.size()});
        for (const T& one : all) (*this)(one);
    }
    void operator()(const Impulse& c) const {
        (*this)(c.origin), (*this)(c.direction), (*this)(c.push), (*this)(c.strength);
    }
    void operator()(const MoveVolume& c) const { (*this)(c.offset); }
    void operator()(const Set& c) const { (*this)(c.changes); }
    void operator()(const Restart&) const {}
    void operator()(const SetParticles& c) const {
        (*this)(c.first), (*this)(c.live), (*this)(c.seconds);
        list(c.rows->positions), list(c.rows->scales), list(c.rows->extinctions), list(c.rows->albedos);
    }
    void operator()(const Add& c) const {
        (*this)(static_cast<uint32_t>(c.list));
        (*this)(c.changes);
    }
    void operator()(const Undo& c) const { (*this)(c.operators); }
    void operator()(const Remove& c) const { (*this)(static_cast<uint32_t>(c.list)), (*this)(c.element); }
};
uint64_t bitsOf(const CommandBody& body) {
    StateHash out;
    out.add(uint64_t{body.index()});
    std::visit(BitsOf{out}, body);
    return out.value();
}

TEST(CommandMessage, EveryCommandComesBackBitForBit) {
    std::vector<bool> kinds(std::variant_size_v<CommandBody>);
    for (const CommandBody& body : bodies()) {
        kinds[body.index()] = true;
        const std::string text = textOf({3, 4'000'000'000u, body});
        const Command back = commandOf(text);
        EXPECT_EQ(back.viewer, 0u) << "it leaves out who asked";
        EXPECT_EQ(back.seq, 4'000'000'000u);
        EXPECT_EQ(bitsOf(back.body), bitsOf(body)) << text;
        EXPECT_EQ(textOf(back), text);
    }
    EXPECT_EQ(std::count(kinds.begin(), kinds.end(), false), 0) << "every kind";
    const Impulse impulse = std::get<Impulse>(commandOf(textOf({1, 2, bodies()[0]})).body);
    EXPECT_TRUE(std::signbit(impulse.direction.x) && std::signbit(impulse.push.y));
    EXPECT_EQ(impulse.origin.x, kTiny);
}

TEST(CommandMessage, GivesTheSameStates) {
    for (const bool live : {false, true}) {
        Scene scene = live ? cubeScene(8) : plumeScene();
        if (live) scene.medium.layout = Layout::live;
        scene.fogs.resize(4);
        Simulation a(scene), b(scene);
        for (const CommandBody& body : bodies()) {
            a.step(std::vector{command(body)});
            b.step(std::vector{commandOf(textOf(command(body)))});
            ASSERT_EQ(a.stateHash(), b.stateHash());
        }
    }
}

std::string whyNot(const std::string& text) {
    try {
        commandOf(text);
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        return error.what();
    }
    return "nothing";
}

TEST(CommandMessage, WhatIsNoCommandIsRefusedInOneLine) {
    const std::string good = textOf({1, 2, Impulse{}});
    EXPECT_EQ(whyNot(good), "nothing");
    EXPECT_EQ(whyNot(good.substr(1)), "a command that is not base64");
    EXPECT_EQ(whyNot("{}"), "a command that is not base64");
    for (const std::string& text : {std::string(), std::string("AAAA"), good.substr(4), good + "AAAA"})
        EXPECT_EQ(whyNot(text), "a command that is not an Input of brume.v1") << text;
    // Any change of a character gives another command or a refusal, and never what is out of limits.
    for (const CommandBody& body : {bodies()[0], bodies()[4], bodies()[14]}) {
        const std::string text = textOf({1, 2, body});
        for (size_t at = 0; at < text.size(); ++at)
            for (const char c : {'A', 'z', '/', '='}) {
                std::string changed = text;
                changed[at] = c;
                if (whyNot(changed) != "nothing") continue;
                EXPECT_EQ(whyNot(textOf(commandOf(changed))), "nothing");
            }
    }
}

TEST(CommandMessage, NumbersBeyondTheirLimitsAreRefused) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(whyNot(textOf({1, 2, MoveVolume{{0, 1e6f, 0}}})).find("offset must be -50000 ... 50000"),
              std::string::npos);
    for (const CommandBody& body : std::vector<CommandBody>{
             Impulse{.direction = {0, 0, 0}},
             Impulse{.strength = nan},
             Set{{"medium.falloff", nan}},
             Set{{"medium.falloff", 1e9f}},
             rows({{{nan, 0, 0}}, {1}, {1}, {}}, 0, 1, 0),
             rows({{{0, 0, 0}}, {1, 1}, {1}, {}}, 0, 1, 0),
             rows({{{0, 0, 0}}, {1}, {1}, {}}, ~0u, 1, 0),
         })
        EXPECT_EQ(whyNot(textOf({1, 2, body})).find("a command that is refused: "), 0u);
}

} // namespace
} // namespace brume::net
