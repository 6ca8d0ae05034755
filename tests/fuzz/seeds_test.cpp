// Every target over the seeds that its fuzzing starts from, whole, cut short, and with single bits flipped: what
// compilers without libFuzzer can do. A broken promise ends the program.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fuzz/targets.h"

namespace brume::fuzz {
namespace {

namespace fs = std::filesystem;
using Seed = std::vector<uint8_t>;

std::vector<Seed> seedsOf(const std::string& target) {
    std::vector<fs::path> files, folders{fs::path(BRUME_FUZZ_SEEDS) / target};
    if (target == "message") folders = {"protocol/examples"};
    if (target == "scene") folders.emplace_back("server/scenes");
    for (const fs::path& folder : folders)
        for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<Seed> seeds;
    for (const fs::path& file : files) {
        std::ifstream in(file, std::ios::binary);
        seeds.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
    return seeds;
}

class FuzzSeeds : public testing::TestWithParam<Target> {};

TEST_P(FuzzSeeds, KeepEveryPromise) {
    const Target& target = GetParam();
    const std::vector<Seed> seeds = seedsOf(target.name);
    ASSERT_GE(seeds.size(), 3u);
    target.run({});
    for (const Seed& seed : seeds) {
        target.run(seed);
        const size_t step = seed.size() / 64 + 1; // some 64 lengths and 64 bits of each
        for (size_t at = 0; at < seed.size(); at += step) {
            target.run(Bytes(seed).first(at));
            Seed flipped = seed;
            flipped[at] ^= uint8_t(1u << (at % 8));
            target.run(flipped);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Targets, FuzzSeeds, testing::ValuesIn(kTargets),
                         [](const auto& target) { return target.param.name; });

} // namespace
} // namespace brume::fuzz
