// The file that a sweep's results are kept in: what a later run of some series replaces, and how it is written.
#include "tools/bench/results_file.h"

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tools/bench/stage.h"

namespace brume::bench {
namespace results_file_test {

using nlohmann::json;

json results(const std::string& device, const std::vector<std::pair<std::string, double>>& series) {
    json out = {{"device", device}, {"series", json::array()}};
    for (const auto& [name, ms] : series)
        out["series"].push_back({{"name", name}, {"rows", {{{"variant", "a"}, {"ms", ms}}, {{"variant", "b"}}}}});
    return out;
}

TEST(ResultsFile, SeriesOfALaterRunReplaceThoseOfTheirName) {
    const json both = merged(results("old", {{"x", 1}, {"y", 2}}), results("new", {{"z", 3}, {"x", 4}}));
    EXPECT_EQ(both, results("new", {{"x", 4}, {"y", 2}, {"z", 3}}));
}

TEST(ResultsFile, HasARowALineAndFiveDigits) {
    const json before = results("a", {{"x", 1.23456789}, {"y", 1234567.8}});
    const std::string text = textOf(before);
    EXPECT_NE(text.find("\n  {\"ms\":1.2346,\"variant\":\"a\"},\n  {\"variant\":\"b\"}\n]}"), text.npos) << text;
    EXPECT_EQ(json::parse(text), results("a", {{"x", 1.2346}, {"y", 1234600}}));
}

TEST(ResultsFile, WhatIsNoJsonIsSaid) { EXPECT_THROW(readResults("/nowhere/results.json"), std::runtime_error); }

// Of 9 values the true median lies outside of the 2nd to the 8th with 2 (1 + 9) / 512 = 3.9 %, outside of the 3rd to
// the 7th with 18 %. Of 5 it lies outside of all with 6.3 %.
TEST(IntervalOfMedian, HoldsNinetyPerCent) {
    EXPECT_EQ(intervalOfMedian(1), std::pair(size_t(0), size_t(0)));
    EXPECT_EQ(intervalOfMedian(5), std::pair(size_t(0), size_t(4)));
    EXPECT_EQ(intervalOfMedian(8), std::pair(size_t(1), size_t(6)));
    EXPECT_EQ(intervalOfMedian(9), std::pair(size_t(1), size_t(7)));
    EXPECT_EQ(intervalOfMedian(100), std::pair(size_t(41), size_t(58)));
}

} // namespace results_file_test
} // namespace brume::bench
