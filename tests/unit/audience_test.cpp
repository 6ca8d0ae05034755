// The audience: who may join, what leaving does, and when its revision grows.
#include <array>
#include <set>

#include <gtest/gtest.h>

#include "server/viewer/audience.h"
#include "tests/unit/take_due.h"

namespace brume {
namespace {

PoseRequest firstPose() {
    PoseRequest request;
    request.seq = 1;
    return request;
}

TEST(Audience, HasAsManyPlacesAsItSays) {
    Audience audience({}, sceneFacts({}), 2, 2);
    const auto first = audience.join(nullptr).viewer, second = audience.join(nullptr).viewer;
    ASSERT_TRUE(first && second);
    EXPECT_NE(first->id(), second->id());
    EXPECT_EQ(audience.join(nullptr).viewer, nullptr);
    audience.leave(first);
    EXPECT_EQ(audience.size(), 1u);
    const auto third = audience.join(nullptr).viewer;
    ASSERT_TRUE(third);
    std::vector<std::shared_ptr<Viewer>> viewers;
    audience.list(viewers);
    EXPECT_EQ(viewers, (std::vector<std::shared_ptr<Viewer>>{second, third}));
}

TEST(Audience, LeavingClosesTheViewer) {
    Audience audience({}, sceneFacts({}), 2, 2);
    const auto viewer = audience.join(nullptr).viewer;
    viewer->setPose(firstPose());
    audience.leave(viewer);
    EXPECT_FALSE(takeDue(*viewer));
    audience.leave(viewer); // again: harmless
    EXPECT_EQ(audience.size(), 0u);
}

TEST(Audience, AViewerMayAskForASmallerWindowNotALarger) {
    Audience audience({}, sceneFacts({}), 3, 2);
    const auto dueOf = [&](uint32_t window) {
        const auto viewer = audience.join(nullptr, {.max_in_flight = window}).viewer;
        viewer->setPose(firstPose());
        int due = 0;
        while (due < 100 && takeDue(*viewer)) ++due;
        return due;
    };
    EXPECT_EQ(dueOf(0), 2);
    EXPECT_EQ(dueOf(1), 1);
    EXPECT_EQ(dueOf(50), 2);
}

// Who draws by himself takes no place of who gets pictures, unless the scene cannot be drawn.
TEST(Audience, WhoDrawsByHimselfHasOtherPlaces) {
    Audience audience({}, sceneFacts({}), 1, 2);
    audience.setMaxViewers(1, 1, 4);
    const auto join = [&](bool draws, const char* owner) {
        return audience.join(nullptr, {.owner = owner, .draws = draws});
    };
    EXPECT_TRUE(join(false, "a").viewer);
    EXPECT_FALSE(join(false, "b").viewer) << "the only place for pictures is taken";
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(join(true, "a").viewer);
    EXPECT_STREQ(join(true, "a").refusal, "your address or token has as many places to draw as one may have");
    EXPECT_TRUE(join(true, "b").viewer);
    EXPECT_STREQ(join(true, "c").refusal, "every place to draw is taken");
    EXPECT_EQ(audience.size(), 5u);
    EXPECT_EQ(audience.withPictures(), 1u);
    audience.setMaxViewers(1, 1, 1000);
    auto report = std::make_shared<SceneReport>();
    report->not_drawable = "it has fog";
    audience.publish(report);
    EXPECT_STREQ(join(true, "c").refusal, "every place is taken") << "it would get pictures";
}

TEST(Audience, OneOwnerDoesNotHoldAllPlaces) {
    Audience audience({}, sceneFacts({}), 8, 2);
    audience.setMaxViewers(8, 3);
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(audience.join(nullptr, {.owner = "address 1"}).viewer);
    const auto refused = audience.join(nullptr, {.owner = "address 1"});
    EXPECT_FALSE(refused.viewer);
    EXPECT_NE(std::string(refused.refusal).find("as many places as one may have"), std::string::npos);
    EXPECT_TRUE(audience.join(nullptr, {.owner = "token ann"}).viewer);
}

TEST(Audience, TheLastPlaceIsForOperators) {
    Audience audience({}, sceneFacts({}), 2, 2);
    audience.keepPlaceForOperators(true);
    EXPECT_TRUE(audience.join(nullptr, {.owner = "token ann"}).viewer);
    const auto refused = audience.join(nullptr, {.owner = "token ben"});
    EXPECT_FALSE(refused.viewer);
    EXPECT_NE(std::string(refused.refusal).find("operators"), std::string::npos);
    EXPECT_TRUE(audience.join(nullptr, {.owner = "token operator", .is_operator = true}).viewer);
}

TEST(Audience, SaysHowManyMayComeThatAreNoOperators) {
    Audience audience({}, sceneFacts({}), 4, 2);
    EXPECT_EQ(audience.places(), 4u);
    audience.keepPlaceForOperators(true);
    EXPECT_EQ(audience.places(), 3u);
    audience.setTimeFor(2);
    EXPECT_EQ(audience.places(), 2u) << "the device has no time for more";
    audience.setTimeFor(100);
    audience.setMaxViewers(1);
    EXPECT_EQ(audience.places(), 1u) << "the only place is for anybody";
}

TEST(Audience, OnlyTheSameTokenNameResumes) {
    Audience audience({}, sceneFacts({}), 8, 2);
    const auto lost = audience.join(nullptr, {.owner = "token ann", .token = "ann"}).viewer;
    lost->setPose(firstPose());
    audience.leave(lost, true);
    const Newcomer thieves[] = {{.owner = "token ben", .key = lost->key(), .token = "ben"},
                                {.owner = "address 1", .key = lost->key()},
                                {.owner = "token ann", .key = lost->key() + "0", .token = "ann"},
                                {.owner = "token ann", .key = lost->key().substr(1), .token = "ann"},
                                {.owner = "token ann", .token = "ann"}};
    for (const Newcomer& one : thieves) {
        const auto thief = audience.join(nullptr, one).viewer;
        EXPECT_FALSE(thief->resumed()) << one.owner << ' ' << one.key;
        EXPECT_NE(thief->id(), lost->id());
    }
    const auto back = audience.join(nullptr, {.owner = "token ann", .key = lost->key(), .token = "ann"}).viewer;
    EXPECT_TRUE(back->resumed());
    EXPECT_EQ(back->id(), lost->id());
}

// A phone that goes from one network to another. Its place is then one of the network in which it is.
TEST(Audience, WithoutATokenAViewerResumesFromAnotherAddressAndCountsThere) {
    Audience audience({}, sceneFacts({}), 8, 2);
    audience.setMaxViewers(8, 1);
    const auto lost = audience.join(nullptr, {.owner = "address 1"}).viewer;
    audience.leave(lost, true);
    const auto back = audience.join(nullptr, {.owner = "address 2", .key = lost->key()}).viewer;
    EXPECT_TRUE(back->resumed());
    EXPECT_EQ(back->id(), lost->id());
    EXPECT_EQ(back->owner(), "address 2");
    EXPECT_FALSE(audience.join(nullptr, {.owner = "address 2"}).viewer);
    EXPECT_TRUE(audience.join(nullptr, {.owner = "address 1"}).viewer);
    EXPECT_FALSE(audience.join(nullptr, {.owner = "address 3", .key = lost->key()}).viewer->resumed()) << "once";
}

TEST(Audience, KeysAre128BitsAndNeverTheSame) {
    Audience audience({}, sceneFacts({}), 4, 2);
    std::set<std::string> keys;
    std::array<int, 16> digits{};
    for (int i = 0; i < 1000; ++i) {
        const auto viewer = audience.join(nullptr).viewer;
        EXPECT_EQ(viewer->key().size(), 32u);
        for (const char digit : viewer->key()) ++digits[std::string("0123456789abcdef").find(digit)];
        keys.insert(viewer->key());
        audience.leave(viewer);
    }
    EXPECT_EQ(keys.size(), 1000u);
    // Each of 16 digits comes 2000 times on average, with a standard deviation of 43: six of them are 260.
    for (const int count : digits) EXPECT_NEAR(count, 2000, 260);
}

TEST(Audience, AThousandLostConnectionsDoNotKeepOthersFromResuming) {
    Audience audience({}, sceneFacts({}), 4, 2);
    const auto lost = audience.join(nullptr, {.owner = "token ann"}).viewer;
    audience.leave(lost, true);
    for (int i = 0; i < 3000; ++i) audience.leave(audience.join(nullptr, {.owner = "address 6"}).viewer, true);
    EXPECT_TRUE(audience.join(nullptr, {.owner = "token ann", .key = lost->key()}).viewer->resumed());
}

TEST(Audience, NeitherDoThoseOfManyAddresses) {
    Audience audience({}, sceneFacts({}), 4, 2);
    const auto lost = audience.join(nullptr, {.owner = "address 1"}).viewer;
    audience.leave(lost, true);
    for (int i = 0; i < 3000; ++i)
        audience.leave(audience.join(nullptr, {.owner = "address 6." + std::to_string(i % 40)}).viewer, true);
    EXPECT_TRUE(audience.join(nullptr, {.owner = "address 1", .key = lost->key()}).viewer->resumed());
}

// A pose that is resumed has the size that the new hello asked for.
TEST(Audience, WhoResumesGetsWhatItAsksForNow) {
    Audience audience({}, sceneFacts({}), 4, 2);
    const auto lost = audience.join(nullptr).viewer;
    PoseRequest large = firstPose();
    large.width = 1920, large.height = 1080, large.views = 2;
    large.pose.position.x = 7;
    lost->setPose(large);
    audience.leave(lost, true);
    const auto back = audience.join(nullptr, {.key = lost->key()}).viewer;
    PoseRequest granted;
    granted.width = 320, granted.height = 180, granted.quality = 50;
    back->grant(granted);
    const auto due = takeDue(*back);
    ASSERT_TRUE(due);
    EXPECT_EQ(due->request.width, 320);
    EXPECT_EQ(due->request.views, 1);
    EXPECT_EQ(due->request.quality, 50);
    EXPECT_EQ(due->request.pose.position.x, 7);
}

TEST(Audience, RevisionGrowsWithSettingsAndVisitorsNotWithTime) {
    Audience audience({}, sceneFacts({}), 2, 2);
    ASSERT_NE(audience.report(), nullptr);
    SceneReport report;
    audience.publish(std::make_shared<SceneReport>(report));
    uint64_t before = audience.revision();

    report.tick = 7, report.state_hash = 8, report.particles = 9;
    audience.publish(std::make_shared<SceneReport>(report));
    EXPECT_EQ(audience.revision(), before);
    EXPECT_EQ(audience.report()->tick, 7u);

    const auto grows = [&](auto&& change) {
        before = audience.revision();
        change();
        return audience.revision() > before;
    };
    EXPECT_TRUE(grows([&] { ++report.settings_version, audience.publish(std::make_shared<SceneReport>(report)); }));
    // A value that changes by itself, such as the direction of a turning light, is no news.
    EXPECT_FALSE(grows(
        [&] { report.settings[0] = glm::vec3(1, 0, 0), audience.publish(std::make_shared<SceneReport>(report)); }));
    std::shared_ptr<Viewer> viewer;
    EXPECT_TRUE(grows([&] { viewer = audience.join(nullptr).viewer; }));
    EXPECT_TRUE(grows([&] { audience.leave(viewer); }));
}

} // namespace
} // namespace brume
