// Recordings: what is written is read, bit for bit, and what is not as it was written is refused in one line.
#include "server/operate/recording.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "common/scene_text.h"
#include "server/operate/replay.h"
#include "server/operate/replay_ticks.h"
#include "server/sim/simulation.h"
#include "server/sim/state_hash.h"
#include "tests/net/log_capture.h"

namespace brume {
namespace {

constexpr char kScene[] = "name = 'three'\n[medium]\ncount = 3\n";

class RecordingTest : public testing::Test {
protected:
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("brume-recording-" + std::to_string(getpid()));

    void TearDown() override {
        std::filesystem::remove(file);
        std::filesystem::remove(file.string() + ".old");
    }

    static RecordingHead head() {
        return {"three", "/nowhere/three.toml", kScene, {"medium.seed=7", "render.method=slabs"}, "test"};
    }

    std::string bytes() const {
        std::ifstream in(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void put(const std::string& text) const { std::ofstream(file, std::ios::binary) << text; }

    // A whole session of the scene in head(), as a server records it.
    void record() const {
        Simulation simulation(sceneOf(kScene, head().file, head().overrides));
        RecordingWriter out(file, head());
        EXPECT_TRUE(out.write({0, simulation.stateHash(), {}, {}, {}}));
        for (uint64_t tick = 1; tick <= 10; ++tick) {
            std::vector<Command> commands;
            if (tick == 4)
                commands = {{1, 1, Impulse{{0, 0, 9}, {0, 0, -1}, {0, 0, 0}, 2.5f}},
                            {2, 1, Set{{"medium.extinction", 0.1f}}}};
            simulation.step(commands);
            if (!commands.empty()) {
                EXPECT_TRUE(out.write({tick, simulation.stateHash(), commands, {}, {}}));
            }
        }
        EXPECT_TRUE(out.write({10, simulation.stateHash(), {}, {}, "stopped"}));
    }

    // record() with another value of tick 4's setting, under the same hashes.
    void recordOtherwise() const {
        record();
        RecordingReader in(file);
        std::vector<RecordedTick> all;
        while (auto tick = in.next()) all.push_back(*tick);
        std::get<Set>(all[1].commands[1].body).changes.at(0).value = std::nextafter(0.1f, 1.0f);
        RecordingWriter out(file, head());
        for (const RecordedTick& tick : all) EXPECT_TRUE(out.write(tick));
    }

    std::string readError() const {
        try {
            RecordingReader in(file);
            while (in.next()) {
            }
        } catch (const RecordingError& e) {
            return e.what();
        }
        return "read";
    }
    std::string replayed() const {
        std::ostringstream out;
        try {
            replay({file, 0, {}}, out);
        } catch (const std::exception& e) {
            return e.what();
        }
        return out.str();
    }
};

TEST_F(RecordingTest, ReadsWhatWasWrittenAndReplaysIt) {
    record();
    RecordingReader in(file);
    EXPECT_EQ(in.head().text, kScene);
    EXPECT_EQ(in.head().overrides, head().overrides);
    EXPECT_EQ(in.next()->tick, 0u);
    const auto four = in.next();
    ASSERT_TRUE(four);
    EXPECT_EQ(four->tick, 4u);
    ASSERT_EQ(four->commands.size(), 2u);
    EXPECT_EQ(std::get<Set>(four->commands[1].body).changes.at(0).value, SettingValue(0.1f));
    EXPECT_EQ(in.next()->end, "stopped");
    EXPECT_FALSE(in.next());
    EXPECT_FALSE(in.cut());
    EXPECT_EQ(replayed(), "replayed 10 ticks with 2 commands: 3 states as recorded; the recording ended: stopped\n");
}

// Under a right hash, as no server writes it.
TEST_F(RecordingTest, ACommandThatIsNoneEndsInOneLine) {
    for (const char* command : {"{}", "7", R"({"viewer":1,"input":7})", R"({"viewer":1,"input":"AAAA"})",
                                R"({"viewer":-1,"input":"AAAA"})", R"({"viewer":1e30,"input":"AAAA"})",
                                R"({"viewer":4294967296,"input":"AAAA"})", R"({"viewer":1,"restart":{}})"}) {
        record();
        const std::string whole = bytes();
        const size_t line = whole.find('\n', whole.find('\n') + 1) + 1;
        const std::string text = std::string(R"({"tick":0,"state":"0000000000000000","commands":[)") + command + "]}";
        StateHash hash;
        hash.add(std::string_view(whole).substr(whole.find('\n') + 1, 16));
        hash.add(std::string_view(text));
        put(whole.substr(0, line) + hexOf(hash.value()) + ' ' + text + '\n');
        const std::string error = readError();
        EXPECT_EQ(error.find(file.string() + ":3: not a record: "), 0u) << error;
        EXPECT_EQ(error.find('\n'), error.npos) << error;
    }
}

TEST_F(RecordingTest, MeasuredErrorsAreReadAsTheyWereAndAReplayTellsTheLargest) {
    const ErrorEstimate small{.pixels = 100, .rmse = 0.003, .low = 0.0025, .high = 0.004, .bias = -0.01, .law = 0.0029};
    const ErrorEstimate large{.pixels = 1024, .rmse = 0.012344, .low = 0.011, .high = 0.014, .bias = 0, .law = 0};
    {
        Simulation simulation(sceneOf(kScene, head().file, head().overrides));
        RecordingWriter out(file, head());
        EXPECT_TRUE(out.write({0, simulation.stateHash(), {}, {}, {}, {{7, "slabs", small}}}));
        simulation.step({});
        EXPECT_TRUE(out.write({1, simulation.stateHash(), {}, {}, {}, {{7, "slabs", small}, {8, "grid", large}}}));
    }
    RecordingReader in(file);
    EXPECT_EQ(in.next()->errors.size(), 1u);
    const std::vector<RecordedError> errors = in.next()->errors;
    ASSERT_EQ(errors.size(), 2u);
    EXPECT_EQ(errors[0].error, small);
    EXPECT_EQ(errors[1].error.rmse, 0.01234) << "four digits";
    const std::string told =
        "3 measured errors of 2 viewers; the largest: 1.2 % (1.1 to 1.4) at tick 1, viewer 8 by grid";
    EXPECT_NE(replayed().find(told), std::string::npos) << replayed();
}

TEST_F(RecordingTest, AFileThatIsThereIsKept) {
    put("dear");
    record();
    std::ifstream old(file.string() + ".old");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(old), {}), "dear");
    EXPECT_EQ(readError(), "read");
}

// A server that is killed leaves a whole number of lines, or one that is cut.
TEST_F(RecordingTest, CutAnywhereItReadsToItsLastWholeLineOrSaysThatNothingIsLeft) {
    record();
    const std::string whole = bytes();
    const size_t head_end = whole.find('\n', whole.find('\n') + 1) + 1;
    size_t refused = 0;
    for (size_t length = 0; length < whole.size(); ++length) {
        put(whole.substr(0, length));
        const std::string error = readError();
        EXPECT_EQ(error == "read", length >= head_end) << length << ": " << error;
        EXPECT_EQ(error.find('\n'), error.npos);
        refused += error != "read";
        if (error != "read" || length % 16) continue;
        const std::string said = replayed();
        const bool at_an_end = whole[length - 1] == '\n';
        EXPECT_EQ(said.find("incomplete") == said.npos, at_an_end) << said;
        EXPECT_NE(said.find("replayed "), said.npos) << said;
    }
    EXPECT_EQ(refused, head_end);
}

// A change of any byte is noticed, but for those that make the last line look cut.
TEST_F(RecordingTest, AnyChangedByteIsRefused) {
    record();
    const std::string whole = bytes();
    for (size_t at = 0; at + 1 < whole.size(); ++at) {
        std::string changed = whole;
        changed[at] = char(changed[at] ^ 1);
        put(changed);
        const std::string error = readError();
        EXPECT_NE(error, "read") << "byte " << at;
        EXPECT_EQ(error.find(file.string() + ':'), 0u) << error;
        EXPECT_EQ(error.find('\n'), error.npos) << error;
    }
}

TEST_F(RecordingTest, LinesLeftOutRepeatedOrMovedAreRefused) {
    record();
    std::vector<std::string> lines;
    std::istringstream in(bytes());
    for (std::string line; std::getline(in, line);) lines.push_back(line + '\n');
    ASSERT_EQ(lines.size(), 5u);
    const auto put_lines = [&](const std::vector<size_t>& order) {
        std::string text;
        for (const size_t i : order) text += lines[i];
        put(text);
    };
    for (const std::vector<size_t>& order : std::vector<std::vector<size_t>>{
             {0, 1, 3, 4}, {0, 1, 2, 2, 3, 4}, {0, 1, 3, 2, 4}, {0, 2, 3, 4}, {1, 2, 3, 4}, {0, 1, 2, 3, 4, 4}}) {
        put_lines(order);
        EXPECT_NE(readError(), "read");
    }
    put_lines({0, 1, 2, 3, 4});
    EXPECT_EQ(readError(), "read");
}

// Its hashes are right: somebody wrote it for a server that would simulate for years.
TEST_F(RecordingTest, ATickFarBehindTheOneBeforeIsRefused) {
    for (const uint64_t tick : {uint64_t{kRecordEvery}, uint64_t{kRecordEvery + 1}, uint64_t{1'000'000'000'000'000}}) {
        {
            RecordingWriter out(file, head());
            EXPECT_TRUE(out.write({.tick = 0}));
            EXPECT_TRUE(out.write({.tick = tick}));
        }
        const std::string said = readError();
        if (tick == kRecordEvery)
            EXPECT_EQ(said, "read");
        else
            EXPECT_NE(said.find(":4: tick " + std::to_string(tick) + " after tick 0"), std::string::npos) << said;
    }
}

TEST_F(RecordingTest, OtherFilesAndVersionsAreNamed) {
    EXPECT_NE(readError().find("cannot be read"), std::string::npos);
    put("");
    EXPECT_NE(readError().find("no recording"), std::string::npos);
    put("#!/bin/sh\n");
    EXPECT_NE(readError().find("no recording"), std::string::npos);
    for (const char* other : {"14", "16"}) {
        put(std::string("brume-recording ") + other + "\n");
        EXPECT_NE(readError().find(std::string("version ") + other + "; this server replays version 15"),
                  std::string::npos)
            << readError();
    }
    put(std::string(65 << 20, 'x'));
    EXPECT_NE(readError().find("damaged"), std::string::npos);
}

TEST_F(RecordingTest, AReplayNamesTheFirstTickThatDiffers) {
    recordOtherwise();
    const std::string said = replayed();
    EXPECT_NE(said.find("the first difference is at tick 4: state "), said.npos) << said;
    EXPECT_NE(said.find("tick 0 was as recorded"), said.npos) << said;
}

// What a frame loop does with a source of ticks, but for the pictures.
class Looking {
public:
    explicit Looking(const std::filesystem::path& file)
        : extent(file), control(std::make_shared<ReplayControl>(extent.head.tick, extent.last)),
          simulation(sceneOf(extent.head)), ticks(file, control, now) {
        simulation.countFrom(extent.head.tick);
        ticks.check(simulation);
    }
    void goOn(std::chrono::milliseconds time) {
        now += time;
        if (const auto beginning = ticks.beginning()) {
            simulation.load(*beginning);
            ticks.check(simulation);
        }
        while (ticks.take(now, commands)) {
            simulation.step(commands);
            ticks.check(simulation);
        }
    }

    RecordingExtent extent;
    std::shared_ptr<ReplayControl> control;
    Simulation simulation;
    Clock::time_point now = Clock::now();
    ReplayTicks ticks;
    std::vector<Command> commands;
};

TEST_F(RecordingTest, ALookGoesSixtyTicksASecondPausesAndSeeks) {
    record();
    Looking look(file);
    EXPECT_EQ(look.extent.last, 10u);
    using std::chrono::milliseconds;
    look.goOn(milliseconds(1));
    EXPECT_EQ(look.simulation.tick(), 1u);
    look.goOn(milliseconds(50));
    EXPECT_EQ(look.simulation.tick(), 4u);
    const uint64_t fourth = look.simulation.stateHash();
    look.control->paused = true;
    look.goOn(milliseconds(200));
    EXPECT_EQ(look.simulation.tick(), 4u);
    EXPECT_TRUE(look.ticks.stands());
    EXPECT_EQ(look.ticks.paused(), true);
    EXPECT_GT(look.ticks.due(), look.now) << "a loop may sleep";

    const uint64_t number = look.control->seek(9);
    look.goOn(milliseconds(0));
    EXPECT_EQ(look.simulation.tick(), 9u);
    EXPECT_EQ(look.control->reached().number, number);
    EXPECT_EQ(look.control->reached().state_hash, look.simulation.stateHash());
    look.control->seek(4);
    look.goOn(milliseconds(0));
    EXPECT_EQ(look.simulation.tick(), 4u);
    EXPECT_EQ(look.control->reached().state_hash, fourth);
    const uint64_t here = look.control->seek(4);
    look.goOn(milliseconds(0));
    EXPECT_EQ(look.control->reached().number, here) << "where it is already";
    look.control->seek(0);
    look.goOn(milliseconds(0));
    EXPECT_EQ(look.control->reached().tick, 0u);
    EXPECT_EQ(look.simulation.tick(), 0u);

    look.control->paused = false;
    for (int i = 0; i < 10; ++i) look.goOn(milliseconds(100));
    EXPECT_EQ(look.simulation.tick(), 10u) << "the end";
    EXPECT_TRUE(look.ticks.stands());
}

TEST_F(RecordingTest, ALookTellsOfADifferenceAndOfTheEndOnce) {
    recordOtherwise();
    const test::LogCapture log;
    Looking look(file);
    for (const uint64_t tick : {10, 0, 10}) {
        look.control->seek(tick);
        look.goOn(std::chrono::milliseconds(0));
    }
    const std::string errors = log.atLeast(spdlog::level::err), all = log.atLeast(spdlog::level::info);
    EXPECT_EQ(errors.find("replay: the first difference is at tick 4: state "), 0u) << errors;
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
    EXPECT_NE(all.find("replay: the recording ends at tick 10 (stopped): the scene stands still"), all.npos) << all;
    EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 2) << all;
}

TEST_F(RecordingTest, NeverGrowsBeyondItsBoundAndKeepsRoomForItsEnd) {
    RecordingWriter out(file, head(), 4096);
    uint64_t tick = 0;
    while (out.write({tick, 1, {}, {}, {}})) ++tick;
    EXPECT_GT(tick, 10u);
    EXPECT_TRUE(out.write({tick - 1, 1, {}, {}, "full"}));
    EXPECT_LE(std::filesystem::file_size(file), 4096u);
    EXPECT_EQ(readError(), "read");
}

TEST_F(RecordingTest, ADiskThatIsFullIsToldInOneLine) {
    EXPECT_THROW(RecordingWriter("/dev/full/x", head()), RecordingError);
    EXPECT_THROW(RecordingWriter("/nowhere/at/all", head()), RecordingError);
}

} // namespace
} // namespace brume
