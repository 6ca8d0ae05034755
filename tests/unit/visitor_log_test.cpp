// What visitors can make the log say: all of it, until it is a flood.
#include <gtest/gtest.h>

#include "server/net/visitor_log.h"
#include "tests/net/log_capture.h"

namespace brume::net {
namespace {

using namespace std::chrono_literals;

struct VisitorLogTest : testing::Test {
    const test::LogCapture captured;
    VisitorLog log;
    TokenBucket::Time::time_point now{1000s};

    void write(const std::string& network, int lines, const std::string& line = "refused") {
        for (int i = 0; i < lines; ++i) log.write(spdlog::level::info, network, line, now);
    }
    int count(const std::string& text) const {
        const std::string all = captured.atLeast(spdlog::level::debug);
        int found = 0;
        for (size_t at = all.find(text); at != all.npos; at = all.find(text, at + 1)) ++found;
        return found;
    }
};

TEST_F(VisitorLogTest, AFloodOfOneAddressIsCountedAndNobodyElsesLineIsLost) {
    write("a", 5000);
    EXPECT_EQ(count("refused"), 100);
    write("b", 1, "somebody else");
    EXPECT_EQ(count("somebody else"), 1);
    now += 1s;
    write("a", 10);
    EXPECT_EQ(count("refused"), 101);
    EXPECT_EQ(count("... and 4900 more lines of a"), 1);
    now += 1s;
    write("a", 1);
    EXPECT_EQ(count("... and 9 more lines of a"), 1);
}

TEST_F(VisitorLogTest, AFloodFromEverywhereIsBoundedToo) {
    for (int i = 0; i < 200'000; ++i) write(std::to_string(i), 1);
    EXPECT_LE(count("refused"), 2000) << "at once";
}

TEST_F(VisitorLogTest, WhatWasLeftOutIsSaidAtTheEnd) {
    {
        VisitorLog other;
        for (int i = 0; i < 103; ++i) other.write(spdlog::level::info, "a", "refused", now);
        EXPECT_EQ(count("more lines"), 0);
    }
    EXPECT_EQ(count("... and 3 more lines of a"), 1);
}

TEST_F(VisitorLogTest, TextOfVisitorsIsNoFormat) {
    write("a", 1, "{} {0:d}");
    EXPECT_EQ(count("{} {0:d}"), 1);
}

} // namespace
} // namespace brume::net
