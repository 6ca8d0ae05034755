// brume-bench promise: what a row says is the error of docs/conventions.md, runs go on, the page counts right.
#include "tools/bench/promise.h"

#include <fstream>

#include "tests/bench/on_device.h"
#include "tools/bench/error.h"
#include "tools/bench/promise_page.h"
#include "tools/bench/truth.h"

namespace brume::bench {
namespace {

using nlohmann::json;

class Promise : public OnDevice {};

PromiseQuestion question(const std::filesystem::path& where) {
    PromiseQuestion asked;
    asked.seed = 2, asked.scenes = 1; // one particle from far, 311x174
    asked.pixels = 100'000, asked.seconds = 100;
    asked.folder = where;
    return asked;
}

TEST_F(Promise, ARowHasTheErrorOfTheWholePictureAndItsSceneCanBeOpened) {
    const PromiseQuestion asked = question(folder("promise-row"));
    const json row = promiseRow(device(), builtInCosts(), asked, 2);
    ASSERT_TRUE(row.contains("measured")) << row;
    EXPECT_EQ(row["half"], "train");

    Case again{.scene = asked.folder / "random-2.toml", .set = {std::begin(kMediumAlone), std::end(kMediumAlone)}};
    again.size = {row["width"].get<uint32_t>(), row["height"].get<uint32_t>()};
    Stage stage(device(), again);
    EXPECT_EQ(wayText(stage.plan().chosen.settings), row["way"].get<std::string>());
    Truth truth(folder("promise-truth"));
    const MediumError error =
        mediumError(stage.picture(stage.pose(), again.size), truth.of(stage, stage.pose(), again.size), {});
    EXPECT_NEAR(row["measured"].get<double>(), error.medium.relative_rmse, 1e-4 * error.medium.relative_rmse);
    EXPECT_NEAR(row["bias"].get<double>(), error.medium.bias, 1e-4 * std::abs(error.medium.bias));
    EXPECT_EQ(row["pixels"], error.medium.pixels);
}

TEST_F(Promise, ASampleIsWithinItsStandardErrorsOfTheWhole) {
    PromiseQuestion asked = question(folder("promise-sample"));
    const json whole = promiseRow(device(), builtInCosts(), asked, 2);
    asked.pixels = 120;
    const json part = promiseRow(device(), builtInCosts(), asked, 2);
    EXPECT_LE(part["traced"], 120);
    EXPECT_GT(part["standard_error"], whole["standard_error"]);
    EXPECT_NEAR(part["measured"].get<double>(), whole["measured"].get<double>(),
                4 * part["standard_error"].get<double>());
}

TEST_F(Promise, FinerPartsLeaveLessAndThePriceIsOfAWayThatHolds) {
    PromiseQuestion asked = question(folder("promise-parts"));
    asked.pixels = 300, asked.parts = asked.price = asked.whole = true;
    const json row = promiseRow(device(), builtInCosts(), asked, 2);
    const json& all = row.at("parts").at("all");
    EXPECT_LT(all["left"], row["measured"]);
    EXPECT_GT(all["change"], 0);
    EXPECT_GT(row.at("cheapest_ms"), 0);
    EXPECT_GT(row.at("flip"), 0);
    EXPECT_LT(row.at("flip"), 0.01);
    EXPECT_LT(row.at("finest"), row["measured"]);
}

TEST_F(Promise, ASceneThatFailsIsARowThatSaysWhy) {
    PromiseQuestion asked = question(folder("promise-fails"));
    asked.budget = 2; // no scene allows it
    const json row = promiseRow(device(), builtInCosts(), asked, 2);
    EXPECT_FALSE(row.contains("measured"));
    EXPECT_NE(row.at("why_not").get<std::string>().find("render.error"), std::string::npos) << row;
}

TEST_F(Promise, ARunGoesOnWhereRowsEnd) {
    const std::filesystem::path where = folder("promise-rows"), file = where / "rows.jsonl";
    PromiseQuestion asked = question(where);
    asked.pixels = 60;
    std::ofstream(file) << R"({"seed":2,"budget":0.005,"why_not":"kept"})" << '\n';
    asked.scenes = 2, asked.seed = 1;
    const std::vector<json> rows = measureRows(device(), builtInCosts(), asked, file);
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_TRUE(rows[0].contains("measured"));
    EXPECT_EQ(rows[1]["why_not"], "kept");
    EXPECT_EQ(measureRows(device(), builtInCosts(), asked, file), rows);
    EXPECT_EQ(readRows(file, 0.005).size(), 2u);
}

TEST(PromiseRows, WhatIsNoRowIsRefusedWithItsLine) {
    const std::filesystem::path file = folder("promise-wrong") / "rows.jsonl";
    EXPECT_TRUE(readRows(file, 0.005).empty());
    for (const char* wrong : {"no json", R"({"seed":-1,"budget":0.005})", R"({"seed":1,"budget":0.01})", "[]"}) {
        std::ofstream(file) << R"({"seed":1,"budget":0.005})" << '\n' << wrong << '\n';
        try {
            readRows(file, 0.005);
            FAIL() << wrong;
        } catch (const std::runtime_error& e) {
            EXPECT_NE(std::string(e.what()).find("rows.jsonl:2: "), std::string::npos) << e.what();
        }
    }
}

TEST(PromiseRows, ThoseOfAnotherKindOfScenesAreRefused) {
    const std::filesystem::path file = folder("promise-kinds") / "rows.jsonl";
    std::ofstream(file) << R"({"seed":1,"budget":0.005,"kind":"lit"})" << '\n';
    EXPECT_EQ(readRows(file, 0.005, RandomKind::lit).size(), 1u);
    EXPECT_THROW(readRows(file, 0.005), std::runtime_error);
    std::ofstream(file) << R"({"seed":1,"budget":0.005})" << '\n'; // rows without a kind are of the first one
    EXPECT_EQ(readRows(file, 0.005).size(), 1u);
    EXPECT_THROW(readRows(file, 0.005, RandomKind::lit), std::runtime_error);
}

json row(uint64_t seed, const char* layout, double predicted, double measured) {
    return {{"seed", seed},
            {"half", seed % 2 ? "judge" : "train"},
            {"layout", layout},
            {"camera", "far"},
            {"count", 3},
            {"depth", 2.0},
            {"method", "slabs"},
            {"way", "slabs, some"},
            {"objects", 0},
            {"promised", true},
            {"predicted", predicted},
            {"measured", measured},
            {"width", 160},
            {"height", 90},
            {"standard_error", 1e-4},
            {"bias", 0.01},
            {"budget", 0.005},
            {"ms", 4.0}};
}

TEST(PromisePage, CountsWhatHolds) {
    std::vector<json> rows{row(1, "ball", 0.004, 0.002), row(2, "ball", 0.004, 0.006), row(3, "sheet", 0.005, 0.02),
                           row(4, "sheet", 0.005, 0.005)};
    rows[0]["cheapest_ms"] = 2.0;
    rows[0]["flip"] = 0.02, rows[0]["predicted_flip"] = 0.005, rows[0]["finest"] = 0.001;
    rows[1]["flip"] = 0.01, rows[1]["predicted_flip"] = 0.01, rows[1]["finest"] = 0.002;
    rows.push_back({{"seed", 5}, {"budget", 0.005}, {"why_not", "sees nothing"}});
    const std::string page = promisePage(rows, 0.005, 0.01);
    for (const char* line :
         {"Not measured: 1 of 5 scenes", "- seed 5: sees nothing", "| all | 4 | 50 % | 75 % | 1.00 | 0.5 % | 2 % |",
          "| ball | 2 | 50 % | 100 % | 0.50 | 0.2 % | 0.6 % |", "| sheet | 2 | 50 % | 50 % | 1.00 | 0.5 % | 2 % |",
          "| below 4 | 4 | 50 % |", "| 1 to 10 | 4 | 50 % |", "| judge | 2 | 50 % |", "median 2.00 of 1 scenes",
          "1 of 2 are within 0.01. Of 2 that the plan predicts within, 1 are. Measured over predicted: median"})
        EXPECT_NE(page.find(line), page.npos) << line << '\n' << page;
    EXPECT_LT(page.find("| 3 | sheet, 3 particles"), page.find("| 2 | ball, 3 particles")); // the worst first
    EXPECT_EQ(page.find("points and spots"), page.npos);
    for (size_t i = 0; i < 4; ++i) rows[i]["kind"] = "lit", rows[i]["fogs"] = i / 2, rows[i]["local_lights"] = 3;
    rows[0]["promised"] = false;
    const std::string lit = promisePage(rows, 0.005, 0.01);
    for (const char* line :
         {"| fogs | scenes |", "| 1 | 2 | 50 % | 50 % | 1.00 | 0.5 % | 2 % |", "| points and spots | scenes |",
          "| 3 | 4 | 50 % | 75 % | 1.00 | 0.5 % | 2 % |", "| local lights | 1 | 0 % | 100 % | 1.50 | 0.6 % | 0.6 % |",
          "| fogs and local lights | 2 | 50 % | 50 % |"})
        EXPECT_NE(lit.find(line), lit.npos) << line << '\n' << lit;
    const std::string plot = promisePlot(rows);
    size_t circles = 0;
    for (size_t at = plot.find("<circle"); at != plot.npos; at = plot.find("<circle", at + 1)) ++circles;
    EXPECT_GE(circles, 4u);
    EXPECT_EQ(promisePage(std::vector<json>{rows.back()}, 0.005, 0.01).find("| all |"), std::string::npos);
}

} // namespace
} // namespace brume::bench
