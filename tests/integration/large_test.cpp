// A million particles through the real server, and scenes that are refused for their size.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

// In so small a picture from so far that they merge: what is tested is that all of them load, move and are lit, not how
// fast.
const std::vector<std::string> kMillion{"--scene",        "cloud-65535",
                                        "--set",          "medium.count=1000000",
                                        "--set",          "medium.scale=[0.4,0.8]",
                                        "--set",          "medium.extinction=20",
                                        "--set",          "camera.position=[0,5,100]",
                                        "--set",          "render.shadow_size=32",
                                        "--set",          "render.shadow_slices=16",
                                        "--frame-budget", "10000"};

TEST(Large, AMillionParticlesAreServedAndTheirMemoryIsReported) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer server(kMillion);
    Watcher watcher(server.endpoint(), {.width = 160, .height = 90, .views = 1, .quality = 80});
    watcher.look(lookAt({0, 5, 100}, {0, 0, 0}, 0.3f));
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() >= 2; }));
    const client::Picture picture = pictureOf(watcher.last());
    EXPECT_EQ(picture.width, 160);
    EXPECT_GT(contrast(picture), 5);
    EXPECT_GT(watcher.frames.back().tick, watcher.frames.front().tick);

    EXPECT_EQ(metric(server.port(), "brume_particles"), 1e6);
    const auto particles = metric(server.port(), "brume_particle_memory_bytes");
    const auto device = metric(server.port(), "brume_device_memory_bytes");
    const auto peak = metric(server.port(), "brume_device_memory_peak_bytes");
    ASSERT_TRUE(particles && device && peak);
    EXPECT_GT(*particles, 1e6 * (2 * 48 + 32)); // columns twice, and a list
    EXPECT_GT(*device, 1e6 * (32 + 28));        // the list, and as the light sees it
    EXPECT_LT(*particles + *device, 1.2e9);     // what may be of particles, and what does not grow with them
    EXPECT_GE(*peak, *device);
}

TEST(Large, ARefusedSceneIsToldTheCountThatFits) {
    const std::vector<std::string> small{"--port", "0", "--scene", "cloud-65535", "--memory", "16"};
    const auto refused = startServer(small);
    ASSERT_EQ(refused->exitCode(), 1) << refused->out();
    const std::string err = refused->err();
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    const std::string before = "use at most ";
    const size_t at = err.find(before);
    ASSERT_NE(at, err.npos) << err;
    const int fits = std::stoi(err.substr(at + before.size()));
    for (const int count : {fits, fits + 1}) {
        std::vector<std::string> wanted = small;
        wanted.insert(wanted.end(), {"--set", "medium.count=" + std::to_string(count)});
        if (count == fits)
            EXPECT_NO_THROW(RunningServer{wanted});
        else
            EXPECT_EQ(startServer(wanted)->exitCode(), 1);
    }
}

} // namespace
} // namespace brume::test
