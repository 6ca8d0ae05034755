// One cloud for all: every viewer has its own view of the same ticks, and what one does all see.
#include <gtest/gtest.h>
#include <turbojpeg.h>

#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test::shared_cloud_test {
namespace {

constexpr float kFovY = 0.8f;

Pose fromFront() { return lookAt({0, 2, 26}, {0, 0, 0}, kFovY); }
Pose fromSide() { return lookAt({24, 3, 0}, {0, 0, 0}, kFovY); }
Pose fromAbove() { return lookAt({3, 26, 3}, {0, 0, 0}, kFovY); }

// Frames of this watcher that show a tick from `from_tick` on.
const Seen* firstFrom(const Watcher& watcher, uint64_t from_tick) {
    for (const Seen& frame : watcher.frames)
        if (frame.tick >= from_tick) return &frame;
    return nullptr;
}

// Equal ticks must have equal state hashes, whoever was told. Returns how many ticks both know.
size_t expectEqualHashes(const Watcher& a, const Watcher& b) {
    size_t common = 0;
    for (const auto& [tick, hash] : a.hashes)
        if (const auto other = b.hashes.find(tick); other != b.hashes.end()) {
            ++common;
            EXPECT_EQ(hash, other->second) << "at tick " << tick;
        }
    return common;
}

class SharedCloud : public testing::Test {
protected:
    // Pictures of several moments are compared to the byte: however busy the machine is, one plan draws them.
    static void SetUpTestSuite() { server_ = new RunningServer({"--frame-budget", "10000", "--refine-moving", "0"}); }
    static void TearDownTestSuite() {
        delete server_;
        server_ = nullptr;
    }
    static client::Endpoint server() { return server_->endpoint(); }

private:
    static inline RunningServer* server_ = nullptr;
};

TEST_F(SharedCloud, ThreeViewersHaveTheirOwnViewOfTheSameTicks) {
    Watcher a(server()), b(server()), c(server());
    const std::vector<Watcher*> all{&a, &b, &c};
    const std::vector<Pose> poses{fromFront(), fromSide(), fromAbove()};
    for (size_t i = 0; i < all.size(); ++i) all[i]->look(poses[i]);

    constexpr size_t enough = 5;
    ASSERT_TRUE(watch(all,
                      [&] {
                          return commonTicks(a, b).size() >= enough && commonTicks(b, c).size() >= enough &&
                                 commonTicks(a, c).size() >= enough;
                      }))
        << "frames: " << a.frames.size() << ", " << b.frames.size() << ", " << c.frames.size();

    EXPECT_GE(expectEqualHashes(a, b), enough);
    EXPECT_GE(expectEqualHashes(b, c), enough);
    EXPECT_GE(expectEqualHashes(a, c), enough);

    std::vector<client::Picture> pictures;
    for (size_t i = 0; i < all.size(); ++i) {
        EXPECT_TRUE(all[i]->errors.empty()) << all[i]->errors.front().text;
        uint32_t id = 0;
        uint64_t tick = 0;
        for (const Seen& frame : all[i]->frames) {
            EXPECT_EQ(frame.position, poses[i].position);
            EXPECT_GT(frame.id, id);
            EXPECT_GT(frame.tick, tick);
            id = frame.id;
            tick = frame.tick;
            ASSERT_EQ(frame.jpegs.size(), 1u);
            ASSERT_EQ(frame.width, 320);
            ASSERT_EQ(frame.height, 180);
        }
        pictures.push_back(pictureOf(all[i]->last()));
        EXPECT_GT(contrast(pictures.back()), 8) << "nothing is to be seen by viewer " << i;
    }
    // By the shape of the cloud; pictures of one camera do not differ at all while nothing moves (see below).
    EXPECT_GT(difference(pictures[0], pictures[1]), 2);
    EXPECT_GT(difference(pictures[1], pictures[2]), 2);
    EXPECT_GT(difference(pictures[0], pictures[2]), 2);
}

TEST_F(SharedCloud, TwoEqualCamerasGetEqualBytes) {
    Watcher a(server()), b(server());
    const uint64_t still = setPaused(a, true, {&b});
    a.look(fromFront());
    b.look(fromFront());
    // Nothing moves: both come to rest with the same picture without loss, to the byte, and are sent no other.
    const auto rests = [&](const Watcher& watcher) { return !watcher.frames.empty() && watcher.last().quality == 100; };
    ASSERT_TRUE(watch({&a, &b}, [&] { return rests(a) && rests(b); }));
    EXPECT_EQ(a.last().jpegs, b.last().jpegs);
    EXPECT_EQ(a.last().state_hash, b.last().state_hash);
    EXPECT_GE(a.last().tick, still);
    const size_t sent = a.frames.size() + b.frames.size();
    watch(
        {&a, &b}, [] { return false; }, milliseconds(700));
    EXPECT_EQ(a.frames.size() + b.frames.size(), sent) << "what rests is sent once";

    // And while everything moves, at equal ticks.
    const uint64_t moving = setPaused(a, false, {&b});
    client::Impulse impulse{{0, 0, 26}, {0, 0, -1}, {3, 0, 0}, 1};
    a.session.sendImpulse(impulse);
    ASSERT_TRUE(watch({&a, &b}, [&] { return commonTicks(a, b, moving).size() >= 3; }));
    for (const auto& [x, y] : commonTicks(a, b, moving)) EXPECT_EQ(x->jpegs, y->jpegs) << "at tick " << x->tick;

    // Pictures that both see are drawn and encoded once.
    const auto pictures = metric(server().port, "brume_pictures_total");
    const auto frames = metric(server().port, "brume_frames_total{fate=\"rendered\"}");
    ASSERT_TRUE(pictures && frames);
    EXPECT_LE(*pictures + double(commonTicks(a, b, moving).size()), *frames);
}

TEST_F(SharedCloud, AnImpulseOfOneIsSeenByAll) {
    Watcher pusher(server()), a(server()), b(server());
    const std::vector<Watcher*> all{&pusher, &a, &b};
    pusher.look(fromFront());
    a.look(fromSide());
    b.look(fromAbove());
    const uint64_t before = setPaused(pusher, true, {&a, &b});
    ASSERT_TRUE(watch(all, [&] { return firstFrom(a, before) && firstFrom(b, before) && firstFrom(pusher, before); }));
    const Seen a_before = *firstFrom(a, before), b_before = *firstFrom(b, before);
    ASSERT_EQ(a_before.state_hash, b_before.state_hash);
    ASSERT_EQ(a_before.state_hash, firstFrom(pusher, before)->state_hash);

    // Time stands still, so that only the impulse can change the state: the particles get their speed.
    pusher.session.sendImpulse({{0, 0, 26}, {0, 0, -1}, {0, 0, 0}, 10});
    const auto pushed = [&](const Watcher& w) {
        return !w.frames.empty() && w.last().state_hash != a_before.state_hash;
    };
    ASSERT_TRUE(watch(all, [&] { return pushed(pusher) && pushed(a) && pushed(b); }));
    EXPECT_EQ(a.last().state_hash, b.last().state_hash);
    EXPECT_EQ(a.last().state_hash, pusher.last().state_hash);

    // Time goes on, and they move. A slow server shows few of its ticks, and particles come back: so more pushes
    // follow.
    const uint64_t resumed = setPaused(pusher, false, {&a, &b});
    size_t pushes = pusher.frames.size();
    const auto moved = [&](const Watcher& watcher, const Seen& since) {
        return watcher.last().tick > resumed + 10 && difference(pictureOf(since), pictureOf(watcher.last())) > 0.5;
    };
    ASSERT_TRUE(watch(all, [&] {
        for (; pushes < pusher.frames.size(); ++pushes)
            pusher.session.sendImpulse({{0, 0, 26}, {0, 0, -1}, {0, 0, 0}, 10});
        return moved(a, a_before) && moved(b, b_before);
    }));
    EXPECT_GE(expectEqualHashes(a, b), 3u);
    EXPECT_TRUE(pusher.errors.empty()) << pusher.errors.front().text;
}

TEST_F(SharedCloud, StereoIsTwoViewsOfOneTick) {
    client::Wishes both = kSmall;
    both.views = 2;
    Watcher stereo(server(), both), left(server()), right(server());
    const std::vector<Watcher*> all{&stereo, &left, &right};
    const uint64_t still = setPaused(stereo, true, {&left, &right});
    Pose head = lookAt({0, 1, 12}, {0, 0, 0}, kFovY);
    head.eye_separation = 0.5f; // far apart, so that the pictures clearly differ
    stereo.look(head);
    left.look(eyePose(head, 0, 2));
    right.look(eyePose(head, 1, 2));
    ASSERT_TRUE(
        watch(all, [&] { return firstFrom(stereo, still) && firstFrom(left, still) && firstFrom(right, still); }));

    const Seen& frame = *firstFrom(stereo, still);
    ASSERT_EQ(frame.jpegs.size(), 2u);
    EXPECT_GT(difference(pictureOf(frame, 0), pictureOf(frame, 1)), 0.5);
    // Each eye sees to the byte what a viewer with one eye sees from there.
    EXPECT_EQ(frame.jpegs[0], firstFrom(left, still)->jpegs[0]);
    EXPECT_EQ(frame.jpegs[1], firstFrom(right, still)->jpegs[0]);
    setPaused(stereo, false);
}

// Who asks gets layers, and who does not gets the same picture without.
TEST_F(SharedCloud, LayersComeToWhoAsksForThem) {
    Watcher layered(server()), plain(server());
    const std::vector<Watcher*> both{&layered, &plain};
    const uint64_t still = setPaused(layered, true, {&plain});
    ASSERT_TRUE(layered.session.sendPose(fromFront(), 0, 0, false, 3));
    plain.look(fromFront());
    const auto withLayers = [&] { return !layered.frames.empty() && layered.last().layers > 0; };
    ASSERT_TRUE(watch(both, [&] { return withLayers() && firstFrom(plain, still); }));
    const Seen& frame = layered.last();
    EXPECT_EQ(frame.layers, 3u);
    ASSERT_EQ(frame.layer_pictures.size(), 3u);
    EXPECT_EQ(pictureOf(frame, 0).width, frame.width) << "the picture comes as ever";
    for (const Seen& one : plain.frames) EXPECT_EQ(one.layers, 0u);
    int width = 0, height = 0, sampling = 0, colours = 0;
    const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
    const client::Bytes& data = frame.layer_pictures[1];
    ASSERT_EQ(tjDecompressHeader3(decoder.get(), data.data(), data.size(), &width, &height, &sampling, &colours), 0);
    EXPECT_EQ(uint32_t(height), 2 * 3 * frame.layer_rows) << "transmittance and depth of each layer";
    EXPECT_TRUE(frame.layer_pictures[2].empty()) << "the scene has nothing but sky";
    ASSERT_TRUE(layered.session.sendPose(fromFront()));
    const uint32_t asked = layered.last().pose_seq;
    setPaused(layered, false, {&plain});
    EXPECT_TRUE(watch(both, [&] { return layered.last().pose_seq != asked && layered.last().layers == 0; }))
        << "each pose says it anew";
    EXPECT_TRUE(layered.errors.empty());
}

TEST_F(SharedCloud, ANewSizeIsGrantedWhileWatching) {
    Watcher watcher(server());
    watcher.look(fromFront());
    ASSERT_TRUE(watch({&watcher}, [&] { return !watcher.frames.empty(); }));
    ASSERT_TRUE(watcher.session.sendPose(fromFront(), 200, 120));
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.last().width == 200; }));
    EXPECT_EQ(watcher.last().height, 120);
    EXPECT_GT(contrast(pictureOf(watcher.last())), 8);
}

TEST_F(SharedCloud, TheNewestPoseWins) {
    Watcher watcher(server());
    watcher.look(fromFront());
    uint32_t last = 0;
    for (int i = 0; i <= 20; ++i) {
        Pose pose = fromFront();
        pose.position.x = 0.1f * float(i);
        last = watcher.look(pose);
        watcher.poll(milliseconds(0));
    }
    ASSERT_TRUE(watch({&watcher}, [&] { return !watcher.frames.empty() && watcher.last().pose_seq == last; }));
    EXPECT_FLOAT_EQ(watcher.last().position.x, 2.0f);
    uint32_t seq = 0;
    for (const Seen& frame : watcher.frames) {
        EXPECT_GE(frame.pose_seq, seq);
        seq = frame.pose_seq;
    }
}

// A viewer that is behind is waited for; it holds up nobody else.
TEST_F(SharedCloud, AHiddenWindowGetsNoFramesAndTheOthersGoOn) {
    Watcher hidden(server()), other(server());
    const std::vector<Watcher*> all{&hidden, &other};
    const auto others = [&](size_t frames) { return watch(all, [&] { return other.frames.size() >= frames; }); };
    hidden.look(fromFront());
    other.look(fromSide());
    ASSERT_TRUE(watch(all, [&] { return hidden.frames.size() >= 3; }));
    ASSERT_TRUE(hidden.session.sendPose(fromFront(), 0, 0, true));
    ASSERT_TRUE(others(other.frames.size() + 10)); // those that were on their way have come
    const size_t before = hidden.frames.size();
    ASSERT_TRUE(others(other.frames.size() + 30));
    EXPECT_EQ(hidden.frames.size(), before);
    const uint32_t pose = hidden.look(fromFront());
    EXPECT_TRUE(watch(all, [&] { return hidden.last().pose_seq == pose; }));
}

TEST_F(SharedCloud, AViewerThatDoesNotAcknowledgeIsNotRenderedFor) {
    Watcher lazy(server()), keen(server());
    lazy.acknowledging = false;
    lazy.look(fromFront());
    keen.look(fromSide());
    const size_t window = lazy.session.granted().max_in_flight; // at most; what it gets follows its link
    ASSERT_GE(window, 1u);
    ASSERT_TRUE(watch({&lazy, &keen}, [&] { return !lazy.frames.empty() && keen.frames.size() >= 2 * window + 4; }));
    EXPECT_LE(lazy.frames.size(), window);

    lazy.acknowledging = true;
    lazy.session.acknowledge(lazy.last().id);
    ASSERT_TRUE(watch({&lazy, &keen}, [&] { return lazy.frames.size() >= 3 * window; }));
    EXPECT_GT(lazy.last().tick, lazy.frames.front().tick);
}

} // namespace
} // namespace brume::test::shared_cloud_test
