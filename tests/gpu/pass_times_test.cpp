// A pass has the time that its own commands take, whatever was recorded before it.
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/cores.h"
#include "server/gpu/commands.h"
#include "tests/gpu/fixture.h"

namespace brume::test::pass_times_test {
namespace {

using namespace gpu;

// A CPU driver stamps in the tiles of the targets that were last drawn into, and looks at them only when it must.
TEST_F(GpuTest, PassesAfterADrawHaveTheirOwnTimes) {
    constexpr VkDeviceSize kLong = 64 << 20, kShort = 4; // bytes
    const Buffer buffer(device(), kLong, VK_BUFFER_USAGE_TRANSFER_DST_BIT, Memory::device, "filled");
    const Image target(device(), {VK_FORMAT_R32G32B32A32_SFLOAT, {256, 256}, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT},
                       "target");
    Commands commands(device(), "pass times");
    constexpr size_t kSubmissions = 9;
    std::array<std::array<float, kSubmissions>, 6> times{};                 // ms, of each pass
    for (size_t submission = 0; submission <= kSubmissions; ++submission) { // all but the first begin after a draw
        const VkCommandBuffer cmd = commands.begin();
        const auto fill = [&](const char* name, VkDeviceSize bytes, int often) {
            const Commands::Pass pass(commands, name);
            for (int i = 0; i < often; ++i) {
                vkCmdFillBuffer(cmd, buffer.handle(), 0, bytes, 0);
                everythingBefore(cmd);
            }
        };
        // Where other programs run, a thread may wait for some ms: long passes take longer than that.
        fill("long before", kLong, 4);
        {
            const Commands::Pass pass(commands, "draw");
            toGeneral(cmd, target);
            beginDrawing(cmd, {256, 256}, {&target});
            vkCmdEndRendering(cmd);
        }
        fill("short", kShort, 1);
        fill("longest", kLong, 16);
        fill("short again", kShort, 1);
        fill("long", kLong, 4);
        commands.submit();
        waitFor(commands);
        const auto passes = commands.readTimes();
        ASSERT_EQ(passes.size(), times.size());
        if (submission == 0) continue;
        for (size_t i = 0; i < times.size(); ++i) times[i][submission - 1] = passes[i].ms;
    }
    std::array<float, 6> median{}; // other programs disturb single ones
    for (size_t i = 0; i < times.size(); ++i) {
        std::ranges::nth_element(times[i], times[i].begin() + kSubmissions / 2);
        median[i] = times[i][kSubmissions / 2];
    }
    const auto [before, draw, first, longest, second, last] = median;
    EXPECT_GT(before, draw);
    EXPECT_GT(longest, 2 * first);
    EXPECT_GT(longest, 2 * second);
    EXPECT_GT(longest, last);
    EXPECT_GT(last, second);
}

// Each thread gets one run of a dispatch's workgroups, so more threads than cores even out how hard these are.
TEST_F(GpuTest, TheCpuDriverHasSeveralThreadsACore) {
    if (device().name().find("llvmpipe") == std::string::npos) GTEST_SKIP() << "only Mesa's CPU driver takes a number";
    const unsigned cores = usableCores();
    if (cores >= 16) GTEST_SKIP() << "as many as older versions of the driver have";
    unsigned threads = 0;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
        std::string name;
        std::getline(std::ifstream(task.path() / "comm"), name);
        if (name.starts_with("llvmpipe-")) ++threads;
    }
    EXPECT_GT(threads, cores);
}

} // namespace
} // namespace brume::test::pass_times_test
