// Fixture with a device that counts; the validation layer has nothing to say.
#pragma once

#include <filesystem>
#include <memory>

#include <gtest/gtest.h>

#include "tools/bench/stage.h"

namespace brume::bench {

class OnDevice : public testing::Test {
protected:
    static void SetUpTestSuite() {
        gpu::DeviceOptions options;
        options.validation = true;
        options.statistics = true;
        made = std::make_unique<gpu::Device>(options);
    }
    static void TearDownTestSuite() { made.reset(); }
    void TearDown() override { EXPECT_EQ(device().validationMessages(), 0u); }
    static const gpu::Device& device() { return *made; }

private:
    static inline std::unique_ptr<gpu::Device> made;
};

// An empty folder of this test.
inline std::filesystem::path folder(const char* name) {
    std::filesystem::path made = std::filesystem::path(testing::TempDir()) / "brume-bench-test" / name;
    std::filesystem::remove_all(made);
    std::filesystem::create_directories(made);
    return made;
}

inline Case smallCloud() {
    Case wanted;
    wanted.set = {"medium.count=40", "sky.zenith=[0,0,0]", "sky.horizon=[0,0,0]", "render.shadow_size=64"};
    wanted.size = {48, 27};
    return wanted;
}

} // namespace brume::bench
