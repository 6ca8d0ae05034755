// Frames that are no message: control frames are told of, fragments show by their bytes.
#include <gtest/gtest.h>

#include "server/net/mere_frames.h"

namespace brume::net {
namespace {

constexpr uint64_t kMessage = 64 << 10, kReadAhead = 8 << 10;

TEST(MereFrames, MessagesAreNone) {
    MereFrames mere(kMessage, 500);
    uint64_t received = 500;
    for (const uint64_t size : {0, 1, 125, 126, 65535, 65536, 40})
        for (int i = 0; i < 1000; ++i) {
            received += size + (size > 65535 ? 14 : size > 125 ? 8 : 6);
            mere.message(size);
            ASSERT_EQ(mere.take(received + kReadAhead), 0u) << size;
        }
    EXPECT_EQ(mere.take(received + kMessage + 14), 0u) << "one is being read";
}

TEST(MereFrames, ControlFramesAreCounted) {
    MereFrames mere(kMessage, 0);
    uint64_t received = 0;
    for (int i = 0; i < 100'000; ++i) {
        mere.control(uint64_t(i % 126));
        received += uint64_t(6 + i % 126);
    }
    EXPECT_EQ(mere.take(received), 100'000u);
    EXPECT_EQ(mere.take(received), 0u) << "once";
}

TEST(MereFrames, FragmentsAreCountedByTheirBytes) {
    MereFrames mere(kMessage, 0);
    const uint64_t empty = 100'000, allowed = kMessage + 14 + kReadAhead;
    uint64_t counted = 0;
    for (uint64_t i = 1; i <= empty; ++i) counted += mere.take(6 * i);
    EXPECT_EQ(counted, empty - (allowed + 5) / 6);
    mere.message(3);
    EXPECT_LE(mere.take(6 * empty + 9), 1u) << "what is counted is not counted again";
}

} // namespace
} // namespace brume::net
