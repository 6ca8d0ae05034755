// The file of a device's costs: written, read, refused.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "server/plan/cost_model.h"

namespace brume {
namespace {

class CostFile : public testing::Test {
protected:
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("brume-costs-" + std::to_string(::getpid()));
    std::filesystem::path file = costFile(folder, "llvmpipe (LLVM 15)", "Mesa 22.3");
    void TearDown() override { std::filesystem::remove_all(folder); }

    void write(const std::string& text) {
        std::filesystem::create_directories(folder);
        std::ofstream(file) << text;
    }
    void expectRefused(const std::string& word) {
        std::string complaint;
        const CostModel model = loadCosts(file, complaint);
        EXPECT_EQ(model.ns, builtInCosts().ns);
        EXPECT_FALSE(model.calibrated);
        EXPECT_NE(complaint.find(word), complaint.npos) << complaint;
        EXPECT_NE(complaint.find(file.string()), complaint.npos) << complaint;
        EXPECT_EQ(complaint.find('\n'), complaint.npos);
    }
};

TEST_F(CostFile, WhatIsWrittenIsRead) {
    CostModel model = builtInCosts();
    for (size_t i = 0; i < allCosts().size(); ++i) model.ns[i] = 0.1 * double(i + 1);
    saveCosts(file, model, "llvmpipe (LLVM 15)", "Mesa 22.3");
    std::string complaint;
    const CostModel read = loadCosts(file, complaint);
    EXPECT_EQ(complaint, "");
    EXPECT_TRUE(read.calibrated);
    EXPECT_EQ(read.ns, model.ns);
    EXPECT_NE(read.source.find(file.string()), read.source.npos);
}

TEST_F(CostFile, WithoutOneTheBuiltInCostsHoldSilently) {
    std::string complaint;
    const CostModel model = loadCosts(file, complaint);
    EXPECT_EQ(complaint, "");
    EXPECT_FALSE(model.calibrated);
    EXPECT_NE(model.source.find("built in"), model.source.npos);
    for (const CostInfo* cost : allCosts()) EXPECT_GT(model[*cost], 0) << cost->key;
}

// Costs of an older server are learnt anew, without a word at every start.
TEST_F(CostFile, OfAnOlderVersionTheBuiltInCostsHoldSilently) {
    write("{ \"version\": 6, \"slabs\": 1 }");
    std::string complaint;
    EXPECT_EQ(loadCosts(file, complaint).ns, builtInCosts().ns);
    EXPECT_EQ(complaint, "");
}

TEST_F(CostFile, ABadOneIsRefusedInOneLine) {
    write("{ \"version\": 2, ");
    expectRefused("JSON");
    write("[]");
    expectRefused("JSON");
    write("{}");
    expectRefused("version");
    write("{ \"version\": 99 }");
    expectRefused("version");
    saveCosts(file, builtInCosts(), "", "");
    std::ifstream in(file);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::string key = "\"slabs\": ";
    const size_t at = text.find(key) + key.size(), end = text.find(',', at);
    for (const char* bad : {"-1", "0", "\"fast\"", "null"}) {
        write(std::string(text).replace(at, end - at, bad));
        expectRefused("slabs");
    }
}

TEST(CostFileName, SaysTheDeviceAndItsDriverInPlainLetters) {
    EXPECT_EQ(costFile("x", "a/b (c)", "1.2"), std::filesystem::path("x/costs-a-b--c--1-2.json"));
}

} // namespace
} // namespace brume
