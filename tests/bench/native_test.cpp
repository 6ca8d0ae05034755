// The native slabs draw what the method `slabs` draws.
#include <gtest/gtest.h>

#include "common/metrics.h"
#include "tools/bench/native/compare.h"

namespace brume::bench {
namespace {

struct View {
    const char *scene, *camera;
    uint32_t rate, slabs;
};

class NativeSlabsTest : public testing::TestWithParam<const native::Kernel*> {};

TEST_P(NativeSlabsTest, PictureIsThatOfSlabs) {
    if (!NativeSlabs::runs(*GetParam())) GTEST_SKIP() << "this CPU does not have " << GetParam()->name;
    const gpu::Device device(gpu::DeviceOptions{});
    constexpr glm::uvec2 kSize{156, 90}; // no whole number of vectors or tiles
    for (const View& view :
         {View{"cloud", "outside", 4, 32}, View{"cloud", "inside", 8, 24}, View{"cloud-5000", "outside", 2, 64},
          View{"cloud", "outside", 1, 16}, View{"cloud-5000", "inside", 16, 200}}) {
        Case wanted{.scene = view.scene, .set = {"sky.zenith=[0,0,0]", "sky.horizon=[0,0,0]", "render.method=slabs"}};
        wanted.camera = view.camera;
        wanted.size = kSize;
        wanted.set.push_back("render.rate=" + std::to_string(view.rate));
        wanted.set.push_back("render.slabs=" + std::to_string(view.slabs));
        Stage stage(device, wanted);
        NativeSlabs native(stage, kSize, view.rate, view.slabs, *GetParam(), 2);
        const RadianceImage slabs = stage.picture(stage.pose(), kSize);
        for (int again = 0; again < 2; ++again) { // nothing of the picture before is left
            native.render();
            const Errors errors = compare(native.picture(), slabs, {}, mediumMask(slabs));
            EXPECT_LT(errors.relative_rmse, kNativeAgrees)
                << view.scene << ' ' << view.camera << ": " << describe(errors);
            EXPECT_LT(errors.worst.error, 0.02) << view.scene << ' ' << view.camera << ": " << describe(errors);
        }
        EXPECT_GT(native.samples(), 0u);
    }
}

std::vector<const native::Kernel*> kernels() {
#if defined(__x86_64__)
    return {&native::kPortable, &native::kAvx2, &native::kAvx512};
#else
    return {&native::kPortable};
#endif
}
INSTANTIATE_TEST_SUITE_P(Kernels, NativeSlabsTest, testing::ValuesIn(kernels()), [](const auto& instance) {
    std::string name = instance.param->name;
    std::erase(name, '-');
    return name;
});

TEST(NativeSlabs, RefusesWhatItLeavesOut) {
    const gpu::Device device(gpu::DeviceOptions{});
    Stage stage(device, {.scene = "props", .set = {"render.method=slabs"}, .camera = "outside", .size = {64, 36}});
    EXPECT_THROW(NativeSlabs(stage, {64, 36}, 8, 16, native::kPortable, 1), std::runtime_error);
}

} // namespace
} // namespace brume::bench
