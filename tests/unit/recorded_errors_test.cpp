// Which measured errors go into a recording, and which are refused when it is read.
#include "server/operate/recorded_errors.h"

#include <cmath>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>
#include <unistd.h>

#include "server/operate/recording.h"

namespace brume {
namespace {

ViewError viewError(uint32_t viewer, double rmse, size_t pixels = 100) {
    return {viewer, "slabs", {.pixels = pixels, .rmse = rmse, .low = rmse / 2, .high = rmse * 2}, {}};
}

TEST(RecordedErrors, OnlyWhatIsKnownAndHasChangedIsTaken) {
    RecordedErrors errors;
    errors.set(std::vector{viewError(1, 0.01), viewError(2, 0.02), viewError(3, 0.03, 99), viewError(4, HUGE_VAL)});
    EXPECT_EQ(errors.take().size(), 2u);
    errors.set(std::vector{viewError(1, 0.01), viewError(2, 0.021)});
    const std::vector<RecordedError> changed = errors.take();
    ASSERT_EQ(changed.size(), 1u);
    EXPECT_EQ(changed[0].viewer, 2u);
    EXPECT_EQ(changed[0].error.rmse, 0.021);
    EXPECT_TRUE(errors.take().empty());
    errors.set({});
    errors.set(std::vector{viewError(1, 0.01)});
    EXPECT_EQ(errors.take().size(), 1u) << "who left and came is new";
    errors.set({});
    EXPECT_TRUE(errors.take().empty());
}

TEST(RecordedErrors, TakeTurnsWhereTheyAreMany) {
    RecordedErrors errors;
    std::vector<ViewError> all;
    constexpr uint32_t kViewers = 40;
    for (uint32_t viewer = 0; viewer < kViewers; ++viewer) all.push_back(viewError(viewer, 0.01));
    std::set<uint32_t> taken;
    for (size_t second = 0; second * RecordedErrors::kMost < kViewers; ++second) {
        for (ViewError& one : all) one.error.rmse += 0.001;
        errors.set(all);
        const std::vector<RecordedError> some = errors.take();
        EXPECT_EQ(some.size(), RecordedErrors::kMost);
        for (const RecordedError& one : some) taken.insert(one.viewer);
    }
    EXPECT_EQ(taken.size(), kViewers);
}

TEST(RecordedErrors, ThatCannotBeAreRefused) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("brume-recorded-errors-" + std::to_string(getpid()));
    {
        RecordingWriter out(file, {"one", "/nowhere/one.toml", "", {}, "test"});
        EXPECT_TRUE(out.write({0, 1, {}, {}, {}, {{1, "slabs", {.pixels = 100, .rmse = -0.1}}}}));
    }
    RecordingReader in(file);
    try {
        in.next();
        FAIL();
    } catch (const RecordingError& e) {
        EXPECT_NE(std::string(e.what()).find(":3: not a record: an error's rmse"), std::string::npos) << e.what();
    }
    std::filesystem::remove(file);
}

} // namespace
} // namespace brume
