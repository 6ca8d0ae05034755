// The server's messages, read again.
#include <gtest/gtest.h>

#include "server/net/outgoing.h"
#include "server/net/scene_news.h"

namespace brume::net {
namespace {

// Whichever method it is: the distance of its rays, its slabs and what is promised reach the viewers.
TEST(Outgoing, ASceneStateTellsThePlansRaysSlabsAndPromise) {
    SceneReport report;
    report.plan.method = "grid";
    report.plan.rate = 6;
    report.plan.slabs = 48;
    report.plan.promised = 0.25;
    const wire::Packed packed = packSceneState(report, 1);
    const auto parsed = wire::parse(wire::bytesOf(packed));
    ASSERT_TRUE(parsed);
    const wire::Plan* plan = parsed->as<wire::SceneState>()->plan();
    EXPECT_EQ(plan->method()->str(), "grid");
    EXPECT_EQ(plan->rate(), 6u);
    EXPECT_EQ(plan->slabs(), 48u);
    EXPECT_EQ(plan->promised(), 0.25f);
}

// A viewer can show and change the lists' elements without knowing any of their settings.
TEST(Outgoing, ListsAreDescribedAndTheirElementsSentWhereTheyAreNew) {
    Audience audience({}, sceneFacts({}), 1, 2);
    const auto viewer = audience.join(nullptr).viewer;
    SceneNews news(audience);
    EXPECT_TRUE(news.anotherScene());
    const wire::Packed greeting = packWelcome(*viewer, {}, audience, news.takeScene(), wire::Role::controller);
    const auto welcome = wire::parse(wire::bytesOf(greeting));
    ASSERT_TRUE(welcome);
    const auto* lists = welcome->as<wire::Welcome>()->lists();
    ASSERT_EQ(lists->size(), std::size(kSceneLists));
    EXPECT_EQ(lists->Get(0)->name()->str(), "light");
    EXPECT_EQ(lists->Get(0)->most(), 1024u);
    EXPECT_EQ(lists->Get(1)->name()->str(), "fog");
    EXPECT_EQ(lists->Get(1)->settings()->size(), liveSettings(SceneList::fogs).size());
    EXPECT_EQ(lists->Get(3)->name()->str(), "box");
    EXPECT_EQ(lists->Get(3)->most(), 4096u);
    const wire::Setting& type = *lists->Get(0)->settings()->Get(0);
    EXPECT_EQ(type.path()->str(), "light.type");
    EXPECT_EQ(type.choices()->size(), 2u) << "a point or a spot";
    for (const wire::Setting* setting : *lists->Get(0)->settings()) {
        const std::string_view path = setting->path()->string_view();
        const bool of_spots = path == "light.axis" || path == "light.inner" || path == "light.outer";
        EXPECT_EQ(setting->only_type() ? setting->only_type()->str() : "", of_spots ? "spot" : "") << path;
    }

    SceneReport report;
    report.lists.lights.resize(1024, {.type = kSpot, .position = {1, 2, 3}, .shadows = false});
    report.lists_hash = 1;
    Clock::time_point now{};
    const auto elements = [&]() -> std::vector<size_t> {
        audience.publish(std::make_shared<SceneReport>(report));
        const wire::Packed state = news.takeState(now += std::chrono::milliseconds(100));
        const auto parsed = wire::parse(wire::bytesOf(state)); // which bounds the number of tables
        const auto* told = parsed ? parsed->as<wire::SceneState>()->lists() : nullptr;
        if (!told) return {};
        EXPECT_EQ(told->Get(0)->values()->Get(0), 1.0f) << "the second choice";
        EXPECT_EQ(told->Get(0)->values()->Get(2), 2.0f) << "y of its place";
        return {told->Get(0)->values()->size(), told->Get(1)->values()->size()};
    };
    EXPECT_EQ(elements(), (std::vector<size_t>{size_t(1024) * 19, 0}));
    EXPECT_TRUE(elements().empty()) << "nothing has changed";
    ++report.lists_hash;
    EXPECT_TRUE(elements().empty()) << "long lists do not come so soon again";
    EXPECT_FALSE(elements().empty());
    news.takeScene();
    EXPECT_FALSE(elements().empty()) << "another scene";
}

TEST(Outgoing, AFrameTellsItsViewersMeasuredError) {
    EncodedFrame frame;
    frame.jpeg[0] = std::make_shared<const std::vector<uint8_t>>(3, uint8_t{0});
    for (const MeasuredError& said : {MeasuredError{0.004f, 0.003f, 0.006f}, MeasuredError{}}) {
        frame.measured = said;
        const wire::Packed header = packFrameHeader(frame, 0);
        const auto bytes = wire::bytesOf(header);
        std::vector<uint8_t> message(bytes.begin(), bytes.end());
        message.insert(message.end(), 3, 0); // the picture
        const auto parsed = wire::parse(message);
        ASSERT_TRUE(parsed);
        const auto* told = parsed->as<wire::Frame>();
        EXPECT_EQ(told->measured(), said.rmse);
        EXPECT_EQ(told->measured_low(), said.low);
        EXPECT_EQ(told->measured_high(), said.high);
    }
}

// A viewer can show and change every live setting without knowing any of them.
TEST(Outgoing, EveryLiveSettingIsDescribedAndItsValueSent) {
    Audience audience({.methods = {"auto", "isv"}}, sceneFacts({}), 1, 2);
    const auto viewer = audience.join(nullptr).viewer;
    const wire::Packed greeting = packWelcome(*viewer, {}, audience, *audience.scene(), wire::Role::controller);
    SceneReport report;
    const wire::Packed state = packSceneState(report, 1);
    const auto welcome = wire::parse(wire::bytesOf(greeting)), scene = wire::parse(wire::bytesOf(state));
    ASSERT_TRUE(welcome && scene);
    const auto* described = welcome->as<wire::Welcome>()->settings();
    const auto* values = scene->as<wire::SceneState>()->settings();
    ASSERT_EQ(described->size(), liveSettings().size());
    ASSERT_EQ(values->size(), liveSettings().size());
    for (uint32_t i = 0; i < described->size(); ++i) {
        const SceneSetting& setting = *liveSettings()[i];
        const wire::Setting& told = *described->Get(i);
        EXPECT_EQ(told.path()->string_view(), setting.path);
        EXPECT_EQ(told.help()->string_view(), setting.help);
        EXPECT_EQ(told.least_role() == wire::Role::operator_, setting.changed_by == ChangedBy::operators);
        EXPECT_LE(told.lowest(), told.usual_lowest()) << setting.path;
        EXPECT_GE(told.highest(), told.usual_highest()) << setting.path;
        const wire::Value& value = *values->Get(i);
        switch (told.kind()) {
        case wire::SettingKind::boolean:
            EXPECT_EQ(value.number(), double(std::get<bool>(report.settings[i])));
            break;
        case wire::SettingKind::whole:
            EXPECT_EQ(value.number(), double(std::get<uint32_t>(report.settings[i])));
            break;
        case wire::SettingKind::number:
            EXPECT_EQ(value.number(), double(std::get<float>(report.settings[i])));
            break;
        case wire::SettingKind::vector:
        case wire::SettingKind::colour:
        case wire::SettingKind::direction:
            EXPECT_EQ(value.vector()->y(), std::get<glm::vec3>(report.settings[i]).y);
            break;
        case wire::SettingKind::text:
            EXPECT_EQ(value.text()->str(), std::get<std::string>(report.settings[i]));
            ASSERT_TRUE(told.choices()) << setting.path;
            EXPECT_EQ(told.choices()->size(), setting.path == "render.method" ? 2 : setting.choices.size());
            break;
        }
    }
}

} // namespace
} // namespace brume::net
