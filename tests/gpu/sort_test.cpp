// The GPU's far-to-near order is std::stable_sort's, whatever the depths are.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "server/methods/proxies/sort.h"
#include "shaders/shared/sort_key.h"
#include "tests/gpu/fixture.h"

namespace brume::test::sort_test {
namespace {

struct Pairs {
    std::vector<uint32_t> keys, values;
};

Pairs sortOnDevice(const gpu::Device& device, const std::vector<uint32_t>& keys) {
    const uint32_t count = uint32_t(keys.size());
    const VkDeviceSize bytes = std::max<VkDeviceSize>(count, 1) * 4;
    const auto shared = [&](const char* name) {
        return gpu::Buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::readback, name);
    };
    const gpu::Buffer key_buffer = shared("keys"), value_buffer = shared("values");
    std::copy(keys.begin(), keys.end(), key_buffer.mapped<uint32_t>(count).begin());
    const auto values = value_buffer.mapped<uint32_t>(count);
    std::iota(values.begin(), values.end(), 0u);
    key_buffer.flush();
    value_buffer.flush();

    const RadixSort sort(device, count);
    gpu::Commands commands(device, "sort");
    commands.begin();
    sort.record(commands, key_buffer, value_buffer, count);
    commands.submit();
    waitFor(commands);
    key_buffer.invalidate();
    value_buffer.invalidate();
    const auto sorted = key_buffer.mapped<uint32_t>(count);
    return {{sorted.begin(), sorted.end()}, {values.begin(), values.end()}};
}

// Far to near, equal depths in their old order, NaN left out.
std::vector<uint32_t> expectedOrder(const std::vector<float>& depths) {
    std::vector<uint32_t> order;
    for (uint32_t i = 0; i < depths.size(); ++i)
        if (!std::isnan(depths[i])) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return depths[a] > depths[b]; });
    return order;
}

class SortTest : public GpuTest {
protected:
    void expectSorted(const std::vector<float>& depths) {
        std::vector<uint32_t> keys;
        for (const float depth : depths) keys.push_back(gpu::sortKeyFarToNear(depth));
        const Pairs sorted = sortOnDevice(device(), keys);
        const std::vector<uint32_t> expected = expectedOrder(depths);
        ASSERT_EQ(std::vector<uint32_t>(sorted.values.begin(), sorted.values.begin() + std::ptrdiff_t(expected.size())),
                  expected);
        for (size_t i = expected.size(); i < keys.size(); ++i)
            EXPECT_EQ(sorted.keys[i], gpu::kDropped) << i; // the NaN come last
    }
};

std::vector<float> randomDepths(size_t count) {
    std::mt19937 random(7);
    std::vector<float> depths(count);
    for (float& depth : depths) depth = std::ldexp(float(int32_t(random())), int(random() % 60) - 40);
    return depths;
}

TEST_F(SortTest, Counts) {
    for (const size_t count : {0u, 1u, 2u, 1023u, 1024u, 1025u, 65535u, 65536u, 65537u}) {
        SCOPED_TRACE(count);
        expectSorted(randomDepths(count));
    }
}

TEST_F(SortTest, EqualDepthsKeepTheirOrder) {
    expectSorted(std::vector<float>(5000, 3.5f));
    std::vector<float> few = randomDepths(20000);
    for (float& depth : few) depth = std::floor(std::fmod(std::abs(depth), 7.0f));
    expectSorted(few);
}

TEST_F(SortTest, ZerosInfinitiesAndNaN) {
    constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kTiny = std::numeric_limits<float>::denorm_min(), kHuge = std::numeric_limits<float>::max();
    expectSorted({0.0f, -0.0f, kNan, kInf, -kInf, 1.0f, -kNan, -1.0f, kTiny, -kTiny, kHuge, -kHuge, -0.0f, 0.0f, kInf,
                  -kInf, kNan});
    EXPECT_EQ(gpu::sortKeyFarToNear(0.0f), gpu::sortKeyFarToNear(-0.0f));
    EXPECT_NE(gpu::sortKeyFarToNear(-kInf), gpu::kDropped);
}

TEST_F(SortTest, RefusesWhatDoesNotFit) {
    const RadixSort sort(device(), 100);
    const gpu::Buffer small(device(), 64, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "small");
    const gpu::Buffer large(device(), 4096, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "large");
    gpu::Commands commands(device(), "too small");
    EXPECT_THROW(sort.record(commands, small, small, 100), gpu::Error); // the buffers
    EXPECT_THROW(sort.record(commands, large, large, 101), gpu::Error); // the capacity
}

} // namespace
} // namespace brume::test::sort_test
